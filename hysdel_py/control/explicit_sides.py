"""Where the regions of an explicit law lie: inner points, samples, and which of them meet a polyhedron.

Samples prove cheaply that a region has points somewhere. What they leave open is decided by nearest-point problems,
which are counted, so that a search can be ended after a fixed amount of work, the same on every machine.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import Array, ExplicitLaw, Vector
from hysdel_py.optimize.parametric.cover import Rows
from hysdel_py.optimize.parametric.settings import MpQpSettings
from hysdel_py.optimize.parametric.stack import inner_points, meeting, samples

__all__ = ["RegionStack"]

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

_DIRECTIONS = 12
"""Chords through the inner point of a region, at whose ends samples lie."""

_SHARE = 0.95
"""Samples lie at this share of the way to the border."""

_SEED = 3


class RegionStack:
    """The regions of a law as writable arrays for the kernels, with points inside them.

    Attributes
    ----------
    A, b, starts : arrays
        Those of the law.
    centres : array of shape (count, p)
    work : int
        Nearest-point problems solved so far.
    """

    def __init__(self, law: ExplicitLaw) -> None:
        self.law = law
        self.settings = MpQpSettings()
        self.A: Array = np.array(law.A)
        self.b: Vector = np.array(law.b)
        self.starts: Ints = np.array(law.starts)
        self.work = 0

    @cached_property
    def centres(self) -> Array:
        """A point of each region, as far from its facets as a few margins tell."""
        s = self.settings
        found, points = inner_points(self.A, self.b, self.starts, s.margins, s.violation, s.angle)
        return np.where(found[:, None], points, 0.0)

    @cached_property
    def points(self) -> Array:
        """Samples of each region, of shape (count, samples, p); the first is the inner point."""
        directions = np.random.default_rng(_SEED).normal(size=(_DIRECTIONS, self.law.p))
        return np.asarray(samples(self.A, self.b, self.starts, self.centres, directions, _SHARE))

    def meeting(self, regions: Ints, rows: Rows) -> Flags:
        """Which of the regions have a point in a polyhedron."""
        return self._meeting(regions, rows, first=False)

    def any_meeting(self, regions: Ints, rows: Rows) -> bool:
        """Whether one of the regions has a point in a polyhedron."""
        return bool(self._meeting(regions, rows, first=True).any())

    def _meeting(self, regions: Ints, rows: Rows, *, first: bool) -> Flags:
        self.work += len(regions)
        s, (N, h) = self.settings, rows
        answer = meeting(
            self.A, self.b, self.starts, np.asarray(regions, dtype=np.int64), self.centres,
            np.ascontiguousarray(N, dtype=float), np.array(h, dtype=float), first, s.violation, s.angle,
        )  # fmt: skip
        return np.asarray(answer)

    def inside(self, regions: Ints, rows: Rows, depth: float) -> Flags:
        """Which samples of the regions lie in a polyhedron, at least so deep; of shape (regions, samples)."""
        N, h = rows
        return np.asarray(np.all(self.points[regions] @ N.T <= h - depth, axis=2))

    def representatives(self, regions: Ints, inside: Flags) -> Array:
        """The mean of the samples that lie inside, the inner point of a region without any."""
        counts = inside.sum(axis=1)
        sums: Vector = np.einsum("ns,nsp->np", inside.astype(float), self.points[regions])
        return np.where(counts[:, None] > 0, sums / np.maximum(counts, 1)[:, None], self.centres[regions])
