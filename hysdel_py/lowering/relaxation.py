"""The linear relaxation of a Dha, asked for the greatest value of one form at a time.

The relaxation holds the ranges of the variables, Booleans between 0 and 1, and the rows of the items. For a form only
those items take part on which it depends, so that a question costs the same in a model of ten items and of ten
thousand. Leaving out rows loosens an answer and never makes it wrong.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineRequirement, Dha, DhaItem, LogicRequirement

if TYPE_CHECKING:
    from hysdel_py.geometry.lp import Lp

__all__ = ["DEFAULT_EFFORT", "Effort", "Greatest", "Relaxation"]

Interval = tuple[float, float]
Forms = tuple[Affine, ...]


@dataclass(frozen=True, slots=True)
class Effort:
    """How far a question reaches, and when its answer counts.

    Attributes
    ----------
    rows : int
        Once a program has so many rows, no further items join it.
    gain : float
        A bound replaces another only if it is better by this much, relative to its size and at least absolute.
    rounding : float
        By how much a bound is moved outwards, relative to the greatest size of the terms of its form. One that then
        lies above 0 by no more than a few times that is 0.
    negligible : float
        A bound that lies below 0 by less than this, relative to the same size, is 0 as well: a coefficient as small as
        that is worse for a solver than a slightly looser row.
    margin : float
        A row is impossible over the ranges only if it is exceeded by this much, relative to its largest coefficient.
    passes : int
        How often every constant is computed; each time from the rows of the time before.
    """

    rows: int = 80
    gain: float = 1e-6
    rounding: float = 1e-14
    negligible: float = 1e-5
    margin: float = 1e-9
    passes: int = 1


DEFAULT_EFFORT = Effort()


@dataclass(frozen=True, slots=True)
class Greatest:
    """Answer to a question.

    Attributes
    ----------
    bound : float
        No point of the relaxation gives the form a greater value; infinite where nothing is proven.
    empty : bool
        Whether it is proven that there is no point at all; `bound` is then minus infinity.
    """

    bound: float
    empty: bool = False


_EMPTY = Greatest(-math.inf, empty=True)


class Relaxation:
    """Ranges and rows of a Dha; both may be narrowed while questions are asked.

    Parameters
    ----------
    dha : Dha
    boxes : mapping of name to (low, high)
        Ranges of all variables, infinite where unknown.
    rows_of : callable
        Forms that are at most 0 by an item; asked once for each item.
    effort : Effort, optional
    """

    def __init__(
        self,
        dha: Dha,
        boxes: Mapping[str, Interval],
        rows_of: Callable[[DhaItem], Forms],
        effort: Effort = DEFAULT_EFFORT,
    ) -> None:
        auxiliaries = {v.name for v in (*dha.d, *dha.z)}
        self._definitions = {name: item for name, item in dha.definitions.items() if name in auxiliaries}
        self._requirements = _by_variable(dha)
        self._boxes = dict(boxes)
        self._rows_of = rows_of
        self._rows: dict[int, Forms] = {}
        self._answers: dict[tuple[bytes, ...], Greatest] = {}
        self._effort = effort
        self.programs = 0

    def narrow(self, name: str, box: Interval) -> None:
        """Replace the range of a variable by one that is proven."""
        self._boxes[name] = box

    def tighten(self, item: DhaItem, rows: Forms) -> None:
        """Replace the rows of an item by tighter ones."""
        self._rows[id(item)] = rows

    def greatest(self, form: Affine, fixed: Mapping[str, float], without: str = "") -> Greatest:
        """Bound a form from above.

        Parameters
        ----------
        fixed : mapping of name to number
            Booleans that have a value.
        without : str
            A variable whose definition takes no part.
        """
        if any(not self._boxes[name][0] <= value <= self._boxes[name][1] for name, value in fixed.items()):
            return _EMPTY
        objective = _fixed(form, fixed)
        rows = [_fixed(row, fixed) for row in self._reachable((*_names(form), *fixed), without)]
        boxes = {name: self._boxes[name] for part in (objective, *rows) for name in _names(part)}
        needed = _absorbed(rows, boxes, self._effort.margin)
        if needed is None:
            return _EMPTY
        found = Greatest(objective.range(boxes.__getitem__)[1])
        if needed:
            solved = self._solved(objective, needed, boxes)
            found = Greatest(min(solved.bound, found.bound), solved.empty)
        return found if found.empty else Greatest(self._outwards(found.bound, objective))

    def _outwards(self, bound: float, form: Affine) -> float:
        extent = self._extent(form)
        moved = bound + self._effort.rounding * extent
        return 0.0 if -self._effort.negligible * extent < moved <= 4 * self._effort.rounding * extent else moved

    def _extent(self, form: Affine) -> float:
        sizes = (abs(c) * max(map(abs, self._boxes[name])) for name, c in form.terms)
        return abs(form.constant) + sum(size for size in sizes if math.isfinite(size))

    def _solved(self, objective: Affine, rows: list[Affine], boxes: Mapping[str, Interval]) -> Greatest:
        lp = _program(objective, rows, boxes)
        key = (np.array(lp.A.shape).tobytes(), *(array.tobytes() for array in (lp.c, lp.A, lp.b, lp.lb, lp.ub)))
        if key not in self._answers:
            self.programs += 1
            self._answers[key] = _answer(lp)
        found = self._answers[key]
        return Greatest(found.bound + objective.constant, found.empty)

    def _reachable(self, names: tuple[str, ...], without: str) -> Iterator[Affine]:
        """Rows of the items on which variables depend, then of the requirements that share a variable with these."""
        taken: dict[int, Forms] = {}
        seen = self._follow(names, without, taken)
        requirements = {id(item): item for name in seen for item in self._requirements.get(name, ())}
        for item in requirements.values():
            if self._take(item, taken):
                self._follow(tuple(n for row in taken[id(item)] for n in _names(row)), without, taken)
        return (row for rows in taken.values() for row in rows)

    def _follow(self, names: tuple[str, ...], without: str, taken: dict[int, Forms]) -> tuple[str, ...]:
        """Take the definitions of variables and of all that these read, nearest first; every variable met."""
        met = dict.fromkeys(names)
        queue = list(met)
        for name in queue:
            item = self._definitions.get(name)
            if name == without or item is None or id(item) in taken or not self._take(item, taken):
                continue
            new = [n for row in taken[id(item)] for n in _names(row) if n not in met]
            met |= dict.fromkeys(new)
            queue.extend(dict.fromkeys(new))
        return tuple(met)

    def _take(self, item: DhaItem, taken: dict[int, Forms]) -> bool:
        rows = self._rows.get(id(item))
        if rows is None:
            rows = self._rows[id(item)] = self._rows_of(item)
        fits = sum(map(len, taken.values())) + len(rows) <= self._effort.rows
        if fits:
            taken[id(item)] = rows
        return fits


def _by_variable(dha: Dha) -> Mapping[str, list[DhaItem]]:
    """The requirements that read each variable."""
    reading: dict[str, list[DhaItem]] = {}
    for item in dha.requirements:
        for name in _read_by(item):
            reading.setdefault(name, []).append(item)
    return reading


def _read_by(item: AffineRequirement | LogicRequirement) -> tuple[str, ...]:
    return _names(item.value) if isinstance(item, AffineRequirement) else item.value.names


def _names(form: Affine) -> tuple[str, ...]:
    return tuple(name for name, coefficient in form.terms if coefficient)


def _size(form: Affine) -> float:
    return max(1.0, abs(form.constant), *(abs(c) for _, c in form.terms))


def _fixed(form: Affine, fixed: Mapping[str, float]) -> Affine:
    """A form with numbers in place of some variables, and without terms that are zero."""
    constant = form.constant + sum(c * fixed[name] for name, c in form.terms if name in fixed)
    return Affine(constant, tuple((name, c) for name, c in form.terms if c and name not in fixed))


def _absorbed(rows: list[Affine], boxes: dict[str, Interval], margin: float) -> list[Affine] | None:
    """Turn rows of one variable into ranges and drop rows that hold over the ranges; None if a row cannot hold."""
    while True:
        needed = []
        absorbed = False
        for row in rows:
            low, high = row.range(boxes.__getitem__)
            if low > margin * _size(row):
                return None
            if high > 0 and len(row.terms) == 1:
                absorbed = True
                _absorb(row, boxes)
            elif high > 0:
                needed.append(row)
        if not absorbed:
            return needed
        rows = needed


def _absorb(row: Affine, boxes: dict[str, Interval]) -> None:
    """``c w + k <= 0`` as an end of the range of w, one rounding outwards; crossed ends leave the range as it was."""
    ((name, c),) = row.terms
    low, high = boxes[name]
    end = math.nextafter(-row.constant / c, math.copysign(math.inf, c))
    narrowed = (low, min(high, end)) if c > 0 else (max(low, end), high)
    if narrowed[0] <= narrowed[1]:
        boxes[name] = narrowed


def _program(objective: Affine, rows: list[Affine], boxes: Mapping[str, Interval]) -> Lp:
    """Maximise the terms of the objective; columns in the order in which they are met."""
    from hysdel_py.geometry.lp import Lp

    place: dict[str, int] = {}
    for form in (objective, *rows):
        for name in _names(form):
            place.setdefault(name, len(place))
    A, c = np.zeros((len(rows), len(place))), np.zeros(len(place))
    for name, coefficient in objective.terms:
        c[place.get(name, 0)] += coefficient
    for index, row in enumerate(rows):
        for name, coefficient in row.terms:
            if coefficient:
                A[index, place[name]] += coefficient
    ends = np.array([boxes[name] for name in place]).reshape(-1, 2)
    return Lp(c, A, np.array([-row.constant for row in rows]), ends[:, 0].copy(), ends[:, 1].copy())


def _answer(lp: Lp) -> Greatest:
    from hysdel_py.geometry.lp import LpStatus, is_proven_empty, maximise, sharpened_bound

    found = maximise(lp.c, lp.A, lp.b, lp.lb, lp.ub)
    if found.status is LpStatus.INFEASIBLE:
        return _EMPTY if is_proven_empty(lp) else Greatest(math.inf)
    return Greatest(sharpened_bound(lp, found))
