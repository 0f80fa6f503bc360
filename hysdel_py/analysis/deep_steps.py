"""Steps that the rows forbid, and steps that are not the only ones."""

from __future__ import annotations

from collections.abc import Iterator

from hysdel_py.analysis.deep import ANY_POINT, Deep, Finding, Hunt, Point, span_of
from hysdel_py.analysis.encoding import encode_step
from hysdel_py.analysis.questions import forbidden_checks, value_checks
from hysdel_py.analysis.report import Check, CheckStatus
from hysdel_py.analysis.stepping import Witness
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.systems.dha import read_by
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Variable

__all__ = ["gaps", "several_solutions"]


def gaps(deep: Deep) -> Iterator[Finding]:
    """Steps of the Dha that the rows forbid, one finding for each item."""
    blamed: set[int] = set()
    for check in forbidden_checks(deep.comparison):
        origin = check.origins[0]
        if check.status is CheckStatus.HOLDS or not isinstance(origin, RowOrigin) or origin.group in blamed:
            continue
        if check.witness is None:
            deep.unsettled.append(f"whether {check.subject} forbids a step ({check.status.value})")
            continue
        blamed.add(origin.group)
        yield _gap(deep, origin, check.witness)


def _gap(deep: Deep, row: RowOrigin, witness: Witness) -> Finding:
    items = [item for item in deep.comparison.dha.items if item.origin.group == row.group]
    labels = tuple(_narrow_ranges(deep, row.group))
    point = Point(witness.x, witness.u, witness.first)
    return deep.finding(
        Code.STEP_FORBIDDEN,
        f"the model has a step that the rows of this item forbid, at {point}",
        span_of(items[0].origin) if items else None,
        help="widen the range, or leave it out: it is computed then" if labels else "widen the stated [min, max]",
        labels=labels,
        point=point,
    )


def _narrow_ranges(deep: Deep, group: int) -> Iterator[Label]:
    """Auxiliaries of an item whose declared range does not hold all values of the definition."""
    comparison = deep.comparison
    items = [item for item in comparison.dha.items if item.origin.group == group]
    names = dict.fromkeys(name for item in items for name in (*read_by(item), getattr(item, "name", "")))
    for variable in comparison.dha.z:
        low, high = comparison.ranges[variable.name]
        if variable.name in names and (variable.low > low or variable.high < high) and variable.name in deep.declared:
            text = f"{variable.name} can be anywhere in [{low:g}, {high:g}], by its definition"
            yield Label(deep.declared[variable.name], text)


def several_solutions(deep: Deep) -> Iterator[Finding]:
    """Auxiliaries of which several values fit."""
    if deep.comparison.dha.algebraic_loop:
        yield from _loop_solutions(deep)
        return
    for check in value_checks(deep.comparison):
        if check.witness is not None:
            yield _several(deep, check)
        elif check.status is not CheckStatus.HOLDS:
            deep.unsettled.append(f"whether {check.subject} has one value ({check.status.value})")


def _several(deep: Deep, check: Check) -> Finding:
    assert check.witness is not None
    definition = deep.comparison.dha.definitions.get(check.subject)
    point = Point(check.witness.x, check.witness.u, check.witness.first)
    return deep.finding(
        Code.NOT_UNIQUE,
        f"the rows allow several values of {check.subject}, at {point}",
        None if definition is None else span_of(definition.origin),
        point=point,
    )


def _loop_solutions(deep: Deep) -> Iterator[Finding]:
    """Two solutions of an algebraic loop at the same state and input."""
    comparison = deep.comparison
    loop = set(comparison.dha.algebraic_loop)
    for variable in comparison.auxiliaries:
        if variable.name not in loop:
            continue
        point = _second_solution(deep, variable)
        if point is not None:
            definition = comparison.dha.definitions[variable.name]
            yield deep.finding(
                Code.NOT_UNIQUE,
                f"the loop through {' -> '.join(comparison.dha.algebraic_loop)} has several solutions, at {point}",
                span_of(definition.origin),
                help="break the loop by a state",
                point=point,
            )
            return


def _second_solution(deep: Deep, variable: Variable) -> Point | None:
    comparison = deep.comparison

    def ask(clear: bool) -> Hunt:
        problem, step = comparison.whole(clear=clear)
        given = {v.name: step.values[v.name] for v in (*comparison.dha.x, *comparison.dha.u)}
        other = encode_step(problem, comparison.dha, given, band=comparison.band)
        own, another = step.values[variable.name], other.values[variable.name]
        if variable.is_bool:
            problem.row({own: 1.0, another: 1.0}, 1.0, 1.0)
            return Hunt(problem, step, {}, ANY_POINT)
        distance = comparison.margins.apart(variable.name, comparison.ranges)
        return Hunt(problem, step, {own: 1.0, another: -1.0}, distance)

    return deep.search(ask, _is_ambiguous, f"whether {variable.name} has one value")[1]


def _is_ambiguous(point: Point) -> bool:
    return any("several solutions" in problem for problem in point.outcome.problems)
