"""What the questions about well-posedness share: searches that are confirmed by stepping, and findings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.comparison import Comparison
from hysdel_py.analysis.encoding import Step
from hysdel_py.analysis.milp import Milp
from hysdel_py.analysis.points import random_points
from hysdel_py.analysis.report_text import listed
from hysdel_py.analysis.search import Found, settle
from hysdel_py.analysis.stepping import Outcome, Values, clipped, take_step
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic, Label, Severity
from hysdel_py.syntax.source import Span
from hysdel_py.systems.origin import Origin

__all__ = ["ANY_POINT", "Deep", "Finding", "Hunt", "Point", "span_of"]

Vector = NDArray[np.float64]

ANY_POINT = -1.0
"""Threshold below the value 0 of an empty objective."""

SAMPLES = 120
"""So many steps are looked at before a search is made for what none of them shows."""


@dataclass(frozen=True, slots=True)
class Point:
    """A state and input, and the step of the Dha there."""

    x: Values
    u: Values
    outcome: Outcome

    def __str__(self) -> str:
        return listed((*self.x, *self.u))

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {"x": dict(self.x), "u": dict(self.u), **self.outcome.as_data()}


@dataclass(frozen=True, slots=True)
class Finding:
    """A diagnostic, and the point that shows it; None where it says that there is no such point."""

    diagnostic: Diagnostic
    point: Point | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Hunt:
    """A problem, and what a point of it has to exceed."""

    problem: Milp
    step: Step
    objective: Mapping[int, float]
    threshold: float


@dataclass(slots=True)
class Deep:
    """A comparison with places in the source, and the questions that stay open."""

    comparison: Comparison
    declared: Mapping[str, Span]
    unsettled: list[str] = field(default_factory=list)
    _samples: tuple[Point, ...] | None = None

    @property
    def samples(self) -> tuple[Point, ...]:
        """Steps at random points; only those that exist."""
        if self._samples is None:
            points = (self.point(values) for values in random_points(self.comparison, SAMPLES, seed=0))
            self._samples = tuple(point for point in points if point.outcome.exists)
        return self._samples

    def point(self, values: Mapping[str, float]) -> Point:
        """The step of the Dha at a state and input."""
        dha = self.comparison.dha
        x, u = clipped(dha.x, values), clipped(dha.u, values)
        return Point(tuple(x.items()), tuple(u.items()), take_step(dha, x, u))

    def search(
        self, ask: Callable[[bool], Hunt], confirms: Callable[[Point], bool], question: str
    ) -> tuple[bool, Point | None]:
        """Whether a point is ruled out, else one that was confirmed; what is neither is put on the list.

        `ask` gives the problem: away from thresholds where it is called with true, which comes first, else on them too.
        """
        for clear in (True, False):
            found, point = self._hunt(ask(clear), confirms)
            if point is not None:
                return False, point
        if found is not Found.NONE:
            self.unsettled.append(f"{question} ({found.value})")
        return found is Found.NONE, None

    def _hunt(self, hunt: Hunt, confirms: Callable[[Point], bool]) -> tuple[Found, Point | None]:
        dha, kept = self.comparison.dha, []

        def accept(w: Vector) -> bool:
            point = self.point({v.name: w[hunt.step.values[v.name]] for v in (*dha.x, *dha.u)})
            kept.extend([point] if confirms(point) else [])
            return bool(kept)

        found = settle(hunt.problem, hunt.objective, hunt.threshold, accept, self.comparison.clock).found
        return found, kept[0] if kept else None

    def finding(
        self,
        code: Code,
        message: str,
        span: Span | None,
        *,
        help: str = "",
        labels: tuple[Label, ...] = (),
        point: Point | None = None,
    ) -> Finding:
        """A warning."""
        return Finding(Diagnostic(code, Severity.WARNING, message, span, help, labels), point)


def span_of(origin: Origin) -> Span | None:
    """Where an item is, None if it has no place."""
    return Span(origin.start, origin.end) if origin.end else None
