"""Whether a model says what it seems to say: gaps, several solutions, dead events and branches, MUST, ranges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any

from hysdel_py.analysis.clock import Clock, Watch
from hysdel_py.analysis.comparison import Comparison
from hysdel_py.analysis.deep import Deep, Finding
from hysdel_py.analysis.deep_behaviour import constant_events, dead_branches, left_ranges
from hysdel_py.analysis.deep_requirements import contradiction, implied_requirements
from hysdel_py.analysis.deep_steps import gaps, several_solutions
from hysdel_py.analysis.margins import Margins
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic
from hysdel_py.errors import ArgumentError
from hysdel_py.syntax.source import Span
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.mld import Mld

if TYPE_CHECKING:
    from typing import Protocol

    class Symbol(Protocol):
        """A declared name."""

        @property
        def name(self) -> str:
            """As written."""

        @property
        def span(self) -> Span:
            """Where."""

        @property
        def line(self) -> int:
            """Of the declaration."""

    class Typed(Protocol):
        """A typed model."""

        @property
        def symbols(self) -> tuple[Symbol, ...]:
            """All declared names."""

    class Loaded(Protocol):
        """A model with its forms and its source."""

        @property
        def dha(self) -> Dha:
            """The automaton."""

        @property
        def mld(self) -> Mld:
            """The rows."""

        @property
        def typed(self) -> Any:
            """The typed model."""


__all__ = ["WellPosedness", "well_posed"]


@dataclass(frozen=True, slots=True)
class WellPosedness:
    """What a search over all states and inputs within the ranges shows about a model.

    Attributes
    ----------
    name : str
    findings : tuple of Finding
        Each with a diagnostic, and with a confirmed state and input unless it says that there is none.
    unsettled : tuple of str
        Questions that the limits left open.
    band, tolerance : float
        See :class:`hysdel_py.Margins`.
    """

    name: str
    findings: tuple[Finding, ...]
    unsettled: tuple[str, ...]
    band: float
    tolerance: float

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """The findings as diagnostics, in the order of the source."""
        found = dict.fromkeys(finding.diagnostic for finding in self.findings)
        return tuple(sorted(found, key=lambda d: d.span.start if d.span else -1))

    def beside(self, others: tuple[Diagnostic, ...]) -> tuple[Diagnostic, ...]:
        """These diagnostics behind those of the compiler, without what both say of an item."""
        found = self.diagnostics
        places = {d.span for d in found}
        return (*(d for d in others if d.code is not Code.DEAD_BRANCH or d.span not in places), *found)

    @property
    def is_sound(self) -> bool:
        """Whether every question was settled and nothing was found."""
        return not self.findings and not self.unsettled


def well_posed(
    model: Loaded, *, margins: Margins | None = None, seconds: float = inf, progress: Watch | None = None
) -> WellPosedness:
    """Search all states and inputs within the ranges for what is probably not meant.

    Gaps, where the Dha has a step and the Mld none (the declared range of an auxiliary or a stated [min, max] is too
    narrow); several values of an auxiliary that fit (algebraic loops); events that are never true or never false;
    branches of IF that are never taken; MUST that forbids everything, with items that contradict each other; MUST that
    the rest implies; states that leave their range in one step.

    Parameters
    ----------
    model : Model
    margins : Margins, optional
        Band around thresholds and tolerance of the statements.
    seconds : float
        Time limit; what is not settled then is said to be.
    progress : callable, optional
        Told the number of searches begun; a true answer ends the work as if its time were over.

    Raises
    ------
    ArgumentError
        A variable that the search needs has no finite range.
    """
    if not seconds > 0:
        raise ArgumentError(f"seconds is {seconds:g}: a time above 0 was expected")
    chosen = Margins() if margins is None else margins
    declared = {symbol.name: symbol.span for symbol in model.typed.symbols if symbol.line}
    deep = Deep(Comparison(model.dha, model.mld, chosen, Clock(seconds, progress)), declared)
    findings = tuple(_findings(deep))
    return WellPosedness(model.dha.name, findings, tuple(deep.unsettled), chosen.band, chosen.tolerance)


def _findings(deep: Deep) -> Iterator[Finding]:
    contradicting = tuple(contradiction(deep))
    if contradicting:  # every other question would be answered by it
        yield from contradicting
        return
    yield from gaps(deep)
    yield from several_solutions(deep)
    yield from constant_events(deep)
    yield from dead_branches(deep)
    yield from implied_requirements(deep)
    yield from left_ranges(deep)
