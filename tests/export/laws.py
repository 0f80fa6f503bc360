"""Laws that the tests of the writers share."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.mpqp import MpQp, solve_mpqp

DATA = Path(__file__).parents[1] / "data" / "mpqp"


@cache
def solved(name: str) -> ExplicitLaw:
    data = np.load(DATA / f"{name}.npz")
    fields = (data[key] for key in ("H", "f", "F_theta", "G", "w", "S"))
    problem = MpQp(*fields, Polyhedron.box(data["lb"], data["ub"]))
    names = tuple(f"x{j + 1}" for j in range(problem.p))
    return ExplicitLaw.of(solve_mpqp(problem), int(data["nu"]), names)


@cache
def saturation() -> ExplicitLaw:
    """``u = max(-1, min(1, -x))`` for x in [-3, 3]."""
    rows = [[1.0], [-1.0]]
    problem = MpQp(np.eye(1), [0.0], [[1.0]], rows, [1.0, 1.0], np.zeros((2, 1)), Polyhedron.box([-3.0], [3.0]))
    return ExplicitLaw.of(solve_mpqp(problem), names=("x",))


def without(law: ExplicitLaw, region: int) -> ExplicitLaw:
    """A law with a hole."""
    kept = [r for r in range(law.count) if r != region]
    rows = [law.rows(r) for r in kept]
    return replace(
        law.without_value(),
        A=np.vstack([A for A, _ in rows]),
        b=np.concatenate([b for _, b in rows]),
        starts=np.cumsum([0, *(len(b) for _, b in rows)]),
        K=law.K[kept, : law.moves],
        k=law.k[kept, : law.moves],
        active=tuple(law.active[r] for r in kept),
    )


def inner_region(law: ExplicitLaw) -> int:
    """A region in the middle of the domain."""
    low, high = law.domain.bounding_box
    return law.locate((low + high) / 2.0)
