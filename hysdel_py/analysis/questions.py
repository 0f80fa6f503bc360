"""The four families of questions about a Dha and an Mld, each a tuple of checks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.comparison import Comparison, add_form
from hysdel_py.analysis.encoding import Step
from hysdel_py.analysis.milp import Milp, Source
from hysdel_py.analysis.report import Check, CheckStatus, Question
from hysdel_py.analysis.search import Found, Result, settle
from hysdel_py.analysis.stepping import Witness
from hysdel_py.analysis.tseitin import formula_variable
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineRequirement, DhaItem, LogicRequirement, read_by
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Variable

__all__ = [
    "ANY_POINT", "STATUS", "Answered", "Confirmed", "Confirms", "allowed_checks", "forbidden_checks", "objective_of",
    "on_thresholds_last", "value_checks", "violate", "worst",
]  # fmt: skip

Terms = dict[int, float]
Vector = NDArray[np.float64]
Answered = tuple[CheckStatus, Witness | None]
ANY_POINT = -1.0
"""Threshold below the value 0 of an empty objective."""

STATUS = {
    Found.NONE: CheckStatus.HOLDS,
    Found.POINT: CheckStatus.DIFFERENT,
    Found.DOUBTFUL: CheckStatus.DOUBTFUL,
    Found.UNSETTLED: CheckStatus.NOT_SETTLED,
}


def _any_point(w: Vector) -> bool:  # noqa: ARG001
    return True


def _is_ruled_out(comparison: Comparison, problem: Milp, objective: Terms, threshold: float) -> bool:
    """Whether a part of the model has no point above a threshold."""
    return settle(problem, objective, threshold, _any_point, comparison.clock).found is Found.NONE


class Confirms(Protocol):
    """Two forms side by side."""

    def witness(self, w: Vector, step: Step) -> Witness | None:
        """The state and input of a point, if the forms differ there."""


class Confirmed:
    """Confirms the points of a search by stepping, and keeps the witness.

    `pair` is what steps the Dha and the other form: a :class:`Comparison` or a PwaPair.
    """

    def __init__(self, pair: Confirms, step: Step, clock: Clock) -> None:
        self._pair, self._step, self._clock = pair, step, clock
        self.witness: Witness | None = None

    def search(self, problem: Milp, objective: Terms, threshold: float) -> Result:
        """Search the whole model."""
        return settle(problem, objective, threshold, self._accept, self._clock)

    def _accept(self, w: Vector) -> bool:
        self.witness = self._pair.witness(w, self._step)
        return self.witness is not None


def on_thresholds_last(ask: Callable[[bool], Answered]) -> Answered:
    """Ask for points away from thresholds first, whose steps rounding cannot change, and then for those on them."""
    status, witness = ask(True)
    return (status, witness) if status is not CheckStatus.HOLDS else ask(False)


# ---- steps that the rows forbid -----------------------------------------------------------------------------------


def forbidden_checks(comparison: Comparison) -> Iterator[Check]:
    """For each row: can the values of a step of the Dha violate it?"""
    for index, form in enumerate(comparison.rows):
        origin = comparison.mld.rows[index]
        status, how, witness = _forbidden(comparison, form)
        yield Check(Question.FORBIDDEN, _row_name(index, origin), status, how, (index,), (origin,), witness)


def _row_name(index: int, origin: RowOrigin) -> str:
    return f"row {index}" + (f" ({origin})" if str(origin) else "")


def _forbidden(comparison: Comparison, form: Affine) -> tuple[CheckStatus, str, Witness | None]:
    threshold = comparison.margins.violation(form, comparison.ranges)
    if form.range(comparison.ranges.__getitem__)[1] <= threshold:
        return CheckStatus.HOLDS, "interval", None
    level = threshold - form.constant
    names = [name for name, _ in form.terms]
    problem, values = comparison.part(names, _concerned(comparison, names))
    if _is_ruled_out(comparison, problem, objective_of(form, values), level):
        return CheckStatus.HOLDS, "item", None
    status, witness = on_thresholds_last(lambda clear: _forbidden_in_model(comparison, form, level, clear=clear))
    return status, "model", witness


def _forbidden_in_model(comparison: Comparison, form: Affine, level: float, *, clear: bool) -> Answered:
    problem, step = comparison.whole(clear=clear)
    confirmed = Confirmed(comparison, step, comparison.clock)
    result = confirmed.search(problem, objective_of(form, step.values), level)
    return STATUS[result.found], confirmed.witness


def _concerned(comparison: Comparison, names: list[str]) -> list[DhaItem]:
    """Definitions of the auxiliaries of a row, and the requirements over its variables."""
    own = set(names)
    shared = [item for item in comparison.dha.requirements if own & set(read_by(item)) or not read_by(item)]
    return [*comparison.definitions(names), *shared]


def objective_of(form: Affine, places: Mapping[str, int], factor: float = 1.0) -> Terms:
    """The terms of a form as an objective."""
    terms: Terms = {}
    add_form(terms, form, places, factor)
    return terms


# ---- other values that the rows allow -----------------------------------------------------------------------------


def value_checks(comparison: Comparison) -> Iterator[Check]:
    """For each auxiliary: do the rows of the Mld leave the value of the Dha alone?"""
    for variable in comparison.auxiliaries:
        rows = comparison.rows_of[variable.name]
        status, how, witness = _another_value(comparison, variable)
        definition = comparison.dha.definitions.get(variable.name)
        origins = (definition.origin,) if definition is not None else ()
        yield Check(Question.ANOTHER_VALUE, variable.name, status, how, rows, origins, witness)


def _another_value(comparison: Comparison, variable: Variable) -> tuple[CheckStatus, str, Witness | None]:
    if variable.name not in comparison.dha.definitions and variable.name in comparison.idle:
        return CheckStatus.HOLDS, "item", None  # both forms give it the value 0
    if _follows_from_own_rows(comparison, variable):
        return CheckStatus.HOLDS, "item", None
    status, witness = on_thresholds_last(lambda clear: _another_in_model(comparison, variable, clear=clear))
    return status, "model", witness


def _follows_from_own_rows(comparison: Comparison, variable: Variable) -> bool:
    """Whether the rows over this and earlier auxiliaries leave no other value."""
    name = variable.name
    if name not in comparison.position or name not in comparison.dha.definitions:
        return False
    later = {n for n, place in comparison.position.items() if place > comparison.position[name]}
    forms = [f for f in (comparison.rows[i] for i in comparison.rows_of[name]) if not later & {n for n, _ in f.terms}]
    names = [n for form in forms for n, _ in form.terms]
    problem, values = comparison.part([name, *names], comparison.definitions([name]))
    other = comparison.another(problem, variable)
    for form in forms:
        problem.row(objective_of(form, values | {name: other}), high=-form.constant)
    searches = _differences(comparison, problem, variable, values[name], other)
    return all(_is_ruled_out(comparison, *search) for search in searches)


def _differences(
    comparison: Comparison, problem: Milp, variable: Variable, own: int, other: int
) -> list[tuple[Milp, Terms, float]]:
    """Searches for two values of one auxiliary that differ."""
    if variable.is_bool:
        apart = problem.copy()
        apart.row({own: 1.0, other: 1.0}, 1.0, 1.0)
        return [(apart, {}, ANY_POINT)]
    distance = comparison.margins.apart(variable.name, comparison.ranges)
    return [(problem, {other: sign, own: -sign}, distance) for sign in (1.0, -1.0)]


def _another_in_model(comparison: Comparison, variable: Variable, *, clear: bool) -> Answered:
    problem, step = comparison.whole(clear=clear)
    places = comparison.add_mld(problem, step)
    own, other = step.values[variable.name], places[variable.name]
    statuses = []
    for search in _differences(comparison, problem, variable, own, other):
        confirmed = Confirmed(comparison, step, comparison.clock)
        statuses.append(STATUS[confirmed.search(*search).found])
        if statuses[-1] is CheckStatus.DIFFERENT:
            return CheckStatus.DIFFERENT, confirmed.witness
    return worst(statuses), None


def worst(statuses: list[CheckStatus]) -> CheckStatus:
    """The status of a check that took several searches."""
    order = (CheckStatus.DIFFERENT, CheckStatus.NOT_SETTLED, CheckStatus.DOUBTFUL)
    return next((status for status in order if status in statuses), CheckStatus.HOLDS)


# ---- steps where MUST is violated ---------------------------------------------------------------------------------


def allowed_checks(comparison: Comparison, *, unique: bool) -> Iterator[Check]:
    """For each requirement: has the Mld a step where it is violated?

    `unique` says that the rows leave the values of the Dha alone wherever they leave any, requirements or not.
    """
    for requirement in comparison.dha.requirements:
        rows = _rows_within(comparison, read_by(requirement))
        if unique and _is_ruled_out(comparison, *_violated_part(comparison, requirement, rows)):
            status, how, witness = CheckStatus.HOLDS, "item", None
        else:
            status, witness = _allowed(comparison, requirement)
            how = "model"
        yield Check(
            Question.ALLOWED, f"MUST in {requirement.origin}", status, how, rows, (requirement.origin,), witness
        )


def _rows_within(comparison: Comparison, names: tuple[str, ...]) -> tuple[int, ...]:
    """Rows over some variables alone."""
    own = set(names)
    return tuple(i for i, form in enumerate(comparison.rows) if own >= {name for name, _ in form.terms})


def _violated_part(
    comparison: Comparison, requirement: AffineRequirement | LogicRequirement, rows: tuple[int, ...]
) -> tuple[Milp, Terms, float]:
    problem, values = comparison.part(read_by(requirement), ())
    for index in rows:
        form = comparison.rows[index]
        problem.row(objective_of(form, values), high=-form.constant)
    return (problem, *violate(comparison, problem, requirement, values))


def violate(
    comparison: Comparison,
    problem: Milp,
    requirement: AffineRequirement | LogicRequirement,
    values: Mapping[str, int],
) -> tuple[Terms, float]:
    """Objective and threshold of the violation; a formula is made false by a row."""
    if isinstance(requirement, LogicRequirement):
        problem.fix(formula_variable(problem, requirement.value, values, Source(requirement.origin)), 0.0)
        return {}, ANY_POINT
    form = requirement.value
    return objective_of(form, values), comparison.margins.violation(form, comparison.ranges) - form.constant


def _allowed(comparison: Comparison, requirement: AffineRequirement | LogicRequirement) -> Answered:
    return on_thresholds_last(lambda clear: _allowed_in_model(comparison, requirement, clear=clear))


def _allowed_in_model(
    comparison: Comparison, requirement: AffineRequirement | LogicRequirement, *, clear: bool
) -> Answered:
    problem, step = comparison.whole(must=False, clear=clear)
    comparison.add_mld(problem, step)
    objective, threshold = violate(comparison, problem, requirement, step.values)
    confirmed = Confirmed(comparison, step, comparison.clock)
    return STATUS[confirmed.search(problem, objective, threshold).found], confirmed.witness
