"""A Dha as a ``.hys`` text that compiles to the same behaviour, laid out as ``hysdel fmt`` does."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby

from hysdel_py.errors import ArgumentError
from hysdel_py.export.identifiers import identifiers
from hysdel_py.syntax.formatter import format_text
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import (
    AffineEquation,
    AffineRequirement,
    Dha,
    DhaItem,
    Event,
    LogicEquation,
    LogicRequirement,
    Switch,
)
from hysdel_py.systems.formula import Connective, Formula, Literal
from hysdel_py.systems.signals import Variable

__all__ = ["hysdel_text"]

_DEFAULT_EPSILON = 1e-6
_SECTIONS = {
    "Linear": "LINEAR", "Continuous": "CONTINUOUS", "Cont_output": "OUTPUT",
    "Logic": "LOGIC", "Automata": "AUTOMATA", "Logic_output": "OUTPUT",
}  # fmt: skip
_KEYWORDS = frozenset({
    "SYSTEM", "INTERFACE", "IMPLEMENTATION", "STATE", "INPUT", "OUTPUT", "PARAMETER", "AUX", "AD", "DA", "LOGIC",
    "LINEAR", "CONTINUOUS", "AUTOMATA", "MUST", "REAL", "BOOL", "IF", "THEN", "ELSE", "TRUE", "FALSE", "MODULE",
    "FOR", "INDEX", "sin", "cos", "exp", "log", "sqrt", "pi",
})  # fmt: skip


def hysdel_text(dha: Dha) -> str:
    """The text of a model.

    Names that are no names of the language, such as those of elements of vectors, get underscores instead.

    Raises
    ------
    ArgumentError
        Thresholds have different epsilons and the range of one of them is not known, which the text would have to say.
    """
    spelling = _spelling(dha)
    epsilon = _common_epsilon(dha)
    parameters = [] if epsilon in (None, _DEFAULT_EPSILON) else [f"REAL MLD_epsilon = {_number(float(epsilon))};"]
    interface = [
        *_block("PARAMETER", parameters),
        *_block("STATE", [_declaration(v, spelling) for v in dha.x]),
        *_block("INPUT", [_declaration(v, spelling) for v in dha.u]),
        *_block("OUTPUT", [_declaration(v, spelling) for v in dha.y]),
    ]
    implementation = _block("AUX", [_declaration(v, spelling) for v in (*dha.d, *dha.z)])
    for section, items in groupby(dha.items, key=_section):
        implementation += _block(section, [_item(item, dha, spelling, epsilon) for item in items])
    head = f"SYSTEM {identifiers([dha.name])[dha.name]} {{ INTERFACE {{"
    return format_text("\n".join([head, *interface, "} IMPLEMENTATION {", *implementation, "} }"]))


def _block(keyword: str, lines: list[str]) -> list[str]:
    return [f"{keyword} {{", *lines, "}"] if lines else []


@dataclass(frozen=True, slots=True)
class _Spelling:
    """How variables are written: alone, and as numbers in an affine form."""

    names: Mapping[str, str]
    numbers: Mapping[str, str]


def _spelling(dha: Dha) -> _Spelling:
    variables = (*dha.x, *dha.u, *dha.y, *dha.d, *dha.z)
    plain = identifiers([v.name.lstrip("_") for v in variables], _KEYWORDS.__contains__)
    names = {v.name: plain[v.name.lstrip("_")] for v in variables}
    return _Spelling(names, {v.name: f"(REAL {names[v.name]})" if v.is_bool else names[v.name] for v in variables})


def _common_epsilon(dha: Dha) -> float | None:
    """The gap of all thresholds, None if they differ."""
    gaps = {item.epsilon for item in dha.items if isinstance(item, Event)}
    return gaps.pop() if len(gaps) == 1 else None if gaps else _DEFAULT_EPSILON


def _declaration(variable: Variable, spelling: _Spelling) -> str:
    about = " ".join([f"[{variable.unit}]"] * bool(variable.unit) + [variable.description] * bool(variable.description))
    comment = f" /* {about.replace('*/', '')} */" if about and not variable.generated else ""
    finite = not variable.is_bool and abs(variable.low) != float("inf") and abs(variable.high) != float("inf")
    interval = f" [{_number(variable.low)}, {_number(variable.high)}]" if finite else ""
    return f"{variable.type.value} {spelling.names[variable.name]}{interval};{comment}"


def _section(item: DhaItem) -> str:
    match item:
        case Event():
            return "AD"
        case Switch():
            return "DA"
        case AffineEquation(item=kind) | LogicEquation(item=kind):
            return _SECTIONS[kind]
        case AffineRequirement() | LogicRequirement():
            return "MUST"


def _item(item: DhaItem, dha: Dha, spelling: _Spelling, epsilon: float | None) -> str:
    names, numbers = spelling.names, spelling.numbers
    match item:
        case Event(name=name, form=form):
            return f"{names[name]} = {_affine(form, numbers)} <= 0{_triple(item, dha, epsilon)};"
        case Switch(name=name, condition=condition, then=then, otherwise=otherwise):
            choice = f"IF {_literal(condition, names)} THEN {_affine(then, numbers)} ELSE {_affine(otherwise, numbers)}"
            return f"{names[name]} = {{{choice}}};"
        case AffineEquation(name=name, value=value):
            return f"{names[name]} = {_affine(value, numbers)};"
        case LogicEquation(name=name, value=formula):
            return f"{names[name]} = {_formula(formula, names)};"
        case AffineRequirement(value=value):
            return f"{_affine(value, numbers)} <= 0;"
        case LogicRequirement(value=formula):
            return f"{_formula(formula, names)};"


def _triple(event: Event, dha: Dha, epsilon: float | None) -> str:
    if epsilon is not None and event.limits is None:
        return ""
    ranges = {v.name: (v.low, v.high) for v in (*dha.x, *dha.u, *dha.d, *dha.z)}
    low, high = event.limits or event.form.range(ranges.__getitem__)
    if abs(low) == float("inf") or abs(high) == float("inf"):
        raise ArgumentError(f"the range of {event.form} is not known: thresholds of different epsilons need ranges")
    return f" [{_number(low)}, {_number(high)}, {_number(event.epsilon)}]"


def _number(value: float) -> str:
    """The shortest text that is read back as the same number."""
    return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)


def _affine(form: Affine, numbers: Mapping[str, str]) -> str:
    text = "".join(_terms(form, numbers))
    if form.constant or not text:
        text += f" {'-' if form.constant < 0 else '+'} {_number(abs(form.constant))}"
    text = text.strip()
    return text[2:] if text.startswith("+ ") else text.replace("- ", "-", 1) if text.startswith("- ") else text


def _terms(form: Affine, numbers: Mapping[str, str]) -> Iterator[str]:
    for name, coefficient in form.terms:
        sign, size = ("-", -coefficient) if coefficient < 0 else ("+", coefficient)
        yield f" {sign} {numbers[name]}" if size == 1 else f" {sign} {_number(size)}*{numbers[name]}"


def _literal(literal: Literal, names: Mapping[str, str]) -> str:
    return names[literal.name] if literal.positive else f"~{names[literal.name]}"


def _formula(formula: Formula, names: Mapping[str, str]) -> str:
    """Infix text; a chain of one connective needs no parentheses."""
    stack: list[tuple[str, Connective | None]] = []
    for entry in formula.postfix:
        match entry:
            case bool():
                stack.append(("TRUE" if entry else "FALSE", None))
            case str():
                stack.append((names[entry], None))
            case Connective.NOT:
                text, inner = stack.pop()
                stack.append((f"~({text})" if inner else f"~{text}", None))
            case _:
                right, left = stack.pop(), stack.pop()
                sides = _wrapped(left, entry, is_left=True), _wrapped(right, entry, is_left=False)
                stack.append((f"{sides[0]} {entry.value} {sides[1]}", entry))
    return stack[0][0]


def _wrapped(operand: tuple[str, Connective | None], outer: Connective, *, is_left: bool) -> str:
    text, inner = operand
    chains = is_left and inner is outer and outer in (Connective.AND, Connective.OR)
    return text if inner is None or chains else f"({text})"
