"""Unions of polyhedra, and what is left of a polyhedron when others are taken away."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.relations import includes

__all__ = ["PolyhedralUnion", "difference"]


def difference(polyhedron: Polyhedron, others: Iterable[Polyhedron]) -> tuple[Polyhedron, ...]:
    """Polyhedra with disjoint interiors whose union is a polyhedron without the interiors of others.

    One of the others after the other is cut away row by row: the part beyond its first row, the part within the first
    and beyond the second, and so on (M. Baotic, "Polytopic computations in constrained optimal control", Automatika 50,
    2009). Parts without inner points are dropped.
    """
    parts = [] if polyhedron.dimension < polyhedron.n else [polyhedron]
    for other in others:
        if other.dimension == other.n:
            parts = [piece for part in parts for piece in _outside(part, other)]
    return tuple(parts)


def _outside(part: Polyhedron, other: Polyhedron) -> Iterator[Polyhedron]:
    """Pieces of a polyhedron outside another one."""
    if not _has_inner_points(part & other):
        yield part
        return
    rest, cut = part, other.normalised()
    for a, b in zip(cut.A, cut.b, strict=True):
        beyond = rest.with_rows(-a, -b)
        if _has_inner_points(beyond):
            yield beyond.minimal()
            rest = rest.with_rows(a, b)


def _has_inner_points(polyhedron: Polyhedron) -> bool:
    return polyhedron.ball.radius > polyhedron.precision.empty


@dataclass(frozen=True, eq=False, repr=False)
class PolyhedralUnion:
    """Points that lie in at least one of some polyhedra.

    Attributes
    ----------
    parts : tuple of Polyhedron
        They may overlap, be flat or empty; at least one.
    """

    parts: tuple[Polyhedron, ...]

    def __repr__(self) -> str:
        return f"<PolyhedralUnion of {len(self.parts)} polyhedra in {self.n} coordinates>"

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        if not self.parts:
            raise ArgumentError("a union needs at least one polyhedron; use Polyhedron.empty(n) for an empty set")
        if len({part.n for part in self.parts}) > 1:
            raise ArgumentError(f"all parts must have as many coordinates; found {sorted({p.n for p in self.parts})}")

    @property
    def n(self) -> int:
        """Dimension of the space."""
        return self.parts[0].n

    def contains(self, w: ArrayLike, tolerance: float = 0.0) -> bool:
        """Whether a point lies in some part."""
        return any(part.contains(w, tolerance) for part in self.parts)

    @property
    def is_empty(self) -> bool:
        """Whether every part is empty."""
        return all(part.is_empty for part in self.parts)

    @property
    def is_full_dimensional(self) -> bool:
        """Whether every part that is not empty has inner points."""
        return not self.is_empty and all(part.is_empty or part.dimension == part.n for part in self.parts)

    @property
    def is_bounded(self) -> bool:
        """Whether every part is bounded."""
        return all(part.is_bounded for part in self.parts)

    @cached_property
    def envelope(self) -> Polyhedron:
        """Convex hull of all parts; closed, as every polyhedron is."""
        found = [part.generators for part in self.parts if not part.is_empty]
        if not found:
            return Polyhedron.empty(self.n)
        points, rays, lines = (np.vstack([getattr(g, what) for g in found]) for what in ("points", "rays", "lines"))
        return Polyhedron.hull(points, rays, lines, self.parts[0].precision)

    @property
    def is_convex(self) -> bool:
        """Whether the union is its convex hull, up to sets without inner points.

        A. Bemporad, K. Fukuda and F. D. Torrisi, "Convexity recognition of the union of polyhedra", Computational
        Geometry 18, 2001.
        """
        return self.covers(self.envelope)

    def covers(self, polyhedron: Polyhedron) -> bool:
        """Whether every point of a polyhedron lies in the union, up to sets without inner points.

        A flat polyhedron is covered if one part holds it.
        """
        if polyhedron.dimension < polyhedron.n:
            return any(includes(part, polyhedron) for part in self.parts)
        return not difference(polyhedron, self.parts)

    @cached_property
    def is_connected(self) -> bool:
        """Whether any two points are joined by a path inside the union."""
        left = [part for part in self.parts if not part.is_empty]
        reached, left = left[:1], left[1:]
        while reached and left:
            here = reached.pop()
            touching = [part for part in left if not (part & here).is_empty]
            left = [part for part in left if all(part is not other for other in touching)]
            reached += touching
        return not left

    def minus(self, others: Iterable[Polyhedron]) -> tuple[Polyhedron, ...]:
        """What is left with the interiors of other polyhedra taken away."""
        taken = tuple(others)
        return tuple(piece for part in self.disjoint for piece in difference(part, taken))

    @cached_property
    def disjoint(self) -> tuple[Polyhedron, ...]:
        """Polyhedra with disjoint interiors and the same union, up to sets without inner points."""
        pieces: list[Polyhedron] = []
        for i, part in enumerate(self.parts):
            pieces += difference(part, self.parts[:i])
        return tuple(pieces)

    @cached_property
    def volume(self) -> float:
        """Volume; what is covered twice counts once."""
        return float(sum(piece.volume for piece in self.disjoint))

    def reduced(self) -> PolyhedralUnion:
        """The same union without parts that the others cover; of equal parts the first stays."""
        kept = [part for part in self.parts if not part.is_empty]
        for part in reversed(tuple(kept)):
            rest = [other for other in kept if other is not part]
            if rest and PolyhedralUnion(tuple(rest)).covers(part):
                kept = rest
        return PolyhedralUnion(tuple(kept) or (Polyhedron.empty(self.n),))

    def merged(self) -> PolyhedralUnion:
        """The same union with neighbours whose union is convex joined, until no two are left."""
        parts = list(self.reduced().parts)
        while (pair := _joinable(parts)) is not None:
            i, j, joined = pair
            parts = [part for k, part in enumerate(parts) if k not in {i, j}] + [joined]
        return PolyhedralUnion(tuple(parts))


def _joinable(parts: list[Polyhedron]) -> tuple[int, int, Polyhedron] | None:
    for i, first in enumerate(parts):
        for j in range(i + 1, len(parts)):
            if (first & parts[j]).dimension < first.n - 1:
                continue
            pair = PolyhedralUnion((first, parts[j]))
            if pair.is_convex:
                return i, j, pair.envelope
    return None
