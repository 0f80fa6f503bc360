"""Random points of a hybrid law at which every way to compute it must agree, and the answers there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.errors import ArgumentError
from hysdel_py.export.hybrid_table import HybridTable
from hysdel_py.export.law_points import ReplayPoints

__all__ = ["HybridAnswers", "answers", "hybrid_replay", "random_zeta"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_LEAST = 1e-6
"""Points keep this distance from every facet, and values this relative difference, where agreement is asked for."""

_WIDER = 0.1
_TRIES = 20
_CHUNK = 5_000


@dataclass(frozen=True, eq=False, slots=True)
class HybridAnswers:
    """What a law says at some points, by plain evaluation of all its regions.

    Attributes
    ----------
    inside : Boolean array of shape (n,)
    u : array of shape (n, moves)
        Zero outside.
    is_clear : Boolean array of shape (n,)
        Whether the point is far from all facets, and its value from those of other regions that hold it.
    """

    inside: Flags
    u: Array
    is_clear: Flags


def random_zeta(law: HybridLaw, count: int, rng: np.random.Generator) -> Array:
    """Points of a box a little larger than that of the law; Boolean parameters are 0 or 1."""
    columns = []
    for p in law.parameters.free:
        room = _WIDER * (p.high - p.low)
        columns.append(rng.integers(0, 2, count) if p.is_bool else rng.uniform(p.low - room, p.high + room, count))
    return np.array(columns, dtype=float).T.reshape(count, len(columns))


def answers(table: HybridTable, zeta: Array) -> HybridAnswers:
    """Answers at points whose Boolean entries are 0 or 1."""
    moves, margin = table.table.moves, max(_LEAST, 2.0 * table.table.scaling.margin(table.law.A, -table.law.b))
    inside, clear = np.zeros(len(zeta), dtype=bool), np.ones(len(zeta), dtype=bool)
    u = np.zeros((len(zeta), moves))
    word = (zeta[:, list(table.boolean)] @ (2.0 ** np.arange(len(table.boolean)))).astype(np.int64)
    for number, code in enumerate(table.words):
        every = np.flatnonzero(word == code)
        for part in np.array_split(every, len(every) // _CHUNK + 1):
            group = slice(*table.starts[number : number + 2])
            inside[part], u[part], clear[part] = _of_group(table, group, zeta[part][:, list(table.real)], margin)
    return HybridAnswers(inside, u, clear)


def _of_group(table: HybridTable, group: slice, theta: Array, margin: float) -> tuple[Flags, Array, Flags]:
    law = table.law
    regions = np.arange(group.start, group.stop)
    first, last = law.starts[group.start], law.starts[group.stop]
    excess = np.maximum.reduceat(
        law.A[first:last] @ theta.T - law.b[first:last, None], law.starts[group.start : group.stop] - first, axis=0
    )
    held = excess <= law.tolerance
    values = 0.5 * np.einsum("kij,nj,ni->kn", law.P[regions], theta, theta) + law.q[regions] @ theta.T
    values = np.where(held, values + law.r[regions, None], np.inf)
    least = values.min(axis=0, initial=np.inf)
    inside = np.asarray(held.any(axis=0))
    size = np.where(inside, np.maximum(1.0, np.abs(least)), 1.0)
    best = values <= least + table.tie * size
    chosen = np.argmax(best & held, axis=0)
    rivals = (held & (values <= least + max(_LEAST, 4 * table.tie) * size)).sum(axis=0)
    clear = np.all(np.abs(excess) >= margin, axis=0) & (rivals <= 1)
    u = np.einsum("nij,nj->ni", law.K[regions[chosen], : law.moves], theta) + law.k[regions[chosen], : law.moves]
    return inside, np.where(inside[:, None], u, 0.0), clear


def hybrid_replay(law: HybridLaw, table: HybridTable, count: int, seed: int) -> ReplayPoints:
    """Clear points with the moves that Python finds, a quarter of them outside where there are so many.

    Raises
    ------
    ArgumentError
        The count is negative.
    """
    if count < 0:
        raise ArgumentError(f"points is {count}: zero or more were expected")
    zeta = random_zeta(law, _TRIES * count, np.random.default_rng(seed))
    found = answers(table, zeta)
    outside = zeta[found.is_clear & ~found.inside][: count // 4]
    zeta = np.vstack([zeta[found.is_clear & found.inside][: count - len(outside)], outside])
    moves = [law(point) for point in zeta]
    width = table.table.moves
    u = np.array([np.full(width, np.nan) if move is None else move for move in moves]).reshape(-1, width)
    error = table.table.scaling.move_error(table.law.K[:, :width], table.law.k[:, :width])
    return ReplayPoints(zeta, u, 2.0 * error)
