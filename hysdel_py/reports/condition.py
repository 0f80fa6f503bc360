"""Conditions in the language of the models: ``level(1) >= 0.6 & ~open``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from hysdel_py.analysis.hybrid_set import HybridSet, Span, hybrid_set
from hysdel_py.analysis.monitor import RESULT, Monitor, Signal, monitor_of_intervals, monitor_of_set, signals_of
from hysdel_py.errors import ArgumentError, CompileError
from hysdel_py.model import Model, load
from hysdel_py.semantics.expressions import Expression, leaves
from hysdel_py.semantics.infix import infix
from hysdel_py.semantics.symbols import Role, Symbol
from hysdel_py.semantics.typed_model import Equation, Item
from hysdel_py.syntax.ast import SectionKind
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.signals import Type, Variable

__all__ = ["condition_of", "condition_of_expression"]

_NAME = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*(?:\s*\(\s*\d+(?:\s*,\s*\d+)?\s*\))?")
_WORDS = frozenset({"TRUE", "FALSE", "true", "false", "REAL", "BOOL", "IF", "THEN", "ELSE"})
_FUNCTIONS = frozenset({"sin", "cos", "exp", "log", "sqrt"})
_PLACEHOLDER = re.compile(r"\bsignal_\d+_x\b")

Condition = str | Mapping[str, Span] | HybridSet
"""An expression, names with values or (low, high), or a set of states; a polyhedron over the states as well."""


def condition_of(given: object, model: Model, what: str) -> Monitor:
    """A condition as it may be given.

    Parameters
    ----------
    given : str, mapping of name to value or (low, high), Polyhedron or HybridSet
        A text is a Boolean expression of the language over the states, inputs, outputs, auxiliaries and parameters of
        the model. A mapping names states, outputs or other signals.
    model : Model
    what : str
        Name of the argument, for messages.

    Raises
    ------
    ArgumentError
        What is wrong with the expression, an unknown name, a set of another dimension.
    """
    if isinstance(given, str):
        return _compiled(given, model, what)
    if isinstance(given, Mapping):
        return monitor_of_intervals(given, model.dha, what)
    return monitor_of_set(hybrid_set(given, model.dha.x, what), what)  # type: ignore[arg-type]


def condition_of_expression(expression: Expression, model: Model) -> Monitor:
    """A Boolean expression of a typed model as a condition.

    Raises
    ------
    CompileError
        A parameter without a value, faulty arithmetic; at its place in the source.
    ArgumentError
        A variable has the name that the condition itself has.
    """
    known = signals_of(model.dha)
    read = {leaf.name: known[leaf.name] for leaf in leaves(expression) if not leaf.is_parameter}
    if RESULT in read:
        raise ArgumentError(f"a query reads {RESULT}, which is the name of its own answer: rename the variable")
    result = Symbol(RESULT, Type.BOOL, Role.AUX, expression.span, 1)
    inputs = tuple(Symbol(name, s.variable.type, Role.INPUT, expression.span, 1) for name, s in read.items())
    line = model.typed.source.line_of(expression.span)
    item = Item(SectionKind.LOGIC, 1, result, Equation(expression), expression.span, line, infix(expression))
    small = replace(model.typed, symbols=(*model.typed.parameters, result, *inputs), items=(item,), queries=())
    return Monitor(infix(expression), read, Model(small, model.parameters, ()).dha)


def _compiled(text: str, model: Model, what: str) -> Monitor:
    """The expression as the LOGIC item of a small model, with a plain name for each signal."""
    if not text.strip() or re.search(r"[{};]", text):
        raise ArgumentError(f"{what} is {text!r}: one Boolean expression was expected, as in 'level >= 0.6'")
    known = signals_of(model.dha)
    used: dict[str, str] = {}
    plain = _NAME.sub(lambda match: _plain(match, known, model.parameters, used, what), text)
    dha = _lowered(_text(plain, used, known), used, what, text)
    signals = {place: known[name] for name, place in used.items()}
    inputs = tuple(replace(v, low=-float("inf"), high=float("inf")) for v in dha.u)
    return Monitor(text.strip(), signals, replace(dha, u=inputs))


def _plain(
    match: re.Match[str],
    known: Mapping[str, Signal],
    parameters: Mapping[str, float],
    used: dict[str, str],
    what: str,
) -> str:
    """The name that stands for a signal in the small model; a parameter becomes its value."""
    name = re.sub(r"\s", "", match[0])
    if name in known:
        return used.setdefault(name, f"signal_{len(used)}_x")
    if name in parameters:
        return f"({parameters[name]!r})"
    head = re.match(r"[\w.]+", name)
    if head is not None and head[0] in _WORDS | _FUNCTIONS:
        return match[0]
    raise ArgumentError(f"{what}: there is no {name}; the names are {', '.join(known)}")


def _text(plain: str, used: Mapping[str, str], known: Mapping[str, Signal]) -> str:
    inputs = " ".join(_declaration(known[name].variable, place) for name, place in used.items())
    return (
        f"SYSTEM condition {{ INTERFACE {{ {f'INPUT {{ {inputs} }}' if inputs else ''} }}\n"
        f"IMPLEMENTATION {{ AUX {{ BOOL {RESULT}; }} LOGIC {{ {RESULT} =\n{plain}\n; }} }} }}"
    )


def _declaration(variable: Variable, place: str) -> str:
    return f"BOOL {place};" if variable.type is Type.BOOL else f"REAL {place} [-1e300, 1e300];"


def _lowered(text: str, used: Mapping[str, str], what: str, written: str) -> Dha:
    """The small model; its mistakes are told in the words of the expression."""
    try:
        return load(text).dha
    except CompileError as error:
        first = next(d for d in error.diagnostics if d.severity.value == "error")
        names = {place: name for name, place in used.items()}
        message = _PLACEHOLDER.sub(lambda match: names.get(match[0], match[0]), first.message)
        hint = f" ({_PLACEHOLDER.sub(lambda match: names.get(match[0], match[0]), first.help)})" if first.help else ""
        raise ArgumentError(f"{what} '{written.strip()}': {message}{hint}") from None
