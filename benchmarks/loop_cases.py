"""The closed loops of ``loops.py``: model, cost, limits, start, references and plant of each.

Clutch and gear shifts have the weights and limits of J.R.P. Kusters, *Modelling and coordinated control of advanced
automotive transmissions*, TU/e, DCT 2005-58, sections 10.4 and 10.5 and appendix K. What the document leaves open is
ours: the start of the clutch, the references of the shifts over time, and the references of the other loops.

The plant of a loop is the model of its controller, that of the clutch ten times finer. A plan often ends exactly on a
threshold that a requirement guards, and rounding then puts the plant on its wrong side; so the state of a gear shift is
handed back with its engine torque, brake force and shaft speed a few millionths lower.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

import hysdel_py as hys
from hysdel_py.demos import clutch

Vector = NDArray[np.float64]
Reference = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class LoopCase:
    """One closed loop.

    Attributes
    ----------
    name, title : str
    model : Model
    cost : Cost
    limits : Limits
    start : mapping of state to number
    reference : callable
        Step to references.
    steps : int
    plant : object with ``step``, optional
        The model by default.
    lean : mapping of state to number
        Added to the state of the plant after each step.
    is_over : callable
        Whether the loop has reached its goal at a state.
    """

    name: str
    title: str
    model: hys.Model
    cost: hys.Cost
    limits: hys.Limits
    start: Mapping[str, float]
    reference: Callable[[int], Reference]
    steps: int
    plant: Any = None
    lean: Mapping[str, float] = field(default_factory=dict)
    is_over: Callable[[Vector], bool] = lambda _x: False

    def controller(self, horizon: int, **search: Any) -> hys.HybridMpc:
        """A controller of the loop; keywords are those of the search."""
        return hys.HybridMpc(self.model, horizon, self.cost, self.limits, **search)

    def first(self) -> Vector:
        """The first state as a vector."""
        return np.array([self.start[v.name] for v in self.model.mld.x])

    def advance(self, x: Vector, u: Vector) -> Vector:
        """The state of the plant one step later, moved into the ranges by what rounding put it beyond."""
        plant = self.model.dha if self.plant is None else self.plant
        after = plant.step(x, u)[0] if self.plant is not None else plant.step(x, u, check=False)[0]
        leaning = after + [self.lean.get(v.name, 0.0) for v in self.model.mld.x]
        return np.clip(leaning, [v.low for v in self.model.mld.x], [v.high for v in self.model.mld.x])


def steady(**references: float) -> Callable[[int], Reference]:
    """References that stay."""
    return lambda _k: references


@cache
def cases() -> dict[str, LoopCase]:
    """All loops by name."""
    loops = [
        _clutch(), *_shifts(), _two_tanks(), _three_tanks(), _heat_and_cool(), _pendulum_wall(), _supply_chain(),
    ]  # fmt: skip
    return {loop.name: loop for loop in loops}


def _clutch() -> LoopCase:
    model = hys.load("clutch", we_min=60)
    return LoopCase(
        "clutch", "dry clutch until lock-up", model,
        hys.Cost(y={"y1": 1.0, "y2": 4.0, "y3": 4.0}),
        hys.Limits(
            y={"y1": (clutch.LEAST_ENGINE_SPEED + 0.3, None), "y2": (0.0, None), "y3": (-11.0, 11.0)},
            soft=("y1",), rho=1e5,
        ),
        clutch.START, steady(y1=100.0), 100, clutch.ClutchPlant(model),
        is_over=lambda x: bool(x[1] <= model.parameters["reltol"]),
    )  # fmt: skip


# ---- gear shifts ----------------------------------------------------------------------------------------------------

GEARS = {1: 1 / 3.308, 2: 1 / 1.913, 3: 1 / 1.220}
FINAL_DRIVE = 1 / 3.737
STIFFNESS = 6000.0
FALL = 0.5
"""Seconds over which the reference of the drive-shaft torque falls."""
LEAN = {"Te": -1e-5, "Fnb": -1e-5, "ws": -1e-6}


@dataclass(frozen=True, slots=True)
class Shift:
    """A gear shift of the document; weights are those of its equations (10.18) to (10.23).

    Attributes
    ----------
    name : str
    gears : pair of int
        Old and new gear.
    torques : pair of float
        Drive-shaft torque before and after [Nm]; in between the reference falls evenly.
    speed : float
        Of the wheels at the start [rad/s].
    wheel, brake, relative : mappings of part to number
        Weights of the flywheel speed, brake force and relative speed.
    torque : mapping of part to number
        Weight of the drive-shaft torque.
    spans : mapping of part to limits of flywheel speed and relative speed
    seconds : float
        Length of part 2.
    force : float
        Greatest normal force [N].
    slip_back : float
        Slip at which the clutch torque of part 1 changes its sign [rad/s]. In the shift from first to second gear it
        never does, as in the document: there the brake is needed while the clutch still carries much, and a controller
        that looks 0.1 s ahead finds no way across the change of sign.
    soft : tuple of str
        Limits that are softened here and hard in the document; with hard ones part 1 finds no input after 0.46 s.
    handed_over : tuple of float
        State at the end of part 1 under its controller with horizon 10.
    """

    name: str
    gears: tuple[int, int]
    torques: tuple[float, float]
    speed: float
    wheel: float
    torque: tuple[float, float]
    relative: float
    brake: float
    spans: tuple[Any, Any]
    seconds: float
    force: float
    slip_back: float
    soft: tuple[str, ...]
    handed_over: tuple[float, ...]


SHIFTS = (
    Shift(
        "23_constant", (2, 3), (600, 600), 75, 3, (50, 100), 3, 1,
        (((-300, -5), (0, None)), ((-300, 300), (0, None))), 0.75, 200, -1, (),
        (97.96, 67.64, 0.01, 0.1, 436.79, 277.78, 74.332),
    ),
    Shift(
        "23_decreasing", (2, 3), (800, 600), 75, 3, (50, 50), 5, 2,
        (((-300, -5), (0, None)), ((-300, 300), (-100, None))), 1.0, 200, -1, (),
        (88.65, 82.13, 0.01, 0.1025, 449.03, 279.44, 74.842),
    ),
    Shift(
        "12_decreasing", (1, 2), (1600, 850), 40, 0, (50, 50), 1, 20,
        (((-1000, -200), (-1000, 1000)), ((-500, 0), (-100, None))), 1.0, 250, -1000, ("wf",),
        (134.10, 114.11, 3.05, 0.1499, 333.67, 163.26, 43.938),
    ),
)  # fmt: skip


def _shifts() -> list[LoopCase]:
    return [loop for shift in SHIFTS for loop in (_part1(shift), _part2(shift))]


def _part1(shift: Shift) -> LoopCase:
    old, new = (GEARS[gear] for gear in shift.gears)
    model = hys.load("bist_part1", r_old=old, r_new=new, F_max=shift.force, slip_back=shift.slip_back)
    outputs = {"torque": shift.torque[0]} | ({"wf": shift.wheel} if shift.wheel else {})
    wheel = {"wf": -50.0} if shift.wheel else {}
    forces = {"Fnb": 1.0, "Fnc": 100.0}
    return LoopCase(
        f"bist1_{shift.name}", f"gear shift {shift.name}, part 1", model,
        hys.Cost(y=outputs, x=forces, terminal=forces),
        _shift_limits(shift, 0, (old, new)), _stationary(model, shift),
        lambda k: {"torque": _asked(shift, 0.01 * k), **wheel}, 50, lean=LEAN,
    )  # fmt: skip


def _part2(shift: Shift) -> LoopCase:
    new = GEARS[shift.gears[1]]
    model = hys.load("bist_part2", r_new=new, F_max=shift.force)
    forces = {"Fnb": shift.brake}
    return LoopCase(
        f"bist2_{shift.name}", f"gear shift {shift.name}, part 2", model,
        hys.Cost(y={"rel": shift.relative, "torque": shift.torque[1]}, x=forces, terminal=forces),
        _shift_limits(shift, 1, (new, new)),
        dict(zip([v.name for v in model.mld.x], shift.handed_over, strict=True)),
        lambda k: {"torque": _asked(shift, 0.5 + 0.01 * k), "rel": 0.0}, round(100 * shift.seconds), lean=LEAN,
        is_over=lambda x: bool(abs(x[4] - x[5] / new) < 1.0),
    )  # fmt: skip


def _asked(shift: Shift, t: float) -> float:
    """Reference of the drive-shaft torque: from the first to the second value."""
    before, after = shift.torques
    return float(before + (after - before) * min(1.0, t / FALL))


def _stationary(model: hys.Model, shift: Shift) -> dict[str, float]:
    """The start of part 1: the clutch carries what engine and shaft ask for, and no shaft accelerates."""
    p, torque = model.parameters, shift.torques[0]
    engine = torque * p["r_old"] * p["r_d"]
    return {
        "Te": engine, "Fnb": 0.01, "Fnc": engine, "dphi": torque / STIFFNESS,
        "we": shift.speed / (p["r_old"] * p["r_d"]), "ws": shift.speed / p["r_d"], "wv": shift.speed,
    }  # fmt: skip


def _shift_limits(shift: Shift, part: int, gears: tuple[float, float]) -> hys.Limits:
    """Limits of the document: 0.99 and 1.01 times those of the model. The brake may go to 0, where it is surely off."""
    low, high = 1.01 * 84, 0.99 * 700
    (wheel, relative), (gear, _) = shift.spans[part], gears
    clutch_force = shift.force if part == 0 else 200.0
    return hys.Limits(
        x={
            "Te": (0.01, 0.99 * 145), "Fnb": (0.0, 0.99 * shift.force), "Fnc": (0.01, 0.99 * clutch_force),
            "dphi": (-0.99, 0.99), "we": (low, high), "ws": (gear * low, gear * high),
            "wv": (gear * FINAL_DRIVE * low, gear * FINAL_DRIVE * high),
        },
        y={"torque": (0, 2000), "wf": wheel, "rel": relative},
        u={"Te_rate": (-396, 495), "Fnb_rate": (-495, 792), "Fnc_rate": (-495, 792)},
        soft=shift.soft, rho=1.0,
    )  # fmt: skip


# ---- others ---------------------------------------------------------------------------------------------------------


def _two_tanks() -> LoopCase:
    return LoopCase(
        "two_tanks", "level of the second tank", hys.load("two_tanks"),
        hys.Cost(y={"level2": 100.0}, u={"valve": 0.001}), hys.Limits(),
        {"h1": 0.1, "h2": 0.4}, steady(level2=0.2), 30,
    )  # fmt: skip


def _three_tanks() -> LoopCase:
    return LoopCase(
        "three_tanks", "level of the middle tank", hys.load("three_tanks"),
        hys.Cost(y={"level(1)": 0.1, "level(2)": 1.0, "level(3)": 0.1}), hys.Limits(),
        {"h(1)": 1.0, "h(2)": 2.0, "h(3)": 1.0}, steady(**{"level(1)": 3.0, "level(2)": 3.0, "level(3)": 2.0}), 30,
    )  # fmt: skip


def _heat_and_cool() -> LoopCase:
    return LoopCase(
        "heat_and_cool", "temperature of the second body", hys.load("heat_and_cool"),
        hys.Cost(y={"y(2)": 1.0}, u={"T_room": 0.01}), hys.Limits(y={"y(1)": (10.0, None)}, soft=True),
        {"T(1)": 5.0, "T(2)": 20.0, "T(3)": 40.0}, lambda k: {"y(2)": 25.0 if k < 15 else 14.0, "T_room": 15.0}, 30,
    )  # fmt: skip


def _pendulum_wall() -> LoopCase:
    return LoopCase(
        "pendulum_wall", "pendulum caught by the wall", hys.load("pendulum_wall"),
        hys.Cost(x={"angle": 1.0, "speed": 1.0}, u={"torque": 1.0}, terminal=[[6543.9, 2037.2], [2037.2, 651.65]]),
        hys.Limits(), {"angle": -0.02, "speed": 1.0}, steady(), 40,
    )  # fmt: skip


def _supply_chain() -> LoopCase:
    outputs = {"sold_a": 10.0, "sold_b": 10.0, "stock": 0.1}
    return LoopCase(
        "supply_chain", "sales of two goods", hys.load("supply_chain"),
        hys.Cost(y=outputs, u={"runs(1)": 1.0, "runs(2)": 1.0}), hys.Limits(),
        {"a(1)": 5.0, "a(2)": 5.0, "b(1)": 5.0, "b(2)": 5.0},
        lambda k: {"sold_a": 4.0 + (k % 4 == 0), "sold_b": 3.0 + (k % 3 == 0), "stock": 20.0}, 20,
    )  # fmt: skip
