"""Random states and inputs, some on thresholds and beside them, at which two forms are stepped."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import isfinite

import numpy as np

from hysdel_py.analysis.comparison import Comparison
from hysdel_py.analysis.report import PointTally
from hysdel_py.analysis.stepping import Witness
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import Event
from hysdel_py.systems.signals import Variable

__all__ = ["Compare", "random_points", "step_points"]

Point = dict[str, float]
Compare = Callable[[Point, Point], Witness | None]

WITHOUT_RANGE = 1e3
"""An endless range is sampled that far."""

_BESIDE = 2.0  # points beside a threshold are that many bands away from it


def random_points(comparison: Comparison, count: int, seed: int) -> Iterator[Point]:
    """Values of states and inputs: anywhere, at the ends of ranges, and in turn on, above and below each threshold."""
    generator = np.random.default_rng(seed)
    variables = (*comparison.dha.x, *comparison.dha.u)
    events = [item for item in comparison.dha.items if isinstance(item, Event)]
    for number in range(count):
        point = {v.name: _sample(v, generator) for v in variables}
        if events and number % 2:
            event = events[(number // 2) % len(events)]
            offset = _BESIDE * comparison.band(event) * (0.0, 1.0, -1.0)[(number // 2 // len(events)) % 3]
            _move_to(point, event, offset, generator, comparison)
        yield point


def _sample(variable: Variable, generator: np.random.Generator) -> float:
    if variable.is_bool:
        return float(generator.integers(2))
    low = variable.low if isfinite(variable.low) else -WITHOUT_RANGE
    high = variable.high if isfinite(variable.high) else WITHOUT_RANGE
    if generator.integers(8) == 0:
        return low if generator.integers(2) else high
    return float(generator.uniform(low, high))


def _move_to(point: Point, event: Event, offset: float, generator: np.random.Generator, comparison: Comparison) -> None:
    """Move one real variable of the form so that the form has a value, as far as its range allows."""
    terms = dict(event.form.terms)
    movable = [v for v in (*comparison.dha.x, *comparison.dha.u) if not v.is_bool and terms.get(v.name)]
    values = comparison.values_at(*_parted(comparison, point))
    if not movable or values is None:
        return
    v = movable[int(generator.integers(len(movable)))]
    wanted = point[v.name] + (offset - event.form.value(values)) / terms[v.name]
    point[v.name] = min(max(wanted, v.low), v.high)


def _parted(comparison: Comparison, point: Point) -> tuple[Point, Point]:
    x, u = ({v.name: point[v.name] for v in group} for group in (comparison.dha.x, comparison.dha.u))
    return x, u


def step_points(comparison: Comparison, count: int, seed: int, compare: Sequence[Compare] | None = None) -> PointTally:
    """Step all forms at random points; those in the band around a threshold decide nothing.

    Parameters
    ----------
    comparison : Comparison
    count, seed : int
    compare : sequence of callable, optional
        Each steps the Dha and one form at a state and input, and gives the witness if they differ; by default that of
        the comparison.
    """
    equal = infeasible = in_band = 0
    different: list[Witness] = []
    dha = comparison.dha
    for point in random_points(comparison, count, seed):
        if not comparison.clock.left:
            break
        x, u = _parted(comparison, point)
        values = comparison.values_at(x, u)
        if values is not None and _is_near(comparison, values):
            in_band += 1
            continue
        witnesses = [w for w in (ask(x, u) for ask in compare or (comparison.compare,)) if w is not None]
        if witnesses:
            different.append(witnesses[0])
        elif values is not None and all(_excess(comparison, item.value, values) <= 0.0 for item in dha.requirements):
            equal += 1
        else:
            infeasible += 1
    return PointTally(equal, infeasible, in_band, tuple(different))


def _excess(comparison: Comparison, value: object, values: Mapping[str, float]) -> float:
    """By how much a requirement is violated."""
    if isinstance(value, Affine):
        return value.value(values) - comparison.dha.tolerances.row
    return 0.0 if value.value(values) else 1.0  # type: ignore[attr-defined]


def _is_near(comparison: Comparison, values: Mapping[str, float]) -> bool:
    """Whether a form lies in the gap of its threshold, or a comparison in MUST is violated by next to nothing."""
    return comparison.is_in_band(values) or any(
        0.0 < requirement.value.value(values) < comparison.margins.violation(requirement.value, comparison.ranges)
        for requirement in comparison.dha.requirements
        if isinstance(requirement.value, Affine)
    )
