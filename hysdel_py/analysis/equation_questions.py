"""Are the updates and outputs of a Dha those of the matrices of an Mld?"""

from __future__ import annotations

from collections.abc import Iterator

from hysdel_py.analysis.comparison import Comparison
from hysdel_py.analysis.encoding import add_terms
from hysdel_py.analysis.questions import STATUS, Answered, Confirmed, objective_of, on_thresholds_last, worst
from hysdel_py.analysis.report import Check, CheckStatus, Question
from hysdel_py.analysis.stepping import Witness
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, LogicEquation
from hysdel_py.systems.formula import Formula
from hysdel_py.systems.origin import Origin, RowOrigin
from hysdel_py.systems.signals import Variable

__all__ = ["equation_checks"]


def equation_checks(comparison: Comparison) -> Iterator[Check]:
    """For each state and output: is its right side that of the matrices?"""
    groups = (
        (comparison.dha.x, comparison.updates, comparison.mld.updates, "'"),
        (comparison.dha.y, comparison.outputs, comparison.mld.outputs, ""),
    )
    for variables, forms, origins, mark in groups:
        by_name = {origin.defines: origin for origin in origins}
        for variable in variables:
            status, how, witness = _equation(comparison, variable, forms[variable.name], is_state=bool(mark))
            definition = comparison.dha.definitions.get(variable.name)
            origin: Origin | RowOrigin | None = definition.origin if definition else by_name.get(variable.name)
            lines = () if origin is None else (origin,)
            yield Check(Question.EQUATION, variable.name + mark, status, how, (), lines, witness)


def _equation(
    comparison: Comparison, variable: Variable, form: Affine, *, is_state: bool
) -> tuple[CheckStatus, str, Witness | None]:
    tolerance = comparison.margins.distance(form, comparison.ranges)
    expected = _right_side(comparison, variable.name)
    if expected is not None:
        low, high = _without_noise(expected - form).range(comparison.ranges.__getitem__)
        if max(abs(low), abs(high)) <= tolerance:
            return CheckStatus.HOLDS, "coefficients", None
    status, witness = on_thresholds_last(
        lambda clear: _equation_in_model(comparison, variable, form, is_state=is_state, clear=clear)
    )
    return status, "model", witness


def _equation_in_model(
    comparison: Comparison, variable: Variable, form: Affine, *, is_state: bool, clear: bool
) -> Answered:
    tolerance = comparison.margins.distance(form, comparison.ranges)
    problem, step = comparison.whole(clear=clear)
    own = (step.next if is_state else step.outputs)[variable.name]
    statuses = []
    for sign in (1.0, -1.0):
        objective = objective_of(form, step.values, -sign)
        add_terms(objective, own, sign)
        confirmed = Confirmed(comparison, step, comparison.clock)
        statuses.append(STATUS[confirmed.search(problem, objective, tolerance + sign * form.constant).found])
        if statuses[-1] is CheckStatus.DIFFERENT:
            return CheckStatus.DIFFERENT, confirmed.witness
    return worst(statuses), None


def _right_side(comparison: Comparison, name: str) -> Affine | None:
    """Right side of an update or output as an affine form; None if it is a longer formula."""
    match comparison.dha.definitions.get(name):
        case None:
            return Affine()
        case AffineEquation(value=value):
            return value
        case LogicEquation(value=formula):
            return _literal_form(formula)
        case _:
            return None


def _literal_form(formula: Formula) -> Affine | None:
    literal = formula.literal
    if literal is not None:
        return Affine(float(not literal.positive), ((literal.name, 1.0 if literal.positive else -1.0),))
    return Affine(float(formula.postfix[0])) if formula.postfix in ((True,), (False,)) else None


def _without_noise(form: Affine) -> Affine:
    """Without coefficients that are exactly zero, whose variables may be endless."""
    return Affine(form.constant, tuple((name, c) for name, c in form.terms if c))
