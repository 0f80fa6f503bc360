"""The two controllers of a shift, and what stands between them and a plant that is not their model.

Weights, limits and horizon are those of the document. What departs from it:

* The brake may go to zero, where it is surely off; the document ends its range at 0.01 N, the very threshold.
* The brake rule is planned with a flywheel 3 rad/s further back than the document's -5 rad/s, so that the plant keeps
  the rule between two samples.
* A state measured beside the ranges of the model, or on a threshold, is moved to the side that the model knows.
* Nearer than that the brake is released at its fastest rate; so is a clutch that a plan of part 1 leaves next to
  nothing. Where the rule leaves no plan, a plan without the rule releases the brake as fast as it can and makes up for
  its torque; it is counted as one by a fallback.
* Limits of a call leave room for a plant that is not the model: :mod:`hysdel_py.demos.shifts.margins`.
* The rates have a small weight, so that torque and clutch force do not swing from sample to sample.
* Forces are effective ones, where an observer tells the friction: factor times force. References are those of the time
  when the input acts.
* Where hard limits leave no plan, a plan with softened limits is taken; where there is none at all, the brake is
  released and the engine takes over its torque. Both are counted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.demos.shifts import references
from hysdel_py.demos.shifts.call_limits import FASTEST, effective_rates, of_guard, of_landing
from hysdel_py.demos.shifts.cases import HORIZON, Part, Shift
from hysdel_py.demos.shifts.margins import Margins
from hysdel_py.demos.shifts.observer import ShiftObserver
from hysdel_py.demos.shifts.sensors import Sensors
from hysdel_py.demos.shifts.transmission import LEAST_SPEED, MOST_SPEED, Transmission, engine_limit
from hysdel_py.model import Model, load

__all__ = [
    "NODE_LIMIT", "PartController", "part_model", "part_of", "release_brake", "shift_controller", "shift_cost",
    "shift_limits",
]  # fmt: skip

Vector = NDArray[np.float64]

NODE_LIMIT = 40
"""Nodes of the branch and bound per move."""
GAP = 1e-3
"""Share of the cost that a plan may lack to the best one."""
BRAKE_RULE = -8.0
"""Flywheel speed up to which a plan may use the brake [rad/s]."""
NO_RULE = 1000.0
"""The same where there is no rule."""
RATES = {1: ("Te_rate", "Fnb_rate", "Fnc_rate"), 2: ("Te_rate",)}
"""Rates with a weight in both parts."""
_LEAN = 1e-5  # what a measured torque or force is moved by, off a threshold that a plan ended on
_NEAR = 1e-4  # N, around the threshold, where rounding leaves neither side
_ON = 0.01  # N, threshold of the brake rule
_NOTICED = 1.0  # N, brake force that is worth a plan of its own
_OPEN = 0.5  # N, clutch force that is let go
_PRICE = 1e4


@cache
def _model(name: str, parameters: tuple[tuple[str, float], ...]) -> Model:
    values: dict[str, Any] = dict(parameters)
    return load(name, **values)


def part_model(shift: Shift, part: int, data: Transmission, rule: float = BRAKE_RULE) -> Model:
    """The shipped model of part 1 or 2 with the gears of a shift and the brake rule of its plans."""
    old, new = (data.gears[gear] for gear in shift.gears)
    if part == 1:
        return _model(
            "bist_part1", (("r_old", old), ("r_new", new), ("F_max", shift.force), ("slip_back", shift.slip_back))
        )
    return _model("bist_part2", (("r_new", new), ("F_max", shift.force), ("wf_back", rule)))


def shift_limits(shift: Shift, part: int, data: Transmission) -> Limits:
    """Limits of the document: 0.99 and 1.01 times those of the model."""
    low, high = 1.01 * LEAST_SPEED, 0.99 * MOST_SPEED
    own, gear = part_of(shift, part), data.gears[shift.gears[part - 1]]
    brake = 0.99 * shift.force if own.brake_force is None else own.brake_force
    return Limits(
        x={
            "Te": (0.01, 0.99 * 145), "Fnb": (0.0, brake), "Fnc": (0.01, 0.99 * own.clutch_force),
            "dphi": (-0.99, 0.99), "we": (low, high), "ws": (gear * low, gear * high),
            "wv": (gear * data.r_d * low, gear * data.r_d * high),
        },
        y={"torque": (0.0, 2000.0), "wf": own.wf, "rel": own.rel},
        u=dict(FASTEST),
        soft=("wf",) if shift.guard else (),
        rho=_PRICE,
    )  # fmt: skip


def shift_controller(
    shift: Shift, part: int, data: Transmission, node_limit: int = NODE_LIMIT, rule: float = BRAKE_RULE
) -> HybridMpc:
    """The controller of part 1 or 2 of a shift."""
    model, cost, limits = (
        part_model(shift, part, data, rule),
        shift_cost(part_of(shift, part), part),
        shift_limits(shift, part, data),
    )
    return HybridMpc(model, HORIZON, cost, limits, node_limit=node_limit, gap_rel=GAP, fallback="soft")


def shift_cost(own: Part, part: int) -> Cost:
    """Weights of the document, and those of the rates."""
    outputs = {"torque": own.torque, "wf": own.wheel, "rel": own.relative}
    forces = {"Fnb": own.brake, "Fnc": own.clutch}
    x = {name: weight for name, weight in forces.items() if weight}
    y = {name: weight for name, weight in outputs.items() if weight}
    return Cost(y=y, x=x, terminal=x, u=dict.fromkeys(RATES[part], own.rates))


def part_of(shift: Shift, part: int) -> Part:
    """Part 1 or 2 of a shift."""
    return shift.release if part == 1 else shift.engage


def release_brake(_k: int, x: Vector, _move: Any) -> Vector:
    """Where no plan is found: brake off at its fastest rate, engine torque in its place, clutch as it is."""
    return np.array([450.0 if x[1] > _ON else 0.0, -495.0, 0.0])


@dataclass(eq=False)
class PartController:
    """A controller at its plant: makes references and limits for each step, and takes measurements as they are.

    Parameters
    ----------
    shift : Shift
    part : int
        1 or 2.
    data : Transmission
    mpc : HybridMpc, or another object with its ``solve`` and ``mld``
    since : float
        Second of the shift at which the part begins.
    force : float
        Clutch force at the begin of the shift [N].
    forces : array, optional
        Clutch force wanted at the samples of part 1 [N]; zero by default.
    sensors : Sensors, optional
        What is measured of a state; all of it by default.
    observer : ShiftObserver, optional
        What state there is behind the measurement, and what clutch and brake really grip; as measured, and as much as
        in the model, by default.
    modes : FixedModes, optional
        Limits that stand for the switches that the model of `mpc` lacks.
    last : array of shape (3,), optional
        The input before the first one.
    without_rule : callable, optional
        Makes the same controller without the brake rule, for a brake that is still on when the rule leaves no plan.
    """

    shift: Shift
    part: int
    data: Transmission
    mpc: Any
    since: float
    force: float
    forces: Vector | None = None
    sensors: Sensors = field(default_factory=Sensors)
    observer: ShiftObserver | None = None
    modes: Any = None
    last: Vector = field(default_factory=lambda: np.zeros(3))
    without_rule: Callable[[], Any] | None = None
    margins: Margins = field(init=False)
    _late: Any = field(init=False, default=None)

    def __post_init__(self) -> None:
        self.margins = Margins(self.shift, self.part, self.data, BRAKE_RULE, self.sensors.noise)

    def solve(self, x: Vector, k: int) -> Move:
        """The move at step k of the part."""
        state, grip = self.sensors.read(x), np.ones(2)
        if self.observer is not None:
            state, grip = self.observer.update(state, self.last), self.observer.factors
        move = self._planned(self._seen(state), self.since + references.ahead(k) + self._delay, grip)
        self.last = release_brake(k, x, move) if move.u is None else move.u
        return move

    @property
    def _delay(self) -> float:
        return 0.0 if self.observer is None else self.observer.delay

    def _planned(self, seen: Vector, t: Vector, grip: Vector) -> Move:
        off = self._brake_is_off(seen)
        late = off and self._still_brakes(seen)
        move = self._late_move(seen, t, grip) if late else self._move(seen, t, grip, off=off)
        if move.u is None and not late and self._still_brakes(seen):
            move, off = self._late_move(seen, t, grip), True
        self.margins.remember(move)
        if move.u is None:
            return move
        rates = move.u / [1.0, grip[1], grip[0]]
        if off:
            rates[1] = FASTEST["Fnb_rate"][0]
        if self.part == 1 and seen[2] + references.SAMPLE_TIME * move.u[2] < _OPEN:
            rates[2] = FASTEST["Fnc_rate"][0]
        return replace(move, u=rates)

    def _move(self, seen: Vector, t: Vector, grip: Vector, *, off: bool) -> Move:
        begin = seen * [1.0, 0.0 if off else 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
        limits = self._limits(begin, t, grip)
        move: Move = self.mpc.solve(begin, self._references(seen, t, grip), limits=limits)
        if self.modes is not None:
            self.modes.remember(move)
        return move

    def _late_move(self, seen: Vector, t: Vector, grip: Vector) -> Move:
        """A plan in which the brake goes off as fast as it can, whatever the flywheel does meanwhile."""
        if self._late is None and self.without_rule is not None:
            self._late = self.without_rule()
        limits = self._limits(seen, t, grip)
        limits = replace(limits, x={**limits.x, "Fnb": self.margins.released(seen, grip)})
        move: Move = self._late.solve(seen, self._references(seen, t, grip), limits=limits)
        if move.u is None:
            return move
        return replace(move, status=MoveStatus.FALLBACK, fallback="late brake")

    def _still_brakes(self, seen: Vector) -> bool:
        """Whether a flywheel that still turns backwards is braked, by more than noise."""
        turns_back = self.data.flywheel_speed(seen[4], seen[5]) < 0.0
        return self.part == 2 and self.without_rule is not None and bool(seen[1] > _NOTICED) and turns_back

    def _brake_is_off(self, seen: Vector) -> bool:
        """Whether the flywheel is about to reverse; a brake that is still on then is no state of its model."""
        return self.part == 2 and self.data.flywheel_speed(seen[4], seen[5]) > BRAKE_RULE

    def _seen(self, state: Vector) -> Vector:
        """A state on the sides of ranges and thresholds that the model knows."""
        variables = self.mpc.mld.x
        seen: Vector = np.clip(state, [v.low for v in variables], [v.high for v in variables])
        seen[0] = max(0.0, min(seen[0], engine_limit(seen[4], beyond="range")) - _LEAN)
        seen[1] = _ON - _LEAN if abs(seen[1] - _ON) < _NEAR else max(0.0, seen[1] - _LEAN)
        return seen

    def _references(self, x: Vector, t: Vector, grip: Vector) -> dict[str, Any]:
        shift, data = self.shift, self.data
        beside = 0.0 if self.observer is None else self.observer.torque_beside
        wanted: dict[str, Any] = {"torque": references.torque_reference(shift.torques, t, shift.fall) - beside}
        if self.part == 2:
            relative = data.relative_speed(shift.gears[1], x[4], x[5])
            lands = abs(relative) <= references.LANDING_SPEED
            return wanted | {"rel": references.landing(relative, shift.fading) if lands else 0.0}
        if shift.release.wheel:
            nearest = self.margins.nearest(x, float(grip[1]))
            wanted["wf"] = references.wheel_reference(shift, data, x[5], self.force, t, nearest=nearest)
        if self.forces is not None:
            times = references.SAMPLE_TIME * np.arange(len(self.forces))
            wanted["Fnc"] = np.interp(t, times, self.forces)
        return wanted

    def _limits(self, x: Vector, t: Vector, grip: Vector) -> Limits:
        own = self.margins.limits(x, grip)
        if self.part == 1:
            limits = of_guard(self.shift, self.data, x, t, strongest=own["Fnc"][1], grip=min(float(grip[0]), 1.0))
        else:
            limits = of_landing(self.shift, self.data, x)
        limits = replace(limits, x={**own, **limits.x})
        if self.modes is not None:
            limits = replace(limits, x=self.modes.limits().x)
        return limits if self.observer is None else replace(limits, u=effective_rates(grip))
