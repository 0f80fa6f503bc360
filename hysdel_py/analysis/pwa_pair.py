"""A Dha beside a Pwa: which regions hold a point, and whether the mode there does what the Dha does."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.comparison import SHARE, Comparison
from hysdel_py.analysis.encoding import Step
from hysdel_py.analysis.milp import Milp
from hysdel_py.analysis.pwa_words import FullWord
from hysdel_py.analysis.stepping import Outcome, Witness, clipped, differing, take_step
from hysdel_py.errors import SimulationError
from hysdel_py.systems.dha import Event
from hysdel_py.systems.mode import Mode
from hysdel_py.systems.pwa import Pwa

__all__ = ["PwaPair", "exclude_words", "fix_word", "overlapping_pairs"]

Vector = NDArray[np.float64]
Point = Mapping[str, float]


class PwaPair:
    """A Dha and a Pwa over the same states and inputs, prepared for questions.

    Regions, words and maps of the modes are looked at one by one, and the step, which walks the tree, as well.
    """

    def __init__(self, comparison: Comparison, pwa: Pwa) -> None:
        self.comparison, self.pwa = comparison, pwa
        self.names = tuple(v.name for v in (*pwa.x, *pwa.u))

    @cached_property
    def _stacked(self) -> tuple[Vector, Vector, Vector]:
        """Rows of all regions, their sides, and where each region begins."""
        regions = [mode.region for mode in self.pwa.modes]
        starts = np.cumsum([0, *(len(region.b) for region in regions)])
        A = np.vstack([region.A for region in regions]) if regions else np.zeros((0, len(self.names)))
        return A, np.concatenate([np.zeros(0), *(region.b for region in regions)]), starts

    def _holding(self, w: Vector) -> tuple[list[int], list[int]]:
        """Modes whose region holds a point, up to the tolerance of a row, and those that it lies strictly inside."""
        A, b, starts = self._stacked
        slack, size = b - A @ w, np.abs(b) + np.abs(A) @ np.abs(w)
        steps = self.pwa.tolerances
        is_beyond = slack < -steps.row - (steps.rounding + steps.range) * size
        is_near = (slack <= self.comparison.margins.tolerance * (1.0 + size)) & ~self._is_boolean
        parts = list(pairwise(starts))
        holding = [i for i, (a, e) in enumerate(parts) if not is_beyond[a:e].any()]
        return holding, [i for i in holding if not is_near[slice(*parts[i])].any()]

    @cached_property
    def _is_boolean(self) -> NDArray[np.bool_]:
        booleans = np.array([v.is_bool for v in (*self.pwa.x, *self.pwa.u)], dtype=bool)
        return np.asarray((self._stacked[0][:, ~booleans] == 0.0).all(axis=1))

    # ---- what the forms do ------------------------------------------------------------------------------------------

    def compare(self, x: Point, u: Point) -> Witness | None:
        """Step the Dha, look at all regions, and step the Pwa; None if all agree."""
        first = take_step(self.comparison.dha, x, u)
        return self._beside_regions(first, x, u) or self._beside_step(first, x, u)

    def _beside_regions(self, first: Outcome, x: Point, u: Point) -> Witness | None:
        holding, inside = self._holding(self._vector(x, u))
        if len(inside) > 1:
            text = f"the state and input lie inside several modes: {', '.join(map(str, inside))}"
            return self._witness(first, Outcome(problems=(text,)), x, u)
        found: Witness | None = None
        wrong = [index for index in holding if self._is_off_threshold(self.pwa.modes[index], x, u)]
        if wrong:
            return self._beside_mode(first, self.pwa.modes[wrong[0]], x, u)
        for index in inside or (holding if first.exists else self._on_their_side(holding, x, u)):
            witness = self._beside_mode(first, self.pwa.modes[index], x, u)
            if witness is None:
                return None
            found = found or witness
        if found is None and first.exists:
            return self._witness(first, Outcome(problems=("the state and input lie in the region of no mode",)), x, u)
        return found

    def _on_their_side(self, holding: list[int], x: Point, u: Point) -> list[int]:
        """Modes that do not hold by the slack of a row alone, from across a threshold that the point lies on.

        With large coordinates that slack is wider than the gap of a threshold, so that the mode beyond the gap seems to
        hold where its neighbour is forbidden.
        """
        return [index for index in holding if not any(self._misjudged(self.pwa.modes[index], x, u))]

    def _is_off_threshold(self, mode: Mode, x: Point, u: Point) -> bool:
        """Whether the word of a mode has the wrong side of a threshold that the point is clearly off."""
        return any(
            distance >= self.comparison.band(event) * (1.0 - SHARE) for event, distance in self._misjudged(mode, x, u)
        )

    def _misjudged(self, mode: Mode, x: Point, u: Point) -> Iterator[tuple[Event, float]]:
        """Events that the word of a mode has on the other side than the point, with its distance from the threshold."""
        values, word = self.comparison.values_at(x, u), mode.values
        if values is None:
            return
        for event in (item for item in self.comparison.dha.items if isinstance(item, Event)):
            if word.get(event.name) not in (None, bool(values[event.name] > 0.5)):
                yield event, abs(event.form.value(values))

    def _beside_mode(self, first: Outcome, mode: Mode, x: Point, u: Point) -> Witness | None:
        word = {name: float(value) for name, value in mode.word if value is not None}
        given = {**x, **u}
        wrong = tuple(name for name in given if word.get(name, given[name]) != given[name])
        second = self._outcome(mode.map(*self._parts(x, u)), word)
        names = (*wrong, *differing(first, second, self.comparison.tolerances.__getitem__))
        return self._witness(first, second, x, u, names) if names or not first.exists else None

    def _beside_step(self, first: Outcome, x: Point, u: Point) -> Witness | None:
        try:
            x1, y, index = self.pwa.step(*self._parts(x, u))
        except SimulationError as error:
            return self._witness(first, Outcome(problems=error.problems), x, u) if first.exists else None
        word = {name: float(value) for name, value in self.pwa.modes[index].word if value is not None}
        second = self._outcome((x1, y), word)
        names = differing(first, second, self.comparison.tolerances.__getitem__)
        return self._witness(first, second, x, u, names) if names or not first.exists else None

    def _outcome(self, result: tuple[Vector, Vector], word: Mapping[str, float]) -> Outcome:
        states, outputs = (
            tuple((v.name, float(value)) for v, value in zip(group, values, strict=True))
            for group, values in zip((self.pwa.x, self.pwa.y), result, strict=True)
        )
        return Outcome(states, outputs, tuple(word.items()))

    def _witness(self, first: Outcome, second: Outcome, x: Point, u: Point, names: tuple[str, ...] = ()) -> Witness:
        return Witness(tuple(x.items()), tuple(u.items()), first, second, names, "Pwa")

    def _parts(self, x: Point, u: Point) -> tuple[Vector, Vector]:
        return np.array([x[v.name] for v in self.pwa.x]), np.array([u[v.name] for v in self.pwa.u])

    def _vector(self, x: Point, u: Point) -> Vector:
        return np.concatenate(self._parts(x, u))

    # ---- points of searches -----------------------------------------------------------------------------------------

    def witness(self, w: Vector, step: Step) -> Witness | None:
        """The state and input of a point, if the forms differ there outside the band."""
        x, u = self.comparison.point(w, step)
        values = self.comparison.values_at(x, u)
        return None if values is not None and self.comparison.is_in_band(values) else self.compare(x, u)

    def witness_beyond(self, w: Vector) -> Witness | None:
        """A point of a region outside the ranges, if it is one where the forms differ."""
        point = dict(zip(self.names, map(float, w), strict=True))
        x, u = ({v.name: point[v.name] for v in group} for group in (self.pwa.x, self.pwa.u))
        x = {**x, **clipped([v for v in self.pwa.x if v.is_bool], x)}
        u = {**u, **clipped([v for v in self.pwa.u if v.is_bool], u)}
        first = take_step(self.comparison.dha, x, u)
        return None if first.exists else self._beside_regions(first, x, u)

    def modes_at(self, w: Vector, step: Step) -> list[int]:
        """Modes whose region holds a point of a search."""
        x, u = self.comparison.point(w, step)
        holding, inside = self._holding(self._vector(x, u))
        return inside or holding

    def add_region(self, problem: Milp, step: Step, mode: Mode, depth: int | None = None) -> None:
        """The rows of a region, over the state and input of a step.

        Those over real coordinates are moved inwards by the variable `depth`, in proportion to the size of their terms.
        """
        ranges = self.comparison.ranges
        for a, b in zip(mode.region.A, mode.region.b, strict=True):
            terms = self.terms(a, step)
            sizes = [abs(c) * max(map(abs, ranges[name])) for name, c in zip(self.names, a, strict=True) if c]
            if depth is not None and not all(problem.integer[i] for i in terms):
                terms[depth] = 1.0 + sum(filter(isfinite, sizes)) + abs(float(b))
            problem.row(terms, high=float(b))

    def terms(self, a: Vector, step: Step) -> dict[int, float]:
        """A row of a region in the variables of a problem."""
        return {step.values[name]: float(c) for name, c in zip(self.names, a, strict=True) if c}


def fix_word(problem: Milp, step: Step, word: FullWord) -> None:
    """Give the Booleans of a problem the values of a word."""
    for name, value in word:
        place = step.values[name]
        problem.low[place] = problem.high[place] = float(value)


def exclude_words(problem: Milp, step: Step, words: Sequence[FullWord]) -> None:
    """Forbid each of some words, whatever the other Booleans are."""
    for word in words:
        terms = {step.values[name]: -1.0 if value else 1.0 for name, value in word}
        problem.row(terms, 1.0 - sum(value for _, value in word), inf)


def overlapping_pairs(modes: Sequence[Mode]) -> Iterator[tuple[Mode, Mode]]:
    """Pairs of modes that no Boolean tells apart."""
    names = list(dict.fromkeys(name for mode in modes for name, _ in mode.word))
    codes = {True: 1, False: -1, None: 0}
    table = np.array([[codes[mode.values.get(name)] for name in names] for mode in modes], dtype=int)
    for i, mode in enumerate(modes):
        for j in np.flatnonzero((table[i + 1 :] * table[i] >= 0).all(axis=1)):
            yield mode, modes[i + 1 + int(j)]
