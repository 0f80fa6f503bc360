"""The function in C that makes one step of a discrete hybrid automaton."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import count
from typing import assert_never

from hysdel_py.export.c_text import float_text, plain
from hysdel_py.export.statements import LogicWriter
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import (
    AffineEquation,
    AffineRequirement,
    Definition,
    Dha,
    Event,
    LogicEquation,
    LogicRequirement,
    Switch,
)
from hysdel_py.systems.signals import Variable

__all__ = ["step_body"]

_SIZE = ["static double size(double value)", "{", "    return value < 0.0 ? -value : value;", "}", ""]


def step_body(dha: Dha, name: str, prototype: str) -> Iterator[str]:
    """Lines of the function and of what it calls."""
    if any(isinstance(item, AffineRequirement) for item in dha.requirements):
        yield from _SIZE
    yield prototype
    yield "{"
    yield from (f"    {line}" for line in _Writer(dha, name.upper()).lines())
    yield "}"
    yield ""


class _Writer:
    """Writes the statements of one Dha; values are entries of arrays, so that no name can clash."""

    def __init__(self, dha: Dha, upper: str) -> None:
        self._dha, self._upper = dha, upper
        groups = {"x": dha.x, "u": dha.u, "own_d": dha.d, "own_z": dha.z}
        self._text = {v.name: f"{key}[{i}]" for key, group in groups.items() for i, v in enumerate(group)}
        self._fresh = (f"t{number}" for number in count(1))
        self._logic = LogicWriter(
            "1", "0", "(!{0})", "({0} && {1})", "({0} || {1})", "({0} == {1})",
            lambda name: f"({self._text[name]} > 0.5)", "const int {0} = {1};",
        )  # fmt: skip

    def lines(self) -> Iterator[str]:
        dha = self._dha
        own = (("next", dha.x), ("out", dha.y), ("own_d", dha.d), ("own_z", dha.z))
        yield from (f"double {key}[{len(group)}];" for key, group in own if group)
        yield "int status = 0;"
        yield from (f"(void){key};" for key, group in (("x", dha.x), ("u", dha.u)) if not group)
        yield from self._validity()
        for name in dha.evaluation_order:
            yield from self._definition(self._text[name], name, dha.definitions.get(name))
        yield from self._checks()
        for target, group in (("next", dha.x), ("out", dha.y)):
            for index, variable in enumerate(group):
                yield from self._definition(f"{target}[{index}]", variable.name, dha.definitions.get(variable.name))
        for target, source, group in (("x_next", "next", dha.x), ("y", "out", dha.y), ("d", "own_d", dha.d),
                                      ("z", "own_z", dha.z)):  # fmt: skip
            yield from _copied(target, source, len(group), may_be_null=target in "dz")
        yield "return status;"

    def _validity(self) -> Iterator[str]:
        for key, group in (("x", self._dha.x), ("u", self._dha.u)):
            for index, variable in enumerate(group):
                value = f"{key}[{index}]"
                valid = f"{value} >= -DBL_MAX && {value} <= DBL_MAX"
                if variable.is_bool:
                    valid = f"{value} == 0.0 || {value} == 1.0"
                yield f"if (!({valid}))"
                yield f"    return {self._upper}_INVALID;"

    def _definition(self, target: str, name: str, definition: Definition | None) -> Iterator[str]:
        yield f"/* {name} */"
        match definition:
            case None:
                yield f"{target} = 0.0;"
            case Event(form=form):
                yield f"{target} = {self._form(form)} <= 0.0 ? 1.0 : 0.0;"
            case AffineEquation(value=value):
                yield f"{target} = {self._form(value)};"
            case LogicEquation(value=formula):
                lines, condition = self._logic.write(formula, self._fresh)
                yield from (*lines, f"{target} = {condition} ? 1.0 : 0.0;")
            case Switch(condition=condition, then=then, otherwise=otherwise):
                yield f"if ({self._text[condition.name]} {'>' if condition.positive else '<='} 0.5)"
                yield f"    {target} = {self._form(then)};"
                yield "else"
                yield f"    {target} = {self._form(otherwise)};"
            case _:
                assert_never(definition)

    def _form(self, form: Affine) -> str:
        terms = self._terms(form)
        return f"{float_text(form.constant)} + ({' + '.join(terms)})" if terms else float_text(form.constant)

    def _terms(self, form: Affine) -> list[str]:
        return [f"{float_text(coefficient)} * {self._text[name]}" for name, coefficient in form.terms]

    def _checks(self) -> Iterator[str]:
        for key, group, bit in (("x", self._dha.x, "STATE_RANGE"), ("u", self._dha.u, "INPUT_RANGE")):
            for index, variable in enumerate(group):
                outside = " || ".join(self._outside(f"{key}[{index}]", variable))
                if outside:
                    yield f"if ({outside})"
                    yield f"    status |= {self._upper}_{bit};"
        for requirement in self._dha.requirements:
            yield from self._requirement(requirement)

    def _outside(self, value: str, variable: Variable) -> Iterator[str]:
        slack = self._dha.tolerances.range
        if math.isfinite(variable.low):
            yield f"{value} < {float_text(variable.low - slack * max(1.0, abs(variable.low)))}"
        if math.isfinite(variable.high):
            yield f"{value} > {float_text(variable.high + slack * max(1.0, abs(variable.high)))}"

    def _requirement(self, requirement: AffineRequirement | LogicRequirement) -> Iterator[str]:
        if isinstance(requirement, LogicRequirement):
            lines, condition = self._logic.write(requirement.value, self._fresh)
            yield from lines
        else:
            form, tolerances = requirement.value, self._dha.tolerances
            sizes = [float_text(abs(form.constant)), *(f"size({term})" for term in self._terms(form))]
            slack = f"{float_text(tolerances.row)} + {float_text(tolerances.rounding)} * ({' + '.join(sizes)})"
            condition = f"{self._form(form)} <= {slack}"
        yield f"/* {plain(str(requirement.origin))} */"
        yield f"if (!({condition}))"
        yield f"    status |= {self._upper}_MUST;"


def _copied(target: str, source: str, count: int, *, may_be_null: bool) -> Iterator[str]:
    if not count:
        yield f"(void){target};"
        return
    if may_be_null:
        yield f"if ({target} != NULL) {{"
    indent = "    " * may_be_null
    yield from (f"{indent}{target}[{index}] = {source}[{index}];" for index in range(count))
    if may_be_null:
        yield "}"
