"""A Dha as a Python module of its own that needs nothing but Python."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count
from typing import assert_never

from hysdel_py.diagnostics.sink import Sink
from hysdel_py.export.identifiers import identifiers
from hysdel_py.export.statements import LogicWriter, refuse_loop, refuse_undefined
from hysdel_py.semantics.typed_model import TypedModel
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
from hysdel_py.version import __version__

__all__ = ["module_text"]

_FRAME = '''\


class SimulationError(Exception):
    """A step is not allowed; one line for each reason."""


def _vector(value, names, booleans, what):
    if isinstance(value, dict):
        if set(value) != set(names):
            raise ValueError(f"the {what}s are {', '.join(names)}: got {', '.join(value)}")
        value = [value[name] for name in names]
    vector = [float(number) for number in value]
    if len(vector) != len(names):
        raise ValueError(f"the {what} has {len(vector)} entries: {len(names)} were expected ({', '.join(names)})")
    for number, name in zip(vector, names):
        if not abs(number) < inf or (name in booleans and number not in (0.0, 1.0)):
            raise ValueError(f"{what} {name} is {number}")
    return vector


def simulate(x0, inputs, check=True):
    """Steps (x, y, d, z) from a state, one per input; x is the state after the step."""
    steps, x = [], x0
    for u in inputs:
        steps.append(step(x, u, check))
        x = steps[-1][0]
    return steps
'''


def module_text(model: TypedModel, dha: Dha) -> str:
    """Text of a module with ``step(x, u, check)``, which gives what :meth:`Dha.step` gives, and ``simulate``.

    Raises
    ------
    CompileError
        An auxiliary is read and undefined, or auxiliaries are defined in a circle.
    """
    sink = Sink()
    refuse_undefined(model, dha, sink, only_used=True)
    refuse_loop(dha, sink)
    sink.raise_errors(model.source)
    return "\n".join([*_header(dha), _FRAME, "", *_Writer(dha).step()]) + "\n"


def _header(dha: Dha) -> Iterator[str]:
    yield f'"""One step of {dha.name}, written by hysdel_py {__version__}; needs only Python."""'
    yield ""
    yield "from math import inf"
    yield ""
    for key, group in _groups(dha).items():
        yield f"{key.upper()} = {tuple(v.name for v in group)!r}"
    yield f"BOOLEANS = {tuple(v.name for v in (*dha.x, *dha.u) if v.is_bool)!r}"


def _groups(dha: Dha) -> dict[str, tuple[Variable, ...]]:
    return {"x": dha.x, "u": dha.u, "y": dha.y, "d": dha.d, "z": dha.z}


class _Writer:
    """Writes the statements of one Dha; a prefix keeps its names apart from those of Python."""

    def __init__(self, dha: Dha) -> None:
        self._dha = dha
        groups = {key: group for key, group in _groups(dha).items() if key != "y"}
        named = identifiers(v.name for group in groups.values() for v in group)
        self._text = {v.name: f"{key}_{named[v.name]}" for key, group in groups.items() for v in group}
        self._fresh = (f"t{number}" for number in count(1))
        self._logic = LogicWriter(
            "True", "False", "(not {0})", "({0} and {1})", "({0} or {1})", "({0} == {1})",
            lambda name: f"({self._text[name]} > 0.5)", "{0} = {1}",
        )  # fmt: skip

    def step(self) -> Iterator[str]:
        dha = self._dha
        yield "def step(x, u=(), check=True):"
        yield '    """Next state, output, Boolean and real auxiliaries, as lists."""'
        yield from (f"    {line}" for line in self._body(dha))

    def _body(self, dha: Dha) -> Iterator[str]:
        for key, group, what in (("x", dha.x, "state"), ("u", dha.u, "input")):
            yield f"{key} = _vector({key}, {key.upper()}, BOOLEANS, {what!r})"
            yield from (f"{self._text[v.name]} = {key}[{index}]" for index, v in enumerate(group))
        for name in dha.evaluation_order:
            yield from self._definition(self._text[name], dha.definitions.get(name))
        yield "if check:"
        yield "    problems = []"
        yield from (f"    {line}" for line in self._checks())
        yield "    if problems:"
        yield '        raise SimulationError("\\n".join(problems))'
        for target, group in (("n", dha.x), ("y", dha.y)):
            for index, variable in enumerate(group):
                yield from self._definition(f"{target}{index}", dha.definitions.get(variable.name))
        results = [_listed(f"{t}{i}" for i in range(len(g))) for t, g in (("n", dha.x), ("y", dha.y))]
        results += [_listed(self._text[v.name] for v in group) for group in (dha.d, dha.z)]
        yield f"return {', '.join(results)}"

    def _definition(self, target: str, definition: Definition | None) -> Iterator[str]:
        match definition:
            case None:
                yield f"{target} = 0.0"
            case Event(form=form):
                yield f"{target} = float({self._form(form)} <= 0.0)"
            case AffineEquation(value=value):
                yield f"{target} = {self._form(value)}"
            case LogicEquation(value=formula):
                lines, condition = self._logic.write(formula, self._fresh)
                yield from (*lines, f"{target} = float({condition})")
            case Switch(condition=condition, then=then, otherwise=otherwise):
                holds = f"{self._text[condition.name]} {'>' if condition.positive else '<='} 0.5"
                yield f"if {holds}:"
                yield f"    {target} = {self._form(then)}"
                yield "else:"
                yield f"    {target} = {self._form(otherwise)}"
            case _:
                assert_never(definition)

    def _form(self, form: Affine) -> str:
        """Operations in the order of :meth:`Affine.value`, so that the results are the same to the last bit."""
        return f"{form.constant!r} + sum({_listed(self._terms(form))})"

    def _terms(self, form: Affine) -> list[str]:
        return [f"{coefficient!r} * {self._text[name]}" for name, coefficient in form.terms]

    def _checks(self) -> Iterator[str]:
        dha, slack = self._dha, self._dha.tolerances.range
        for what, group in (("state", dha.x), ("input", dha.u)):
            for v in group:
                low, high = v.low - slack * max(1.0, abs(v.low)), v.high + slack * max(1.0, abs(v.high))
                yield f"if not {low!r} <= {self._text[v.name]} <= {high!r}:"
                yield f"    problems.append({_range_message(what, v)!r} % {self._text[v.name]})"
        for requirement in dha.requirements:
            yield from self._requirement(requirement)

    def _requirement(self, requirement: AffineRequirement | LogicRequirement) -> Iterator[str]:
        if isinstance(requirement, LogicRequirement):
            lines, condition = self._logic.write(requirement.value, self._fresh)
            yield from lines
        else:
            form = requirement.value
            sizes = [f"abs({term})" for term in self._terms(form)]
            size = f"({abs(form.constant)!r} + sum({_listed(sizes)}))"
            tolerances = self._dha.tolerances
            condition = f"{self._form(form)} <= {tolerances.row!r} + {tolerances.rounding!r} * {size}"
        yield f"if not ({condition}):"
        yield f"    problems.append({f'MUST is violated in {requirement.origin}'!r})"


def _range_message(what: str, variable: Variable) -> str:
    text = f"{what} {variable.name} = %.12g is outside its range [{variable.low:g}, {variable.high:g}]"
    return f"{text} (declared in line {variable.line})" if variable.line else text


def _listed(texts: Sequence[str] | Iterator[str]) -> str:
    return f"[{', '.join(texts)}]"
