"""What part 1 of a shift can do at all: linear programs over all inputs, independent of the controllers.

While the clutch slips forwards and the flywheel turns backwards the transmission is linear in its states and in the
rates of engine torque, brake torque and clutch torque; the engine curve is concave, three linear rows. So the least
deviation of the torque at the wheels from a reference, and the greatest torque that can be held, are linear programs
over the rates of a whole part. They are solved here with exact sampling, while the controllers plan with forward Euler
over a tenth of a second, and with multipliers that prove their values.

The clutch may carry anything from zero to its greatest torque while it is closed; a clutch that sticks carries less
than its force allows, so that this covers stick and forward slip. What it leaves out is an engine that falls behind its
shaft while the clutch is closed: the clutch then pulls the wheels back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.cases import Shift
from hysdel_py.demos.shifts.references import SAMPLE_TIME, smooth, torque_reference
from hysdel_py.demos.shifts.response import Response, unit
from hysdel_py.demos.shifts.transmission import LEAST_SPEED, MOST_SPEED, Transmission
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.lp import Lp, LpResult, maximise, sharpened_bound

__all__ = ["ReleasePlan", "greatest_held", "least_deviation"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

RATES = ((-400.0, 500.0), (-500.0, 800.0), (-500.0, 800.0))
"""Ends of the rates of engine torque [Nm/s] and of both forces [N/s]."""
CURVE = ((45.0 / 21.0, 105.0 - 105.0 * 45.0 / 21.0), (40.0 / 314.0, 145.0 - 419.0 * 40.0 / 314.0),
         (-18.0 / 209.0, 127.0 + 628.0 * 18.0 / 209.0))  # fmt: skip
"""Slope and offset of the pieces of the engine curve over the engine speed; their least is the curve."""
_HELD_WITHIN = 1e-3  # of the torque that is to be held
_LESS_FRICTION = 1e-7  # price of the torques of brake and clutch, per Nm and sample, beside a share of the torque
_TE, _BRAKE, _CLUTCH, _WE, _WS, _WV = 0, 1, 2, 4, 5, 6


@dataclass(frozen=True, slots=True, eq=False)
class ReleasePlan:
    """Inputs of part 1 with the least deviation of the torque.

    Attributes
    ----------
    deviation : float
        Largest deviation of the torque at the wheels from its reference at a sample, as a share of the reference.
    proven : float
        No inputs get below, by the multipliers of the program.
    opens : float
        Second from which the clutch carries nothing.
    x : array of shape (N + 1, 7)
        States at the samples, with torques of brake and clutch in place of forces.
    u : array of shape (N, 3)
        Rates.
    """

    deviation: float
    proven: float
    opens: float
    x: Matrix
    u: Matrix


def least_deviation(shift: Shift, data: Transmission, start: Vector, opens: float | None = None) -> ReleasePlan:
    """The best that any controller could do in part 1, with the reference of the torque that the shift has.

    Parameters
    ----------
    shift : Shift
    data : Transmission
    start : array of shape (7,)
        First state.
    opens : float, optional
        Second from which the clutch carries nothing; the best of some by default.

    Raises
    ------
    ArgumentError
        No inputs keep the limits.
    """
    if opens is None:
        plans = [_Release(shift, data, start, second).plan() for second in _openings(shift, data, start)]
        found = [plan for plan in plans if plan is not None]
        best = min(found, key=lambda plan: (round(plan.deviation, 5), plan.opens), default=None)
    else:
        best = _Release(shift, data, start, opens).plan()
    if best is None:
        raise ArgumentError(f"no inputs open the clutch of shift {shift.name} within its limits")
    return best


def _openings(shift: Shift, data: Transmission, start: Vector) -> Vector:
    earliest = np.ceil(data.mu * start[_CLUTCH] / -RATES[_CLUTCH][0] / SAMPLE_TIME) * SAMPLE_TIME
    return np.asarray(np.linspace(min(earliest, shift.release.seconds), shift.release.seconds, 5), dtype=float)


@dataclass(frozen=True, slots=True, eq=False)
class _Rows:
    """``left w <= right``, grown row by row."""

    left: list[Matrix]
    right: list[Vector]

    def below(self, rows: Matrix, sides: Vector) -> None:
        self.left.append(rows)
        self.right.append(sides)


@dataclass(frozen=True, slots=True, eq=False)
class _Release:
    """Part 1 with a clutch that is open from a given time; variables are the rates and the deviation."""

    shift: Shift
    data: Transmission
    start: Vector
    opens: float

    @property
    def steps(self) -> int:
        return round(self.shift.release.seconds / SAMPLE_TIME)

    def plan(self) -> ReleasePlan | None:
        moves = Response.of(self.data, self.shift.gears[0], self.steps)
        x0 = _with_torques(self.data, self.start)
        lp = self._program(moves, moves.free(x0))
        found = maximise(lp.c, lp.A, lp.b, lp.lb, lp.ub)
        if not found.is_optimal:
            return None
        u = found.w[: 3 * self.steps]
        bound = -sharpened_bound(lp, found) - self._friction(lp, found)
        return ReleasePlan(
            float(found.w[-1]), bound, self.opens, moves.free(x0) + moves.by(u), u.reshape(self.steps, 3)
        )

    def _friction(self, lp: Lp, found: LpResult) -> float:
        """The part of the cost that friction has in a plan."""
        return float(-lp.c[:-1] @ found.w[:-1])

    def _program(self, moves: Response, free: Matrix) -> Lp:
        reference, rows = self._reference(), _Rows([], [])
        for sign in (1.0, -1.0):
            by = sign * moves.rows(moves.torque)
            rows.below(np.column_stack([by, -reference[1:]]), sign * (reference[1:] - free[1:] @ moves.torque))
        for row, most in self._limits(free):
            rows.below(np.column_stack([moves.rows(row), np.zeros(self.steps)]), most - free[1:] @ row)
        ends = np.tile(np.array(RATES) * np.array([[1.0], [self.data.mu], [self.data.mu]]), (self.steps, 1))
        friction = (moves.rows(unit(_BRAKE)) + moves.rows(unit(_CLUTCH))).sum(axis=0)
        return Lp(
            np.append(-_LESS_FRICTION * friction, -1.0), np.vstack(rows.left), np.concatenate(rows.right),
            np.append(ends[:, 0], 0.0), np.append(ends[:, 1], 10.0),
        )  # fmt: skip

    def _reference(self) -> Vector:
        return torque_reference(self.shift.torques, SAMPLE_TIME * np.arange(self.steps + 1), self.shift.fall)

    def _limits(self, free: Matrix) -> list[tuple[Vector, Vector]]:
        """Rows of the state and what they may be at most, at the samples after the first."""
        t = np.asarray(SAMPLE_TIME * np.arange(1, self.steps + 1), dtype=float)
        closed = t < self.opens - 1e-9
        most = 0.99 * self.data.mu * self.shift.force
        fall = np.maximum(free[0, _CLUTCH], 0.0)
        clutch = np.where(closed, max(0.99 * self.data.mu * self.shift.release.clutch_force, fall), 0.01)
        found = [(unit(_TE), np.full(self.steps, 143.55)), (-unit(_TE), np.zeros(self.steps)),
                 (unit(_BRAKE), np.full(self.steps, most)), (-unit(_BRAKE), np.zeros(self.steps)),
                 (unit(_CLUTCH), clutch), (-unit(_CLUTCH), np.zeros(self.steps)),
                 (unit(_WE), np.full(self.steps, 0.99 * MOST_SPEED)),
                 (-unit(_WE), np.full(self.steps, -1.01 * LEAST_SPEED))]  # fmt: skip
        return found + _curve(self.steps) + self._of_slip(t, closed) + self._of_flywheel()

    def _of_slip(self, t: Vector, closed: NDArray[np.bool_]) -> list[tuple[Vector, Vector]]:
        behind = unit(_WS) / self.data.gears[self.shift.gears[0]] - unit(_WE)
        guard = self.shift.guard
        least = smooth(0.0, guard.slip, t / guard.build) if guard else np.zeros(len(t))
        return [(behind, np.where(closed, -least, 1e4))]

    def _of_flywheel(self) -> list[tuple[Vector, Vector]]:
        speed = self.data.z * (unit(_WS) / self.data.r_gn - unit(_WE))
        low, high = self.shift.release.wf
        ends = [] if high is None else [(speed, np.full(self.steps, high))]
        return ends + ([] if low is None else [(-speed, np.full(self.steps, -low))])


def greatest_held(data: Transmission, gear: int, wheels: float, seconds: float = 0.5) -> float:
    """Greatest torque at the wheels that inputs can hold for some time while the vehicle gains speed [Nm].

    The start is that of a vehicle that rolls with this torque; clutch, brake and engine may do what they like.

    Parameters
    ----------
    gear : int
    wheels : float
        Speed of the wheels at the begin [rad/s].
    seconds : float
        How long the torque is held.

    Raises
    ------
    ArgumentError
        No torque can be held.
    """
    steps = round(seconds / SAMPLE_TIME)
    moves = Response.of(data, gear, steps)
    first, more = (np.array(list(data.rolling(gear, torque, wheels).values())) for torque in (0.0, 1.0))
    base, per = moves.free(_with_torques(data, first)), moves.free(_with_torques(data, more - first))
    rows = _Rows([], [])
    for sign in (1.0, -1.0):
        of_torque = sign * (per[1:] @ moves.torque - 1.0) - _HELD_WITHIN
        rows.below(np.column_stack([sign * moves.rows(moves.torque), of_torque]), -sign * base[1:] @ moves.torque)
    for row, most in [*_curve(steps), *_ranges(data, gear, steps)]:
        rows.below(np.column_stack([moves.rows(row), per[1:] @ row]), most - base[1:] @ row)
        rows.below(np.append(np.zeros(3 * steps), per[0] @ row)[None], most[:1] - base[0] @ row)
    ends = np.vstack([np.tile(np.array(RATES), (steps, 1)), [0.0, 1e4]])
    found = maximise(np.append(np.zeros(3 * steps), 1.0), np.vstack(rows.left), np.concatenate(rows.right), *ends.T)
    if not found.is_optimal:
        raise ArgumentError(f"no torque can be held in gear {gear} at {wheels:g} rad/s")
    return float(found.value)


def _curve(steps: int) -> list[tuple[Vector, Vector]]:
    return [(unit(_TE) - slope * unit(_WE), np.full(steps, offset)) for slope, offset in CURVE]


def _ranges(data: Transmission, gear: int, steps: int) -> list[tuple[Vector, Vector]]:
    """Forces from zero up and forward slip."""
    behind = unit(_WS) / data.gears[gear] - unit(_WE)
    return [(row, np.zeros(steps)) for row in (-unit(_TE), -unit(_BRAKE), -unit(_CLUTCH), behind)]


def _with_torques(data: Transmission, x: Vector) -> Vector:
    """A state with torques of brake and clutch in place of forces."""
    found: Vector = np.asarray(x, dtype=float) * np.array([1.0, data.mu, data.mu, 1.0, 1.0, 1.0, 1.0])
    return found
