"""Mld to Pwa, from the matrices alone.

Input: an Mld, wherever it comes from. Output: its modes, one for each word of the binaries that the rows allow.
Preserved: the steps of the Mld. The search fixes one binary after the other and prunes with the relaxation in which the
others lie between 0 and 1; where all are fixed, the rows that became equations give z, and the others the region. It
shares nothing with :mod:`hysdel_py.lowering.modes` but the cells, so that each checks the other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import SimulationError
from hysdel_py.geometry.cell import Cell
from hysdel_py.geometry.solver import LpSolver
from hysdel_py.lowering.mode_space import Space
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.mode import Auxiliaries, Condition, Mode, RowKind
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.pwa import Effort, Pwa

__all__ = ["mld_to_pwa"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Fixed = tuple[tuple[int, float], ...]

Unknowns = tuple[tuple[str, int], ...]
Sized = tuple[Matrix, Matrix]
"""Sums and, in the same places, the absolute sums of the terms that they were added up from."""

_ROUNDING = 1e-13
"""A sum below this, relative to the absolute sum of its terms, is what rounding has left of zero."""


def mld_to_pwa(
    mld: Mld, *, split_booleans: bool, max_modes: int, progress: Callable[[int, int, int], None] | None = None
) -> Pwa:
    """Find the modes of an Mld; parameters as in :func:`hysdel_py.lowering.modes.dha_to_pwa`.

    Raises
    ------
    SimulationError
        The rows leave a real auxiliary open in some mode.
    """
    return _Search(mld, split_booleans=split_booleans).run(max_modes, progress)


@dataclass(frozen=True, eq=False, slots=True)
class _Rows:
    """``W w + D d + Z z <= b``."""

    W: Matrix
    D: Matrix
    Z: Matrix
    b: Vector

    @classmethod
    def of(cls, mld: Mld) -> _Rows:
        W = -np.hstack([mld.E4.toarray(), mld.E1.toarray()])
        return cls(W, mld.E2.toarray(), mld.E3.toarray(), np.asarray(mld.E5))


@dataclass(frozen=True, eq=False, slots=True)
class _Leaf:
    """A word of binaries: their values, the rows ``region (w, 1) <= 0``, and z with its size.

    Rows read the columns `open_columns` of Boolean coordinates without a value, which need one before they can cut.
    """

    d: Vector
    truths: dict[str, float]
    region: Matrix
    z: Sized
    open_columns: tuple[int, ...]


class _Search:
    """Words of binaries that wait, and the modes that were found."""

    def __init__(self, mld: Mld, *, split_booleans: bool) -> None:
        self._mld = mld
        self._rows = _Rows.of(mld)
        self._used = _used_columns(mld, self._rows)
        every = tuple(v.name for v in (*mld.x, *mld.u) if v.is_bool)
        self._space = Space(mld.x, mld.u, (*every, *(v.name for v in mld.d)))
        self._chosen = self._decisive(every if split_booleans else ())
        self._solver = LpSolver()
        self._modes: list[Mode] = []
        self._leaves: list[Auxiliaries] = []
        self._cells = 0

    def _decisive(self, every: tuple[str, ...]) -> tuple[int, ...]:
        """Columns of the Boolean coordinates that rows read, other than those that only define z by an equation."""
        rows = self._rows
        opposite = _opposite_rows(np.hstack([rows.W, rows.D, rows.Z]), rows.b)
        equations = {row for row in opposite if rows.Z[row].any()}
        read = np.any(np.delete(rows.W, sorted(equations), axis=0) != 0, axis=0)
        passed = np.any(rows.W != 0, axis=0) & self._reaches_inequalities(equations)
        columns = self._space.boolean_columns
        return tuple(c for name, c in columns.items() if name in every or read[c] or passed[c])

    def _reaches_inequalities(self, equations: set[int]) -> NDArray[np.bool_]:
        """Coordinates from which a chain of equations leads to a z that an inequality reads."""
        Z, W = self._rows.Z != 0, self._rows.W != 0
        rows = sorted(equations)
        reads = np.any(np.delete(Z, rows, axis=0), axis=0)
        for _ in range(Z.shape[1]):
            linked = Z[rows][np.any(Z[rows] & reads, axis=1)]
            reads = reads | np.any(linked, axis=0)
        return np.asarray(np.any(W[rows][np.any(Z[rows] & reads, axis=1)], axis=0))

    def run(self, max_modes: int, progress: Callable[[int, int, int], None] | None) -> Pwa:
        """Fix binary after binary, the value 1 first."""
        unknowns = (*(("d", k) for k in range(self._mld.nd)), *(("w", c) for c in self._chosen))
        pending: list[tuple[Unknowns, tuple[float, ...]]] = [(unknowns, ())]
        while pending and len(self._modes) < max_modes:
            unknowns, word = pending.pop()
            self._cells += 1
            if len(word) < len(unknowns):
                pending += [(unknowns, child) for child in self._children(unknowns, word)]
                continue
            leaf = self._leaf(unknowns, word)
            if leaf.open_columns:
                pending.append(((*unknowns, *(("w", c) for c in leaf.open_columns)), word))
                continue
            self._add_mode(leaf)
            if progress is not None:
                progress(len(self._modes), len(pending), self._solver.solved)
        return self._pwa(is_complete=not pending)

    def _children(self, unknowns: Unknowns, word: tuple[float, ...]) -> list[tuple[float, ...]]:
        values = (0.0, 1.0) if self._is_used(unknowns[len(word)]) else (0.0,)
        return [child for value in values if self._may_hold(unknowns, child := (*word, value))]

    def _is_used(self, unknown: tuple[str, int]) -> bool:
        return unknown[0] == "w" or bool(self._used[unknown[1]])

    def _may_hold(self, unknowns: Unknowns, word: tuple[float, ...]) -> bool:
        """Whether the relaxation leaves a point; only a proven bound prunes."""
        mld, rows = self._mld, self._rows
        columns = (*mld.x, *mld.u, *mld.d, *mld.z)
        low, high = np.array([v.low for v in columns], dtype=float), np.array([v.high for v in columns], dtype=float)
        offset = len(self._space.names)
        for (kind, column), value in zip(unknowns, word, strict=False):
            place = column + offset * (kind == "d")
            low[place] = high[place] = value
        A = np.hstack([rows.W, rows.D, rows.Z])
        has_terms = np.any(A, axis=1)
        lengths = np.where(has_terms, np.linalg.norm(A, axis=1), 1.0)
        slack = np.column_stack([A / lengths[:, None], has_terms.astype(float)])
        cost = np.append(np.zeros(A.shape[1]), 1.0)
        answer = self._solver.maximise(cost, slack, rows.b / lengths, np.append(low, -1.0), np.append(high, 1.0))
        return not answer.bound < -self._solver.precision.touch

    def _leaf(self, unknowns: Unknowns, word: tuple[float, ...]) -> _Leaf:
        """What the rows say where the binaries have the values of a word."""
        space = self._space
        d = np.array(word[: self._mld.nd])
        truths = {v.name: value for v, value in zip(self._mld.d, d, strict=True)}
        truths |= {space.names[c]: value for (kind, c), value in zip(unknowns, word, strict=True) if kind == "w"}
        left, size = self._left_sides(d, truths)
        z, z_size = self._solve_z(left, size)
        region = _cleaned(left + self._rows.Z @ z, size + np.abs(self._rows.Z) @ z_size)
        free = [c for name, c in space.boolean_columns.items() if name not in truths]
        open_columns = tuple(c for c in free if region[:, c].any())
        return _Leaf(d, truths, region, (z, z_size), open_columns)

    def _add_mode(self, leaf: _Leaf) -> None:
        space, precision = self._space, self._solver.precision
        cell = self._cell(leaf.region)
        if cell is None:
            return
        maps = tuple(self._maps(blocks, leaf.d, leaf.z) for blocks in self._equations())
        minimal = cell.minimal(self._solver)
        self._modes.append(space.mode(len(self._modes), leaf.truths, (maps[0], maps[1]), minimal, precision))
        self._leaves.append(space.auxiliaries(leaf.d.tolist(), list(leaf.z[0])))

    def _cell(self, region: Matrix) -> Cell | None:
        """The region of a leaf; None where the rows cannot be met."""
        columns = [*self._space.reals, len(self._space.names)]
        cell: Cell | None = self._space.root
        for row, origin in zip(region, self._mld.rows, strict=True):
            if cell is None:
                return None
            cell = self._cut(cell, row[columns], origin)
        return cell

    def _left_sides(self, d: Vector, truths: dict[str, float]) -> Sized:
        """What stands beside z at fixed binaries: ``left (w, 1) + Z z <= 0``."""
        rows = self._rows
        values = np.zeros(rows.W.shape[1])
        fixed = [column for name, column in self._space.boolean_columns.items() if name in truths]
        values[fixed] = [truths[self._space.names[column]] for column in fixed]
        constant = rows.W @ values + rows.D @ d - rows.b
        size = np.abs(rows.W) @ values + np.abs(rows.D) @ d + np.abs(rows.b)
        W = rows.W.copy()
        W[:, fixed] = 0.0
        return np.column_stack([W, _cleaned(constant, size)]), np.column_stack([np.abs(W), size])

    def _cut(self, cell: Cell, row: Vector, origin: RowOrigin) -> Cell | None:
        a, c = row[:-1], float(row[-1])
        if not a.any():
            return cell if c <= self._mld.tolerances.row else None
        return cell.cut(a, -c, _condition(origin), self._solver)

    def _solve_z(self, left: Matrix, size: Matrix) -> Sized:
        """Maps of z from the rows that became equations: ``Z z = -left w``."""
        rows = self._rows
        used = np.any(rows.Z != 0, axis=0)
        equations = sorted(_opposite_rows(np.hstack([left[:, :-1], rows.Z]), -left[:, -1]))
        Z = rows.Z[equations][:, used]
        z, z_size = np.zeros((2, self._mld.nz, left.shape[1]))
        if not used.any():
            return z, z_size
        if np.linalg.matrix_rank(Z) < int(used.sum()):
            open_names = ", ".join(v.name for v, is_used in zip(self._mld.z, used, strict=True) if is_used)
            raise SimulationError((f"the rows do not determine the real auxiliaries ({open_names}) in every mode",))
        z[used], z_size[used] = _solved(Z, -left[equations], size[equations])
        return z, z_size

    def _equations(self) -> tuple[tuple[Matrix, ...], tuple[Matrix, ...]]:
        m = self._mld
        return (m.A, m.B1, m.B2, m.B3, m.B5), (m.C, m.D1, m.D2, m.D3, m.D5)

    def _maps(self, blocks: tuple[Matrix, ...], d: Vector, z: Sized) -> list[Vector]:
        X, U, D, Z, constant = blocks
        own = np.column_stack([X, U, constant + D @ d])
        size = np.column_stack([np.abs(X), np.abs(U), np.abs(constant) + np.abs(D) @ d])
        return list(_cleaned(own + Z @ z[0], size + np.abs(Z) @ z[1]))

    def _pwa(self, *, is_complete: bool) -> Pwa:
        mld = self._mld
        effort = Effort(self._solver.solved, self._cells)
        return Pwa(
            mld.name, mld.x, mld.u, mld.y, mld.d, mld.z, tuple(self._modes), None, (), tuple(self._leaves),
            tuple(range(len(self._modes))), (), mld.source, is_complete, effort, mld.tolerances,
        )  # fmt: skip


def _cleaned(sums: Matrix, size: Matrix) -> Matrix:
    """Sums without what rounding has left of zero."""
    return np.where(np.abs(sums) <= _ROUNDING * size, 0.0, sums)


def _solved(Z: Matrix, right: Matrix, size: Matrix) -> Sized:
    """One solution of a consistent system, by its independent equations alone, so that simple ones stay exact.

    The elimination ``L U z = right`` adds up terms of the size ``|L| |U| |z| + |right|``, and what their rounding does
    to z is at most ``|Z^-1|`` times as large (N. J. Higham, "Accuracy and Stability of Numerical Algorithms", 2002,
    theorem 9.4). A part of z whose terms cancel is small against that, not against itself.
    """
    from scipy.linalg import lu, qr

    _, _, order = qr(Z.T, mode="economic", pivoting=True)
    chosen = order[: Z.shape[1]]
    z = np.linalg.solve(Z[chosen], right[chosen])
    lower, upper = lu(Z[chosen], permute_l=True)
    terms = np.abs(lower) @ np.abs(upper) @ np.abs(z) + size[chosen]
    z_size = np.abs(np.linalg.inv(Z[chosen])) @ terms
    return _cleaned(z, z_size), z_size


def _used_columns(mld: Mld, rows: _Rows) -> NDArray[np.bool_]:
    """Binaries that appear in a row or an equation; the others are 0."""
    in_equations = np.any(np.vstack([mld.B2, mld.D2]) != 0, axis=0) if mld.nd else np.zeros(0, dtype=bool)
    return np.asarray(in_equations | np.any(rows.D != 0, axis=0))


def _opposite_rows(A: Matrix, b: Vector) -> set[int]:
    """Rows ``a v <= b`` whose opposite ``-a v <= -b`` is there too."""
    whole = np.column_stack([A, b])
    lengths = np.abs(A).max(axis=1, initial=0.0)
    keys: dict[tuple[float, ...], list[int]] = {}
    for row in np.flatnonzero(lengths > 0):
        keys.setdefault(tuple(np.round(whole[row] / lengths[row], 11) + 0.0), []).append(int(row))
    found: set[int] = set()
    for key, members in keys.items():
        if tuple(-k + 0.0 for k in key) in keys:
            found.update(members)
    return found


def _condition(origin: RowOrigin) -> Condition:
    """Source of a row; an AD item has its first row where the Boolean is false."""
    if origin.item != "AD":
        kind = RowKind.MUST if origin.item.endswith("_must") else RowKind.EVENT
        return Condition(kind, origin.defines, text=origin.text, line=origin.line)
    own = origin.text.removeprefix(f"{origin.defines} = ")
    return Condition(
        RowKind.EVENT, origin.defines, origin.subindex != 1, text=own if own != origin.text else "", line=origin.line
    )
