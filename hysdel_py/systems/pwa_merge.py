"""Joining modes of a piecewise affine system that do the same.

Two polyhedra have a convex union exactly if it is their envelope: the set given by the rows of each that hold on the
other (A. Bemporad, K. Fukuda and F. D. Torrisi, "Convexity recognition of the union of polyhedra", Computational
Geometry 18, 2001). Here two sides of a threshold are a gap apart, and the union may lack that gap.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.redundancy import irredundant_rows
from hysdel_py.geometry.solver import LpSolver
from hysdel_py.systems.mode import Condition, Mode, RowKind, Word
from hysdel_py.systems.sections import Section, facing_rows, section_of
from hysdel_py.systems.signals import Variable

if TYPE_CHECKING:
    from hysdel_py.systems.pwa import Pwa

__all__ = ["equal_dynamics", "merge"]

_SAME = 1e-12
"""A row of two maps is equal up to this, relative to the size of its own terms: what rounding can do, no more."""
_HALF_A_GAP = 0.51
"""Part of a gap by which both of its sides can be missed at once."""

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


def equal_dynamics(pwa: Pwa) -> tuple[tuple[int, ...], ...]:
    """Indices of modes in groups of equal maps."""
    values = tuple(v.is_bool for v in (*pwa.x, *pwa.y))
    reach = _reach((*pwa.x, *pwa.u))
    groups: list[list[Mode]] = []
    for mode in pwa.modes:
        home = next((group for group in groups if _equal(group[0], mode, values, reach)), None)
        if home is None:
            groups.append([mode])
        else:
            home.append(mode)
    return tuple(tuple(mode.index for mode in group) for group in groups)


def _reach(variables: tuple[Variable, ...]) -> Vector:
    """Greatest absolute values of the variables, and 1 for the constant term."""
    return np.array([*(1.0 if v.is_bool else max(abs(v.low), abs(v.high)) for v in variables), 1.0])


def _equal(first: Mode, second: Mode, values: tuple[bool, ...], reach: Vector) -> bool:
    """Whether rows of Booleans (where `values` is true) are the same, and the others up to rounding."""
    one, other = first.dynamics, second.dynamics
    exact = np.array(values, dtype=bool)
    return bool(np.array_equal(one[exact], other[exact])) and _nearly_equal(one[~exact], other[~exact], reach)


def _nearly_equal(one: Matrix, other: Matrix, reach: Vector) -> bool:
    """Whether the rows differ, over the ranges, by no more than rounding of their own terms.

    A variable without a finite range has no greatest term: its coefficients are compared one by one.
    """
    finite = np.isfinite(reach)
    apart, size = np.abs(one - other), np.maximum(np.abs(one), np.abs(other))
    bounded = apart[:, finite] @ reach[finite] <= _SAME * (size[:, finite] @ reach[finite])
    return bool(np.all(bounded) and np.all(apart[:, ~finite] <= _SAME * size[:, ~finite]))


@dataclass(frozen=True, eq=False, slots=True)
class _Joined:
    """A mode that may stand for several, and the indices of these."""

    section: Section
    members: tuple[int, ...]


def merge(pwa: Pwa) -> Pwa:
    """The system with joined modes; greedy, in the order of the modes, until nothing joins."""
    solver = LpSolver()
    variables = (*pwa.x, *pwa.u)
    kept: list[_Joined] = []
    for group in pwa.dynamics:
        kept += _joined_group([_Joined(section_of(pwa.modes[i], variables), (i,)) for i in group], variables, solver)
    kept.sort(key=lambda joined: min(joined.members))
    position = {member: index for index, joined in enumerate(kept) for member in joined.members}
    modes = tuple(replace(joined.section.mode, index=index) for index, joined in enumerate(kept))
    owner = tuple(position[mode] for mode in pwa.owner)
    effort = replace(pwa.effort, programs=pwa.effort.programs + solver.solved)
    return replace(pwa, modes=modes, owner=owner, effort=effort)


def _joined_group(group: list[_Joined], variables: tuple[Variable, ...], solver: LpSolver) -> list[_Joined]:
    """Join any two until no two join."""
    done: list[_Joined] = []
    while group:
        first, *rest = group
        for second in rest:
            union = _union(first.section, second.section, variables, solver)
            if union is not None:
                rest.remove(second)
                joined = _Joined(section_of(union, variables), (*first.members, *second.members))
                rest = [joined, *rest, *done]
                done = []
                break
        else:
            done.append(first)
        group = rest
    return done


def _union(first: Section, second: Section, variables: tuple[Variable, ...], solver: LpSolver) -> Mode | None:
    """The mode on the union of two sections if it is one polyhedron, else None."""
    different = [c for (c, one), (_, other) in zip(first.booleans, second.booleans, strict=True) if one != other]
    if len(different) == 1 and None not in (dict(first.booleans)[different[0]], dict(second.booleans)[different[0]]):
        same = _is_inside(first, second, solver) and _is_inside(second, first, solver)
        rows = list(zip(first.A, first.b, first.sources, strict=True)) if same else None
    elif not different and facing_rows(first, second, solver.precision):
        rows = _convex_union(first, second, solver)
    else:
        rows = None
    if rows is None:
        return None
    word = _common_word(first.mode.word, second.mode.word)
    return _mode(first, second, rows, word, variables=variables, solver=solver)


Row = tuple[Vector, float, Condition]


def _is_inside(inner: Section, outer: Section, solver: LpSolver) -> bool:
    return all(_holds_on(row, side, inner, solver) for row, side in zip(outer.A, outer.b, strict=True))


def _holds_on(row: Vector, side: float, section: Section, solver: LpSolver) -> bool:
    """Whether a row holds on a section, up to the precision of redundant rows."""
    length = float(np.linalg.norm(row))
    allowed = side + solver.precision.redundant * max(length, abs(side))
    if np.where(row != 0, np.maximum(row * section.low, row * section.high), 0.0).sum() <= allowed:
        return True
    bound = np.full(len(row), np.inf)
    matrix, sides = np.vstack([section.A, row]), np.append(section.b, side + length)
    answer = solver.maximise(row, matrix, sides, -bound, bound)
    return answer.is_optimal and answer.value <= allowed


def _convex_union(first: Section, second: Section, solver: LpSolver) -> list[Row] | None:
    """Rows of the envelope if no point of it lies outside both by more than a gap."""
    kept, removed = _by_validity(first, second, solver)
    others_kept, others_removed = _by_validity(second, first, solver)
    envelope = kept + others_kept
    A = np.array([row for row, _, _ in envelope]).reshape(len(envelope), first.A.shape[1])
    b = np.array([side for _, side, _ in envelope])
    convex = all(_nearly_covered(A, b, one, other, solver) for one in removed for other in others_removed)
    return envelope if convex else None


def _by_validity(section: Section, other: Section, solver: LpSolver) -> tuple[list[Row], list[Row]]:
    """Rows of a section that hold on the other, and those that do not."""
    groups: tuple[list[Row], list[Row]] = ([], [])
    for row, side, source in zip(section.A, section.b, section.sources, strict=True):
        groups[0 if _holds_on(row, float(side), other, solver) else 1].append((row, float(side), source))
    return groups


def _nearly_covered(A: NDArray[np.float64], b: Vector, one: Row, other: Row, solver: LpSolver) -> bool:
    """Whether no point of the envelope violates both rows by more than half a gap, each in its own unit."""
    cut = np.array([[*-one[0], 1.0], [*-other[0], 1.0]])
    rows = np.vstack([np.column_stack([A, np.zeros(len(b))]), cut])
    free = np.full(rows.shape[1], np.inf)
    most = np.append(free[:-1], 1.0)
    sides = np.concatenate([b, [-one[1], -other[1]]])
    answer = solver.maximise(np.append(np.zeros(len(free) - 1), 1.0), rows, sides, -free, most)
    if not answer.is_optimal:
        return answer.value == -np.inf
    return answer.value <= _HALF_A_GAP * max(one[2].gap, other[2].gap) + solver.precision.touch


def _common_word(first: Word, second: Word) -> Word:
    pairs = zip(first, second, strict=True)
    return tuple((name, one if one == other else None) for (name, one), (_, other) in pairs)


def _mode(
    first: Section, second: Section, rows: list[Row], word: Word, *, variables: tuple[Variable, ...], solver: LpSolver
) -> Mode:
    """The first mode on the rows of the envelope."""
    reals = [i for i, v in enumerate(variables) if not v.is_bool]
    A = np.array([row for row, _, _ in rows]).reshape(len(rows), len(reals))
    b = np.array([side for _, side, _ in rows])
    needed = irredundant_rows(A, b, np.zeros((0, len(reals))), solver)
    full = np.zeros((len(needed), len(variables)))
    full[:, reals] = A[list(needed)]
    boolean_rows, boolean_sides, boolean_sources = _boolean_rows(first.mode, word)
    region = Polyhedron(
        np.vstack([full, boolean_rows]), np.concatenate([b[list(needed)], boolean_sides]), solver.precision
    )
    sources = (*(rows[i][2] for i in needed), *boolean_sources)
    is_flat = first.mode.is_flat and second.mode.is_flat
    return replace(first.mode, region=region, sources=sources, word=word, is_flat=is_flat)


def _boolean_rows(mode: Mode, word: Word) -> tuple[NDArray[np.float64], Vector, tuple[Condition, ...]]:
    """Rows of the Boolean coordinates; those of a free one become its range."""
    rows = [i for i, source in enumerate(mode.sources) if source.kind is RowKind.BOOLEAN]
    values, sides, sources = dict(word), mode.region.b[rows].copy(), []
    for position, i in enumerate(rows):
        source, is_upper = mode.sources[i], bool(mode.region.A[i].max(initial=0.0) > 0)
        if values[source.name] is None:
            sides[position] = 1.0 if is_upper else 0.0
            source = replace(source, text=f"{source.name} {'<= 1' if is_upper else '>= 0'}")
        sources.append(source)
    return mode.region.A[rows], sides, tuple(sources)
