"""The arrays that the compiled branch and bound works in, kept from one problem to the next of the same matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.certificate import UNIT_ROUNDOFF, diagonal_curvature
from hysdel_py.optimize.dense import DenseSolver
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.mixed_integer import Cover, Miqp, MiqpSettings
from hysdel_py.optimize.qp import Qp

__all__ = ["Workspace"]

Vector = NDArray[np.float64]
ROOM = 64
"""Nodes for which there is room at first."""
WORDS = 64
"""Guessed words that are remembered."""


class Workspace:
    """Everything that the compiled loop keeps between calls, for one set of matrices.

    Attributes
    ----------
    tree, state : tuples of arrays
        See :mod:`hysdel_py.optimize.kernels.search`.
    """

    def __init__(self, miqp: Miqp, settings: MiqpSettings, dense: DenseSolver, columns: Any) -> None:
        from hysdel_py.optimize.kernels import search, tree

        n, m = miqp.qp.n, miqp.qp.m
        self.dense, self.columns = dense, columns
        self.binaries, self.priorities = miqp.binaries.astype(np.int64), np.array(miqp.priorities, dtype=float)
        self.decisions = _decisions(miqp)
        self.spare = diagonal_curvature(miqp.qp.P)
        self.rounding = 2 * (n + m + 8) * UNIT_ROUNDOFF
        self.tree = _room(ROOM, n, min(n, dense.settings.largest), len(self.binaries))
        self.recorded = _no_cover(settings.leaves, n, m, len(self.binaries))
        self.nothing_carried = _no_cover(0, n, m, len(self.binaries))[:5]
        self.state: tuple[Any, ...] = (
            np.zeros(n), np.zeros(search.HOW_MANY), np.zeros(tree.HOW_MANY, dtype=np.int64), (np.zeros(n), np.zeros(n)),
            np.full(n, np.nan), np.zeros(WORDS, dtype=np.int64), (np.zeros(n), np.zeros(n)),
            np.zeros((n, 2), dtype=np.int64), np.zeros((WORDS, len(self.binaries))), np.zeros((n, 4)),
            np.zeros(len(self.binaries), dtype=np.int64), np.zeros(m), self.recorded,
            (np.zeros(n), np.zeros(m)), self.nothing_carried,
        )  # fmt: skip
        s, d, p = settings, dense.settings, settings.propagation
        self.settings = (
            (float(s.gap_abs), float(s.gap_rel)),
            (float(d.tolerance), int(d.iterations), float(d.proximity), int(d.rounds), int(d.largest)),
            (float(p.margin), float(p.integrality), float(p.progress), float(p.huge), int(p.rounds)),
            float(s.feasibility), float(s.integrality), int(s.rounding), int(s.probing), bool(s.narrowing),
        )  # fmt: skip

    def data(self, qp: Qp, curvature: Vector | None) -> tuple[Any, ...]:
        """What the kernels are told of a problem with these matrices."""
        d = self.dense
        q, l, u, lb, ub = (np.array(vector) for vector in (qp.q, qp.l, qp.u, qp.lb, qp.ub))  # noqa: E741
        rows = (*d.rows[:2], d.rows[2].copy())  # probing changes them
        problem = (d.P, q, rows, l, u, d.integer)
        known = (float(qp.constant), np.zeros(qp.n) if curvature is None else np.array(curvature), self.rounding)
        return (
            problem,
            d.groups,
            self.columns,
            (lb, ub),
            self.decisions,
            self.binaries,
            self.priorities,
            known,
            self.spare,
        )

    def grow(self) -> None:
        """Make room for twice as many nodes."""
        room, n = self.tree[its.LOWER].shape
        larger = _room(2 * room, n, self.tree[its.ACTIVES].shape[1], len(self.binaries))
        for new, old in zip(larger, self.tree, strict=True):
            new[:room] = old
        self.tree = larger

    def carry(self, cover: Cover | None) -> None:
        """Forget the ends of the last tree, and take in those from which the next one is to begin."""
        limits = self.recorded[5]
        limits[:] = 0, len(self.binaries)
        self.state = (*self.state[:-1], self.nothing_carried if cover is None else cover.arrays())
        while cover is not None and len(self.tree[its.ORDER]) < len(cover.lengths) + 2:
            self.grow()

    def noted(self) -> Cover | None:
        """The ends of the tree, if there are several; nodes that are still open are among them."""
        from hysdel_py.optimize.kernels.cover import COUNT, keep_open

        if not len(self.recorded[0]):
            return None
        keep_open(self.tree, self.state[its.COUNTERS], self.recorded)
        count = int(self.recorded[5][COUNT])
        return Cover(*(array[:count].copy() for array in self.recorded[:5])) if count > 1 else None


def _no_cover(size: int, n: int, m: int, binaries: int) -> tuple[Any, ...]:
    """Room for the ends of a tree; see :mod:`hysdel_py.optimize.kernels.cover`."""
    whole = [np.zeros(shape, dtype=np.int64) for shape in ((size, binaries), size)]
    return (
        *whole,
        np.zeros((size, n)),
        np.zeros((size, m)),
        np.zeros(size, dtype=np.int64),
        np.zeros(2, dtype=np.int64),
    )


def _room(size: int, n: int, width: int, binaries: int) -> tuple[Any, ...]:
    """Arrays for the nodes of a tree."""
    whole = [np.zeros(shape, dtype=np.int64) for shape in (size, (size, width), size)]
    real = [np.zeros(shape) for shape in ((size, n), (size, n), size)]
    split = np.zeros((size, 3), dtype=np.int64)
    ways = np.zeros((size, binaries), dtype=np.int64)
    return (*real, split, *whole, np.arange(size), np.zeros((size, n)), ways)


def _decisions(miqp: Miqp) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Drivers and binaries in the order in which a guess settles them, and which are drivers.

    With drivers that is the order of the variables, which follows time; without, that of the priorities.
    """
    if not len(miqp.drivers):
        order = np.argsort(miqp.priorities, kind="stable")
        return miqp.binaries[order].astype(np.int64), np.zeros(len(order), dtype=np.bool_)
    both = np.concatenate([miqp.drivers, miqp.binaries]).astype(np.int64)
    real = np.arange(len(both)) < len(miqp.drivers)
    order = np.argsort(both, kind="stable")
    return both[order], real[order]
