"""What the original tells of each name: ``symtable``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from hysdel_py.export.compiled import Compiled, needed_ranges
from hysdel_py.export.matlab_text import Value
from hysdel_py.lowering.symbolic import MAX_SIZE
from hysdel_py.semantics.expressions import Expression, Reference, children
from hysdel_py.semantics.symbols import Symbol
from hysdel_py.semantics.typed_model import TypedModel
from hysdel_py.syntax.source import Span
from hysdel_py.systems.signals import Variable
from hysdel_py.systems.symbolic import Symbolic

__all__ = ["symbol_table"]

Fields = dict[str, Value]
_NOWHERE = -1.0


def symbol_table(compiled: Compiled) -> list[Fields]:
    """Fields of each name, parameters and generated names included, sorted by name."""
    first_use = _first_uses(compiled.typed)
    entries = [*_variables(compiled, first_use), *_parameters(compiled, first_use)]
    return sorted(entries, key=lambda fields: str(fields["name"]))


def _parameters(compiled: Compiled, first_use: Mapping[str, int]) -> Iterator[Fields]:
    for symbol in compiled.typed.parameters:
        yield {
            "name": symbol.name,
            "type": "r" if symbol.is_real else "b",
            "line_of_declaration": float(symbol.line or _NOWHERE),
            "line_of_first_use": float(first_use.get(symbol.name, _NOWHERE)),
            "computable_order": _NOWHERE,
            "kind": "p",
            "value": _writable(compiled.values.get(symbol.name, math.nan)),
        }


def _writable(value: float) -> float:
    """A value, not a number in place of an expression that is too long; only one that no row uses can be."""
    return math.nan if isinstance(value, Symbolic) and value.size > MAX_SIZE else value


def _variables(compiled: Compiled, first_use: Mapping[str, int]) -> Iterator[Fields]:
    mld = compiled.mld
    ranges = needed_ranges(compiled.dha)
    declared = {symbol.name for symbol in compiled.typed.symbols if symbol.bounds is not None or not symbol.is_real}
    orders = _computable_orders(compiled)
    for kind, group in (("x", mld.x), ("u", mld.u), ("y", mld.y), ("d", mld.d), ("z", mld.z)):
        reals = sum(not v.is_bool for v in group)
        for position, variable in enumerate(group, start=1):
            low, high = (0.0, 1.0) if variable.is_bool else ranges.get(variable.name, (-math.inf, math.inf))
            computed = float(variable.name in ranges and variable.name not in declared)
            definition = compiled.dha.definitions.get(variable.name)
            yield {
                "name": variable.name,
                "type": "b" if variable.is_bool else "r",
                "line_of_declaration": _declared_line(variable),
                "line_of_first_use": float(first_use.get(variable.name, _NOWHERE)),
                "computable_order": float(orders.get(variable.name, _NOWHERE)),
                "kind": kind,
                "index": float(position - reals if variable.is_bool else position),
                "defined": math.nan if definition is None else float(definition.origin.group),
                "min": low,
                "min_computed": 0.0 if variable.is_bool else computed,
                "max": high,
                "max_computed": 0.0 if variable.is_bool else computed,
            }


def _declared_line(variable: Variable) -> float:
    return _NOWHERE if variable.generated or not variable.line else float(variable.line)


def _first_uses(model: TypedModel) -> dict[str, int]:
    """First line in which each name is read, in an item, a range or the value of a parameter."""
    spans: dict[str, Span] = {}
    for symbol in model.symbols:
        for expression in _declared_expressions(symbol):
            _collect(expression, spans)
    for item in model.items:
        for expression in item.expressions():
            _collect(expression, spans)
    return {name: model.source.line_of(span) for name, span in spans.items()}


def _declared_expressions(symbol: Symbol) -> tuple[Expression, ...]:
    return (*(symbol.bounds or ()), *((symbol.value,) if symbol.value is not None else ()))


def _collect(expression: Expression, spans: dict[str, Span]) -> None:
    pending = [expression]
    while pending:
        node = pending.pop()
        if isinstance(node, Reference):
            name = node.symbol.name
            if name not in spans or node.span.start < spans[name].start:
                spans[name] = node.span
        pending.extend(children(node))


def _computable_orders(compiled: Compiled) -> dict[str, int]:
    """1 for what is known at the start of a step, else one more than the latest thing that is read."""
    dha = compiled.dha
    orders = {v.name: 1 for v in (*dha.x, *dha.u)}
    for name in (*dha.evaluation_order, *(v.name for v in dha.y)):
        definition = dha.definitions.get(name)
        depends = definition.origin.depends if definition else ()
        orders[name] = 1 + max((orders.get(other, 0) for other in depends), default=0)
    return orders
