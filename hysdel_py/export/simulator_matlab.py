"""A Dha as a MATLAB function that makes one step."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from itertools import count
from typing import assert_never

from hysdel_py.diagnostics.sink import Sink
from hysdel_py.export.compiled import Compiled
from hysdel_py.export.matlab import MatlabOptions, parameter_checks
from hysdel_py.export.matlab_text import NumberStyle, quoted
from hysdel_py.export.statements import LogicWriter, refuse_loop, refuse_undefined
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
from hysdel_py.systems.symbolic_mld import SymbolicMld
from hysdel_py.version import __version__

__all__ = ["function_name", "simulator_text"]


def function_name(stem: str) -> str:
    """Name of the function for the stem of a file name."""
    name = re.sub(r"\W", "_", stem, flags=re.ASCII)
    return name if name[:1].isalpha() else f"s{name}"


def simulator_text(compiled: Compiled, name: str, options: MatlabOptions) -> str:
    """Text of the function ``[xn, d, z, y] = name(x, u, params)``.

    Raises
    ------
    CompileError
        A state, output or auxiliary is undefined, or auxiliaries are defined in a circle.
    """
    sink = Sink()
    refuse_undefined(compiled.typed, compiled.dha, sink, only_used=False)
    refuse_loop(compiled.dha, sink)
    sink.raise_errors(compiled.typed.source)
    return "\n".join(_Writer(compiled, options).lines(name)) + "\n"


class _Writer:
    """Writes the statements of one Dha."""

    def __init__(self, compiled: Compiled, options: MatlabOptions) -> None:
        self._dha: Dha = compiled.dha
        self._mld = compiled.mld
        self._options = options
        self._style: NumberStyle = options.style
        groups = {"x": self._dha.x, "u": self._dha.u, "d": self._dha.d, "z": self._dha.z}
        self._text = {v.name: f"{key}({i})" for key, group in groups.items() for i, v in enumerate(group, start=1)}
        self._fresh = (f"t{number}" for number in count(1))
        variable: Callable[[str], str] = lambda name: f"({self._text[name]} > 0.5)"  # noqa: E731 -- closes over the table
        self._logic = LogicWriter(
            "true", "false", "(~{0})", "({0} && {1})", "({0} || {1})", "({0} == {1})", variable, "{0} = {1};"
        )

    def lines(self, name: str) -> Iterator[str]:
        dha = self._dha
        yield f"function [xn, d, z, y] = {name}(x, u, params)"
        yield f"% One step of {dha.name}, written by hysdel_py {__version__}"
        yield from self._legend()
        yield "if nargin < 2, u = []; end"
        if self._options.parameter_checks and isinstance(self._mld, SymbolicMld):
            yield from parameter_checks(self._mld.parameters)
        yield from self._shape("x", "state", len(dha.x))
        yield from self._shape("u", "input", len(dha.u))
        yield f"d = zeros({len(dha.d)}, 1); z = zeros({len(dha.z)}, 1);"
        yield f"xn = zeros({len(dha.x)}, 1); y = zeros({len(dha.y)}, 1);"
        yield "problems = {};"
        for auxiliary in dha.evaluation_order:
            yield from self._definition(self._text[auxiliary], dha.definitions[auxiliary])
        yield from self._checks()
        yield "if ~isempty(problems), error('%s', sprintf('%s\\n', problems{:})); end"
        for target, group in (("xn", dha.x), ("y", dha.y)):
            for number, variable in enumerate(group, start=1):
                yield from self._definition(f"{target}({number})", dha.definitions[variable.name])
        yield "end"

    def _legend(self) -> Iterator[str]:
        dha = self._dha
        for key, group in (("x", dha.x), ("u", dha.u), ("d", dha.d), ("z", dha.z), ("y", dha.y)):
            yield f"%   {key}: {', '.join(v.name for v in group) or '(none)'}"

    def _shape(self, key: str, what: str, size: int) -> Iterator[str]:
        yield f"if numel({key}) ~= {size}, error('the {what} {key} must have {size} entries'); end"
        yield f"{key} = reshape({key}, {size}, 1);"

    def _definition(self, target: str, definition: Definition) -> Iterator[str]:
        match definition:
            case Event(form=form):
                yield f"{target} = double({self._form(form)} <= 0);"
            case AffineEquation(value=value):
                yield f"{target} = {self._form(value)};"
            case LogicEquation(value=formula):
                lines, condition = self._logic.write(formula, self._fresh)
                yield from (*lines, f"{target} = double({condition});")
            case Switch(condition=condition, then=then, otherwise=otherwise):
                sign = ">" if condition.positive else "<="
                yield f"if {self._text[condition.name]} {sign} 0.5"
                yield f"  {target} = {self._form(then)};"
                yield "else"
                yield f"  {target} = {self._form(otherwise)};"
                yield "end"
            case _:
                assert_never(definition)

    def _form(self, form: Affine) -> str:
        """Terms in the order of the form, numbers and expressions in parentheses."""
        terms = [f"({self._style.number(c)})*{self._text[name]}" for name, c in form.terms if c]
        if form.constant or not terms:
            terms.insert(0, f"({self._style.number(form.constant)})")
        return " + ".join(terms)

    def _checks(self) -> Iterator[str]:
        dha, tolerance = self._dha, self._style.number(self._dha.tolerances.range)
        for what, group in (("state", dha.x), ("input", dha.u)):
            for variable in group:
                yield from self._range(what, variable, tolerance)
        for requirement in dha.requirements:
            yield from self._requirement(requirement)

    def _range(self, what: str, variable: Variable, tolerance: str) -> Iterator[str]:
        text = self._text[variable.name]
        message = quoted(f"{what} {variable.name} = %.9g is outside its range (declared in line {variable.line})")
        if variable.is_bool:
            yield self._problem(f"{text} ~= 0 && {text} ~= 1", f"sprintf({message}, {text})")
            return
        sides = (("<", "-", variable.low), (">", "+", variable.high))
        tests = [f"{text} {sign} {self._style.entry(end)} {slack} {tolerance}*max(1, abs({self._style.entry(end)}))"
                 for sign, slack, end in sides if not math.isinf(end)]  # fmt: skip
        if tests:
            yield self._problem(" || ".join(tests), f"sprintf({message}, {text})")

    def _requirement(self, requirement: AffineRequirement | LogicRequirement) -> Iterator[str]:
        message = quoted(f"MUST is violated in {requirement.origin}")
        if isinstance(requirement, LogicRequirement):
            lines, condition = self._logic.write(requirement.value, self._fresh)
            yield from (*lines, self._problem(f"~{condition}", message))
            return
        form = requirement.value
        sizes = [f"abs(({self._style.number(c)})*{self._text[name]})" for name, c in form.terms]
        size = " + ".join([f"abs({self._style.number(form.constant)})", *sizes])
        row, rounding = map(self._style.number, (self._dha.tolerances.row, self._dha.tolerances.rounding))
        yield self._problem(f"{self._form(form)} > {row} + {rounding}*({size})", message)

    def _problem(self, condition: str, message: str) -> str:
        return f"if {condition}, problems{{end + 1}} = {message}; end"
