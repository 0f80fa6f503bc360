"""The answers to the queries of a model, each with a run that contradicts it or a proof that there is none."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.hybrid_set import Span
from hysdel_py.analysis.safety import Question, Searcher
from hysdel_py.analysis.start_box import box_around
from hysdel_py.diagnostics.render import place
from hysdel_py.model import Model
from hysdel_py.reports.condition import condition_of_expression
from hysdel_py.reports.safety import avoidance, check_model, meeting
from hysdel_py.reports.safety_answer import SafetyAnswer, SafetyVerdict
from hysdel_py.semantics.expressions import Apply, Expression, is_constant
from hysdel_py.semantics.typed_model import Query
from hysdel_py.syntax.ast import QueryKind
from hysdel_py.syntax.operators import Op
from hysdel_py.systems.signals import Type

__all__ = ["QueryAnswer", "QueryVerdict", "answer_queries"]


class QueryVerdict(Enum):
    """What is known about a query."""

    HOLDS = "holds"
    VIOLATED = "violated"
    NO_RUN = "no run"
    NOT_SETTLED = "not settled"


_OF_ANSWER = {
    SafetyVerdict.UNREACHABLE: QueryVerdict.HOLDS,
    SafetyVerdict.INEVITABLE: QueryVerdict.HOLDS,
    SafetyVerdict.REACHABLE: QueryVerdict.VIOLATED,
    SafetyVerdict.AVOIDABLE: QueryVerdict.VIOLATED,
    SafetyVerdict.NO_RUN: QueryVerdict.NO_RUN,
    SafetyVerdict.NOT_SETTLED: QueryVerdict.NOT_SETTLED,
}


@dataclass(frozen=True, eq=False, slots=True)
class QueryAnswer:
    """What was found about a query.

    Attributes
    ----------
    query : Query
    answer : SafetyAnswer
        About the condition that contradicts the query, or that every run has to meet.
    """

    query: Query
    answer: SafetyAnswer

    @property
    def outcome(self) -> QueryVerdict:
        """What is known."""
        return _OF_ANSWER[self.answer.outcome]

    @property
    def verdict(self) -> str:
        """The outcome as a word: ``"holds"``, ``"violated"``, ``"no run"`` or ``"not settled"``."""
        return self.outcome.value

    def to_dict(self) -> dict[str, Any]:
        """Plain data, ready for JSON."""
        about = {"query": self.query.text, "line": self.query.line, "verdict": self.verdict}
        return about | {"answer": self.answer.to_dict()}

    def __str__(self) -> str:
        return "\n".join(self._lines()) + "\n"

    def _lines(self) -> Iterator[str]:
        yield f"{self.verdict}: {self.query.text}"
        yield from place(self.query.span, self.answer.model.typed.source)
        if self.query.kind is QueryKind.ALWAYS:
            yield f"  its contrary: {self.answer.target}"
        yield from (f"  {line}".rstrip() for line in str(self.answer).splitlines()[1:])


def answer_queries(
    model: Model,
    *,
    inputs: Mapping[str, Span] | None = None,
    seconds: float = 300.0,
    progress: Callable[[int, int], Any] | None = None,
) -> tuple[QueryAnswer, ...]:
    """Answer all queries of a model in file order.

    Parameters
    ----------
    model : Model
    inputs : mapping of name to value or (low, high), optional
        Inputs that are not named may have any value of their range, another one at each step.
    seconds : float
        Time limit of each query.
    progress : callable, optional
        ``progress(answered, queries)`` at each search and after each query; a true answer leaves the rest unsettled.

    Returns
    -------
    tuple of QueryAnswer
        Empty for a model without queries.

    Raises
    ------
    ArgumentError, SimulationError
        As :func:`hysdel_py.can_reach`.
    CompileError
        A parameter that a query needs has no value.

    Examples
    --------
    >>> from hysdel_py import load
    >>> model = load("/* extension: queries */"
    ...              " SYSTEM tank { INTERFACE { STATE { REAL level [0, 1]; } INPUT { REAL q [0, 0.2]; } }"
    ...              " IMPLEMENTATION { CONTINUOUS { level = 0.5*level + q; }"
    ...              " QUERIES { NEVER level >= 0.45 WITHIN 20 FROM level <= 0.1; ALWAYS level <= 0.3 WITHIN 9; } } }")
    >>> [answer.verdict for answer in answer_queries(model)]
    ['holds', 'violated']
    """
    check_model(model, seconds)
    queries = model.typed.queries
    found: list[QueryAnswer] = []

    def watch(_searches: int = 0) -> Any:
        return progress is not None and progress(len(found), len(queries))

    for query in queries:
        found.append(QueryAnswer(query, _answer(query, model, inputs or {}, Clock(seconds, watch))))
        watch()
    return tuple(found)


def _answer(query: Query, model: Model, inputs: Mapping[str, Span], clock: Clock) -> SafetyAnswer:
    target = condition_of_expression(_searched(query), model)
    start = None if query.start is None else condition_of_expression(query.start, model)
    box = {} if start is None else _within(box_around(start), model)
    question = Question(model.dha, box, start, inputs, target, query.steps, model.sample_time)
    searcher = Searcher(question, clock)
    return avoidance(model, searcher) if query.kind is QueryKind.EVENTUALLY else meeting(model, searcher)


def _searched(query: Query) -> Expression:
    """The condition that a run is searched for: ALWAYS is contradicted where its condition fails."""
    condition = query.condition
    if query.kind is not QueryKind.ALWAYS:
        return condition
    if isinstance(condition, Apply) and condition.op is Op.NOT:
        return condition.args[0]
    return Apply(Op.NOT, (condition,), Type.BOOL, is_constant(condition), condition.span)


def _within(box: Mapping[str, tuple[float, float]], model: Model) -> dict[str, Span]:
    """Intervals that have something in common with the ranges; the condition itself judges the others."""
    ranges = {v.name: (v.low, v.high) for v in model.dha.x}
    found: dict[str, Span] = {}
    for name, (low, high) in box.items():
        ends = max(low, ranges[name][0]), min(high, ranges[name][1])
        if ends[0] <= ends[1]:
            found[name] = ends
    return found
