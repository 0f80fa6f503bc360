"""The hard limits of a controller as demands on a run, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf

from hysdel_py.analysis.horizon import Demand
from hysdel_py.control.limits import Band, ResolvedLimits
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.signals import Variable

__all__ = ["comparison", "demands_of"]

Terms = tuple[tuple[str, float], ...]


def demands_of(
    limits: ResolvedLimits, unmovable: Sequence[Band], steps: int, states: Sequence[Variable]
) -> tuple[Demand, ...]:
    """One demand per side of a hard limit; those in `unmovable` do not count at time 0, as in the controller."""
    bands = (band for band in limits.bands if limits.slack_of(band) is None)
    found = [demand for band in bands for demand in _sides(band, band in unmovable, steps)]
    return (*found, *_polytope(limits, steps, states))


def _sides(band: Band, unmovable: bool, steps: int) -> Iterator[Demand]:
    times = {
        "u": range(steps),
        "y": range(1 if unmovable else 0, steps),
        "x": range(1, steps + 1),
        "terminal": range(steps, steps + 1),
    }[band.group]
    vector = "x" if band.group == "terminal" else band.group
    terms = ((band.name, 1.0),)
    if band.low > -inf:
        yield Demand(comparison(terms, band.low, inf), vector, terms, band.low, inf, tuple(times))
    if band.high < inf:
        yield Demand(comparison(terms, -inf, band.high), vector, terms, -inf, band.high, tuple(times))


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
