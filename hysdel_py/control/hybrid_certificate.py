"""What an explicit hybrid law is worth: compared with the controller solved online."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_parameters import LAST, REFERENCE, STATE
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.move import Move, MoveStatus

__all__ = ["HybridCertificate", "certify_hybrid"]

Vector = NDArray[np.float64]

_NEAR = 1e-6
"""A point counts as missing or superfluous only if it stays so when it is moved by this share of the box."""


@dataclass(frozen=True, slots=True)
class HybridCertificate:
    """Greatest deviations found.

    Attributes
    ----------
    samples : int
        Values of zeta that were solved online.
    feasible, infeasible, undecided : int
        Those with a plan, those proven to have none, and those on which the online search gave no word.
    missing : int
        Feasible ones that no region holds.
    superfluous : int
        Infeasible ones that a region holds.
    cost_error : float
        Greatest amount by which the law's value leaves the interval from the proven bound to the cost of the online
        plan, relative to 1 and the cost.
    difference : float
        Greatest difference of value and online cost, relative to 1 and the cost; the gap of the search included.
    """

    samples: int
    feasible: int
    infeasible: int
    undecided: int
    missing: int
    superfluous: int
    cost_error: float
    difference: float

    def holds(self, accuracy: float = 1e-6) -> bool:
        """Whether nothing is missing or superfluous and all values are those of the online controller."""
        return not self.missing and not self.superfluous and self.cost_error <= accuracy


def certify_hybrid(law: HybridLaw, mpc: HybridMpc, samples: int = 200, seed: int = 0) -> HybridCertificate:
    """Compare a law with its controller at random parameters, spread evenly over the box.

    Parameters
    ----------
    law : HybridLaw
    mpc : HybridMpc
        The controller that the law was made from; its gap bounds what the comparison can see.
    samples : int
    seed : int
    """
    rng = np.random.default_rng(seed)
    points = [_random_point(law, rng) for _ in range(samples)]
    moves = [online_move(law, mpc, point) for point in points]
    planned = [(point, move) for point, move in zip(points, moves, strict=True) if move.ok]
    without = [p for p, move in zip(points, moves, strict=True) if move.status is MoveStatus.INFEASIBLE]
    held = [(law.value(point), move) for point, move in planned]
    found = [(value, move) for value, move in held if np.isfinite(value)]
    return HybridCertificate(
        samples=samples,
        feasible=len(planned),
        infeasible=len(without),
        undecided=samples - len(planned) - len(without),
        missing=sum(_is_missing(law, point, rng) for point, _ in planned),
        superfluous=sum(_is_superfluous(law, point, rng) for point in without),
        cost_error=max((_outside(value, move) for value, move in found), default=0.0),
        difference=max((abs(value - move.cost) / max(1.0, abs(move.cost)) for value, move in found), default=0.0),
    )


def online_move(law: HybridLaw, mpc: HybridMpc, zeta: Vector) -> Move:
    """The answer of the controller at a value of zeta."""
    free = iter(zeta.tolist())
    values = {p: p.value if p.is_fixed else next(free) for p in law.parameters.every}
    state = [values[p] for p in law.parameters.group(STATE)]
    last = [values[p] for p in law.parameters.group(LAST)]
    references = {p.signal: values[p] for p in law.parameters.group(REFERENCE)}
    return mpc.solve(state, references or None, warm=False, last_input=last or None)


def _random_point(law: HybridLaw, rng: np.random.Generator) -> Vector:
    return np.array(
        [float(rng.integers(0, 2)) if p.is_bool else rng.uniform(p.low, p.high) for p in law.parameters.free]
    )


def _outside(value: float, move: Move) -> float:
    """Distance of a value from the interval of what the optimum can be."""
    return max(move.bound - value, value - move.cost, 0.0) / max(1.0, abs(move.cost))


def _is_missing(law: HybridLaw, point: Vector, rng: np.random.Generator) -> bool:
    return law.locate(point) is None and all(law.locate(other) is None for other in _around(law, point, rng))


def _is_superfluous(law: HybridLaw, point: Vector, rng: np.random.Generator) -> bool:
    return law.locate(point) is not None and all(law.locate(other) is not None for other in _around(law, point, rng))


def _around(law: HybridLaw, point: Vector, rng: np.random.Generator) -> list[Vector]:
    """Points close by: the online solver's tolerances may put a point on the other side of an edge."""
    real = np.array([0.0 if p.is_bool else _NEAR * (p.high - p.low) for p in law.parameters.free])
    return [point + real * rng.uniform(-1, 1, len(point)) for _ in range(8)]
