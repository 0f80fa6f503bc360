"""Rows of the items of a Dha, in the order of the original compiler."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.big_m import EventConstants, Rule, SwitchConstants
from hysdel_py.lowering.cnf import MAX_CLAUSES, TooManyClauses, cnf
from hysdel_py.syntax.source import Span
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import (
    AffineEquation,
    AffineRequirement,
    DhaItem,
    Event,
    LogicEquation,
    LogicRequirement,
    Switch,
)
from hysdel_py.systems.formula import Connective, Formula
from hysdel_py.systems.origin import Origin, RowOrigin

__all__ = ["Row", "item_rows"]


@dataclass(frozen=True, slots=True)
class Row:
    """``form <= 0`` and where it comes from."""

    form: Affine
    origin: RowOrigin


def item_rows(item: DhaItem, rule: Rule, sink: Sink) -> Iterator[Row]:
    """Rows of one item in the order of the original compiler; none for an update or output."""
    match item:
        case Event():
            forms, kind, name = _event_rows(item, rule.event(item)), "AD", item.name
        case Switch():
            forms, kind, name = _switch_rows(item, rule.switch(item)), "DA", item.name
        case AffineEquation(item="Linear", name=name, value=value):
            forms, kind = [value - _variable(name), _variable(name) - value], "Linear"
        case AffineRequirement(value=value):
            forms, kind, name = [value], "Cont_must", ""
        case LogicEquation(item="Logic", name=name, value=value):
            definition = Formula((name, *value.postfix, Connective.IFF))
            forms, kind = _clause_rows(definition, item.origin, sink), "Logic"
        case LogicRequirement(value=value):
            forms, kind, name = _clause_rows(value, item.origin, sink), "Logic_must", ""
        case _:
            return
    for subindex, form in enumerate(forms, start=1):
        yield Row(form, item.origin.row(kind, name, subindex))


def _variable(name: str, coefficient: float = 1.0) -> Affine:
    return Affine(0.0, ((name, coefficient),))


def _event_rows(event: Event, constants: EventConstants) -> list[Affine]:
    """[d = 1] <-> [f <= 0]:  f >= eps + (m - eps) d  and  f <= M (1 - d)."""
    eps = event.epsilon
    return [
        Affine(eps) + _variable(event.name, constants.low - eps) - event.form,
        event.form + _variable(event.name, constants.high) - Affine(constants.high),
    ]


def _switch_rows(switch: Switch, constants: SwitchConstants) -> list[Affine]:
    """Z = f1 where s = 1 and f2 where s = 0, with s negated by exchanging the branches."""
    (f1, _), (f2, _) = switch.branches
    z, s, c = _variable(switch.name), switch.condition.name, constants
    return [
        f1 - z + _variable(s, c.c1) - Affine(c.c1),
        z - f1 + _variable(s, c.c2) - Affine(c.c2),
        f2 - z + _variable(s, c.c3),
        z - f2 + _variable(s, c.c4),
    ]


def _clause_rows(formula: Formula, origin: Origin, sink: Sink) -> list[Affine]:
    """Each clause OR(p) OR(~n) as  - sum p + sum n <= #n - 1."""
    try:
        clauses = cnf(formula)
    except TooManyClauses:
        sink.error(
            Code.TOO_MANY_CLAUSES,
            f"the logic of this item expands to more than {MAX_CLAUSES} clauses",
            Span(origin.start, origin.end),
            help="name parts of it by Boolean auxiliaries in LOGIC",
        )
        return []
    return [
        Affine(
            1.0 - sum(not literal.positive for literal in clause),
            tuple((literal.name, -1.0 if literal.positive else 1.0) for literal in clause),
        )
        for clause in clauses
    ]
