"""Regions with the same law of the moves joined where their union is convex.

Two polyhedra have a convex union when their envelope, the rows of each that the other keeps, holds nothing else
(A. Bemporad, K. Fukuda and F. Torrisi, "Convexity recognition of the union of polyhedra", Computational Geometry 18,
2001). Pairs are joined until none is left; the result depends on the order and need not be the smallest.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import Array, ExplicitLaw, Vector
from hysdel_py.control.explicit_tree import same_moves
from hysdel_py.optimize.parametric.cover import Rows, point_inside, uncovered_point
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["merge"]

_ROOM = 1e-7
"""What is left out of a union must hold a ball of this radius to count."""


@dataclass(frozen=True, eq=False, slots=True)
class _Piece:
    """A union of regions, and one of them."""

    rows: Rows
    region: int


def merge(law: ExplicitLaw) -> ExplicitLaw:
    """A law with the same moves over at most as many regions."""
    families: dict[Hashable, list[_Piece]] = defaultdict(list)
    for region, key in enumerate(same_moves(law)):
        families[key].append(_Piece(law.rows(region), region))
    settings = MpQpSettings()
    pieces = [piece for family in families.values() for piece in _joined(family, settings)]
    kept = [piece.region for piece in pieces]
    base = law.without_value()
    return replace(
        base,
        A=np.vstack([np.zeros((0, law.p)), *(piece.rows[0] for piece in pieces)]),
        b=np.concatenate([np.zeros(0), *(piece.rows[1] for piece in pieces)]),
        starts=np.cumsum([0, *(len(piece.rows[1]) for piece in pieces)]),
        K=base.K[kept],
        k=base.k[kept],
        active=tuple(law.active[region] for region in kept),
    )


def _joined(family: list[_Piece], settings: MpQpSettings) -> list[_Piece]:
    """Pairs joined until no union of two is convex."""
    done: list[_Piece] = []
    pending = list(family)
    while pending:
        piece = pending.pop(0)
        for number, other in enumerate(pending):
            rows = _convex_union(piece.rows, other.rows, settings)
            if rows is not None:
                pending[number] = _Piece(rows, min(piece.region, other.region))
                break
        else:
            done.append(piece)
    return done


def _convex_union(first: Rows, second: Rows, settings: MpQpSettings) -> Rows | None:
    """Rows of the union if it is convex and the two touch along a facet."""
    if not _share_a_hyperplane(first, second):
        return None
    N = np.vstack([first[0][_kept(first, second, settings)], second[0][_kept(second, first, settings)]])
    h = np.concatenate([first[1][_kept(first, second, settings)], second[1][_kept(second, first, settings)]])
    if not len(h) or uncovered_point((N, h), [first, second], _ROOM, settings) is not None:
        return None
    own = _distinct(N, h)
    return N[own], h[own]


def _share_a_hyperplane(first: Rows, second: Rows) -> bool:
    opposite = np.abs(first[0][:, None, :] + second[0][None, :, :]).max(axis=2) < _ROOM
    return bool(np.any(opposite & (np.abs(first[1][:, None] + second[1][None, :]) < _ROOM)))


def _kept(rows: Rows, other: Rows, settings: MpQpSettings) -> NDArray[np.bool_]:
    """Rows that the other polyhedron does not exceed."""
    return np.array([_not_exceeded(normal, side, other, settings) for normal, side in zip(*rows, strict=True)])


def _not_exceeded(normal: Vector, side: float, other: Rows, settings: MpQpSettings) -> bool:
    beyond = np.vstack([other[0], -normal]), np.append(other[1], -side - _ROOM)
    return point_inside(beyond, 0.0, settings) is None


def _distinct(N: Array, h: Vector) -> NDArray[np.intp]:
    """Rows of an envelope without repetitions; each is a facet of one of the two and stays one."""
    kept: list[int] = []
    for row in range(len(h)):
        if not any(np.abs(N[row] - N[o]).max() < _ROOM and abs(h[row] - h[o]) < _ROOM for o in kept):
            kept.append(row)
    return np.array(kept, dtype=np.intp)
