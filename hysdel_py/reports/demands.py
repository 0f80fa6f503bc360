"""The hard limits of a controller as demands on a run, in words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import inf

from hysdel_py.analysis.horizon import Demand
from hysdel_py.control.bands import Band, ResolvedLimits
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.signals import Variable

__all__ = ["comparison", "demands_of"]

Terms = tuple[tuple[str, float], ...]


def demands_of(
    limits: ResolvedLimits, unmovable: Sequence[Band], steps: int, states: Sequence[Variable]
) -> tuple[Demand, ...]:
    """One demand per side of a hard limit; those in `unmovable` do not count at time 0, as in the controller."""
    bands = [band for band in limits.bands if limits.slack_of(band) is None]
    _check_groups(bands)
    found = [demand for band in bands for demand in _sides(band, band in unmovable, steps)]
    return (*found, *_polytope(limits, steps, states))


def _check_groups(bands: Sequence[Band]) -> None:
    """Refuse limits that are no demands on a signal at one time, rather than leave them out."""
    for band in bands:
        if band.group in ("du", "final"):
            what = "increments of an input" if band.group == "du" else "an output of the last state"
            raise ArgumentError(
                f"the controller limits {what} ({band.name}), which cannot be explained yet: leave that limit out to "
                "see whether the others contradict each other"
            )


def _sides(band: Band, unmovable: bool, steps: int) -> Iterator[Demand]:
    times = {
        "u": range(steps),
        "y": range(1 if unmovable else 0, steps),
        "x": range(1, steps + 1),
        "terminal": range(steps, steps + 1),
    }[band.group]
    vector = "x" if band.group == "terminal" else band.group
    terms = ((band.name, 1.0),)
    for low, at in _grouped((time, band.at(time)[0]) for time in times):
        if low > -inf:
            yield Demand(comparison(terms, low, inf), vector, terms, low, inf, at)
    for high, at in _grouped((time, band.at(time)[1]) for time in times):
        if high < inf:
            yield Demand(comparison(terms, -inf, high), vector, terms, -inf, high, at)


def _grouped(ends: Iterable[tuple[int, float]]) -> list[tuple[float, tuple[int, ...]]]:
    """Each end once, with the times at which it holds."""
    times: dict[float, list[int]] = {}
    for time, end in ends:
        times.setdefault(end, []).append(time)
    return [(end, tuple(at)) for end, at in times.items()]


def _polytope(limits: ResolvedLimits, steps: int, states: Sequence[Variable]) -> Iterator[Demand]:
    if limits.polytope is None or limits.polytope_slack is not None:
        return
    for row, bound in zip(limits.polytope.S, limits.polytope.T, strict=True):
        if bound < inf:
            terms = tuple((v.name, float(c)) for v, c in zip(states, row, strict=True) if c)
            yield Demand(comparison(terms, -inf, float(bound)), "x", terms, -inf, float(bound), (steps,))


def comparison(terms: Terms, low: float, high: float) -> str:
    """``terms >= low`` or ``terms <= high``, whichever is finite, without a leading minus where that can be."""
    if all(coefficient <= 0 for _, coefficient in terms):
        terms, low, high = (-Affine(0.0, terms)).terms, -high, -low
    sign, end = (">=", low) if low > -inf else ("<=", high)
    return f"{Affine(0.0, terms)} {sign} {end + 0.0:.6g}"
