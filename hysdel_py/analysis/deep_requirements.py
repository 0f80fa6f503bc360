"""MUST that forbids everything, and MUST that restricts nothing."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from hysdel_py.analysis.comparison import Comparison, add_form, is_requirement
from hysdel_py.analysis.deep import ANY_POINT, Deep, Finding, Hunt, Point, span_of
from hysdel_py.analysis.encoding import UPDATES_AND_OUTPUTS, encode_step, nothing, shared_variables
from hysdel_py.analysis.milp import Milp, Source, Status
from hysdel_py.analysis.tseitin import formula_variable
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.systems.dha import AffineRequirement, DhaItem, LogicRequirement

__all__ = ["contradiction", "implied_requirements"]

Requirement = AffineRequirement | LogicRequirement


# ---- everything is forbidden --------------------------------------------------------------------------------------


def contradiction(deep: Deep) -> Iterator[Finding]:
    """Items that no state and input within the ranges satisfies together; dropping any of them leaves some."""
    comparison = deep.comparison
    if deep.samples or not comparison.dha.requirements:
        return
    problem, _ = comparison.whole(clear=False)
    status = problem.search(seconds=comparison.clock.allowance()).status
    if status is Status.UNKNOWN:
        deep.unsettled.append("whether MUST allows anything (unsettled)")
    if status is not Status.NONE:
        return
    items = _irreducible(comparison)
    requirements = [item for item in items if is_requirement(item)] or items
    others = [item for item in items if item is not requirements[0]]
    spans = [(span, item) for item in others if (span := span_of(item.origin)) is not None]
    yield deep.finding(
        Code.NOTHING_ALLOWED,
        "MUST leaves no state and input within the declared ranges"
        + (f": {len(items)} items contradict each other" if len(items) > 1 else ""),
        span_of(requirements[0].origin) if requirements else None,
        help="drop or weaken one of them, or widen a range",
        labels=tuple(Label(span, "and this") for span, _ in spans),
    )


def _irreducible(comparison: Comparison) -> list[DhaItem]:
    """Items that still contradict each other and of which none can be left out, definitions tried first."""
    kept = [item for item in comparison.dha.items if getattr(item, "item", "") not in UPDATES_AND_OUTPUTS]
    for item in sorted(kept, key=is_requirement):
        trial = [other for other in kept if other is not item]
        if _contradict(comparison, trial):
            kept = trial
    return kept


def _contradict(comparison: Comparison, items: list[DhaItem]) -> bool:
    problem = Milp()
    given = shared_variables(problem, (*comparison.dha.x, *comparison.dha.u))
    chosen = set(map(id, items))
    encode_step(problem, comparison.dha, given, band=comparison.band, leave_out=lambda item: id(item) not in chosen)
    return problem.search(seconds=comparison.clock.allowance()).status is Status.NONE


# ---- nothing is restricted ----------------------------------------------------------------------------------------


def implied_requirements(deep: Deep) -> Iterator[Finding]:
    """Requirements that hold wherever all the others do; those that ranges alone imply are noted by the compiler."""
    for requirement in deep.comparison.dha.requirements:
        if _is_noted(deep, requirement):
            continue
        is_implied, _ = deep.search(
            partial(_violated, deep.comparison, requirement),
            _is_refused,
            f"whether MUST in {requirement.origin} restricts anything",
        )
        if is_implied:
            yield deep.finding(
                Code.MUST_IMPLIED,
                "this restricts nothing: the other items and the ranges imply it",
                span_of(requirement.origin),
                help="drop it, or check that it says what is meant",
            )


def _is_noted(deep: Deep, requirement: Requirement) -> bool:
    if isinstance(requirement, LogicRequirement):
        return not requirement.value.names
    return requirement.value.range(deep.comparison.ranges.__getitem__)[1] <= 0.0


def _violated(comparison: Comparison, requirement: Requirement, clear: bool) -> Hunt:
    """Steps in which all but one requirement hold."""
    problem = Milp()
    given = shared_variables(problem, (*comparison.dha.x, *comparison.dha.u))
    step = encode_step(
        problem,
        comparison.dha,
        given,
        band=comparison.band,
        below=comparison.below if clear else nothing,
        leave_out=lambda item: item is requirement,
    )
    if isinstance(requirement, LogicRequirement):
        problem.fix(formula_variable(problem, requirement.value, step.values, Source(requirement.origin)), 0.0)
        return Hunt(problem, step, {}, ANY_POINT)
    objective: dict[int, float] = {}
    add_form(objective, requirement.value, step.values)
    level = comparison.margins.violation(requirement.value, comparison.ranges)
    return Hunt(problem, step, objective, level - requirement.value.constant)


def _is_refused(point: Point) -> bool:
    return not point.outcome.exists
