"""Pwa to Dha.

Input: a Pwa, also a merged one. Output: a Dha with one event for each hyperplane between modes, one Boolean for each
mode, and one switch for each affine piece of a next state or output. Preserved: the steps and where they are defined;
names of states, inputs, outputs, and of the thresholds that the hyperplanes come from.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, Dha, DhaItem, Event, LogicEquation, LogicRequirement, Switch
from hysdel_py.systems.formula import Connective, Formula, Literal
from hysdel_py.systems.mode import Condition, Mode, RowKind
from hysdel_py.systems.origin import Origin
from hysdel_py.systems.pwa import Pwa
from hysdel_py.systems.signals import Kind, Type, Variable

__all__ = ["pwa_to_dha"]

Vector = NDArray[np.float64]

_SECTIONS = (Event, LogicEquation, Switch)
"""Kinds of auxiliaries in the order in which they are written, so that each has one section."""
_DIGITS = 12
"""Hyperplanes whose scaled coefficients agree to so many digits are the same."""
_EPSILON = 1e-6
"""Gap of a hyperplane that comes from a requirement, which has none of its own."""


def pwa_to_dha(pwa: Pwa) -> Dha:
    """The Dha that does what the modes say."""
    return _Writer(pwa).dha()


class _Writer:
    def __init__(self, pwa: Pwa) -> None:
        self._pwa = pwa
        self._taken = {v.name for v in (*pwa.x, *pwa.u, *pwa.y)}
        self._events: dict[tuple[float, ...], Event] = {}
        self._booleans: list[Variable] = []
        self._reals: list[Variable] = []
        self._items: list[DhaItem] = []

    def dha(self) -> Dha:
        pwa = self._pwa
        literals = [self._literals(mode) for mode in pwa.modes]
        modes = [self._boolean(f"mode_{mode.index}") for mode in pwa.modes]
        logic = [
            self._logic(name, _conjunction(literals_of)) for name, literals_of in zip(modes, literals, strict=True)
        ]
        some = LogicRequirement(_disjunction([_literal(Literal(name)) for name in modes]), Origin("MUST", text="MUST"))
        self._items = [*self._events.values(), *logic]
        updates = [self._equation(row, variable, modes) for row, variable in enumerate((*pwa.x, *pwa.y))]
        items = (*sorted(self._items, key=lambda item: _SECTIONS.index(type(item))), *updates, some)
        origins = tuple(replace(item, origin=replace(item.origin, group=k)) for k, item in enumerate(items, start=1))
        return Dha(
            pwa.name, pwa.x, pwa.u, pwa.y, tuple(self._booleans), tuple(self._reals), origins, pwa.source,
            pwa.tolerances,
        )  # fmt: skip

    def _literals(self, mode: Mode) -> list[Literal]:
        """What has to hold in a mode: sides of hyperplanes, and values of Boolean states and inputs."""
        found = []
        for source, a, b in zip(mode.sources, mode.region.A, mode.region.b, strict=True):
            if source.kind in (RowKind.EVENT, RowKind.MUST):
                found.append(self._side(source, mode, a, float(b)))
        values = mode.values
        booleans = [v.name for v in (*self._pwa.x, *self._pwa.u) if v.is_bool]
        found += [Literal(name, bool(values[name])) for name in booleans if values[name] is not None]
        return list(dict.fromkeys(found))

    def _side(self, source: Condition, mode: Mode, a: Vector, b: float) -> Literal:
        """The literal that says ``a w <= b``; one event stands for both sides of a threshold."""
        holds = source.holds or source.gap == 0.0
        form, gap = mode.form(a, b), source.gap or _EPSILON
        if not holds:
            form = -form + Affine(gap)
        length = float(np.linalg.norm(a))
        normal = (a if holds else -a) / length
        key = (*np.round(normal, _DIGITS) + 0.0, round(form.constant / length, _DIGITS) + 0.0, gap)
        if key not in self._events:
            name = self._boolean(source.name or "must_1")
            origin = Origin("AD", text=f"{name} = {form} <= 0")
            self._events[key] = Event(name, form, None, gap, origin)
        return Literal(self._events[key].name, holds)

    def _equation(self, row: int, variable: Variable, modes: list[str]) -> DhaItem:
        """The next value of a state, or an output."""
        pieces = self._pieces(row)
        is_state = variable.kind is Kind.STATE
        if variable.is_bool:
            return self._boolean_equation(variable, pieces, modes)
        value = pieces[0][0] if len(pieces) == 1 else self._sum_of_switches(variable, pieces, modes)
        section, kind = ("CONTINUOUS", "Continuous") if is_state else ("OUTPUT", "Cont_output")
        return AffineEquation(kind, variable.name, value, Origin(section, text=variable.name))

    def _boolean_equation(
        self, variable: Variable, pieces: list[tuple[Affine, list[int]]], modes: list[str]
    ) -> LogicEquation:
        """The next value of a Boolean state, or a Boolean output; what is no literal gets a Boolean of its own."""
        only = len(pieces) == 1
        parts = [
            _both(Formula((True,)) if only else _literal(Literal(self._condition(variable, modes, where, k))), truth)
            for k, (truth, where) in enumerate(((_truth(form), where) for form, where in pieces), start=1)
            if truth.postfix != (False,)
        ]
        value = _disjunction(parts)
        if value.literal is None and len(value.postfix) > 1:
            name = self._boolean(f"next_{variable.name}" if variable.kind is Kind.STATE else f"now_{variable.name}")
            self._items.append(self._logic(name, value))
            value = Formula((name,))
        section, kind = ("AUTOMATA", "Automata") if variable.kind is Kind.STATE else ("OUTPUT", "Logic_output")
        return LogicEquation(kind, variable.name, value, Origin(section, text=variable.name))

    def _pieces(self, row: int) -> list[tuple[Affine, list[int]]]:
        """Different affine forms of a row of the dynamics, each with its modes."""
        forms: dict[Affine, list[int]] = {}
        for mode in self._pwa.modes:
            line = mode.dynamics[row]
            forms.setdefault(mode.form(line[:-1], -line[-1]), []).append(mode.index)
        return list(forms.items())

    def _sum_of_switches(self, variable: Variable, pieces: list[tuple[Affine, list[int]]], modes: list[str]) -> Affine:
        total = Affine()
        for number, (form, where) in enumerate(pieces, start=1):
            condition = self._condition(variable, modes, where, number)
            name = self._real(f"{variable.name}_{number}", variable)
            zero = Affine()
            self._items.append(Switch(name, Literal(condition), form, zero, None, None, Origin("DA", text=name)))
            total += Affine(0.0, ((name, 1.0),))
        return total

    def _condition(self, variable: Variable, modes: list[str], where: list[int], number: int) -> str:
        """A Boolean that is true in some modes."""
        if len(where) == 1:
            return modes[where[0]]
        name = self._boolean(f"in_{variable.name}_{number}")
        self._items.append(self._logic(name, _disjunction([_literal(Literal(modes[k])) for k in where])))
        return name

    def _logic(self, name: str, value: Formula) -> LogicEquation:
        return LogicEquation("Logic", name, value, Origin("LOGIC", text=f"{name} = {value}"))

    def _boolean(self, wish: str) -> str:
        name = self._free(wish)
        self._booleans.append(Variable(name, Type.BOOL, Kind.BOOLEAN_AUX, 0.0, 1.0))
        return name

    def _real(self, wish: str, like: Variable) -> str:
        name = self._free(wish)
        self._reals.append(Variable(name, Type.REAL, Kind.REAL_AUX, unit=like.unit))
        return name

    def _free(self, wish: str) -> str:
        """A name that is not taken yet."""
        name, number = wish, 2
        while name in self._taken:
            name, number = f"{wish.removesuffix('_1')}_{number}", number + 1
        self._taken.add(name)
        return name


def _literal(literal: Literal) -> Formula:
    return Formula((literal.name,) if literal.positive else (literal.name, Connective.NOT))


def _joined(first: Formula, second: Formula, connective: Connective) -> Formula:
    return Formula((*first.postfix, *second.postfix, connective))


def _conjunction(literals: Iterable[Literal]) -> Formula:
    parts = [_literal(literal) for literal in literals]
    return reduce(lambda a, b: _joined(a, b, Connective.AND), parts) if parts else Formula((True,))


def _disjunction(parts: list[Formula]) -> Formula:
    return reduce(lambda a, b: _joined(a, b, Connective.OR), parts) if parts else Formula((False,))


def _truth(value: Affine) -> Formula:
    """The truth of a Boolean that is an affine form: a number, a variable or one minus it."""
    if not value.terms:
        return Formula((value.constant > 0.5,))
    (name, coefficient), *_ = value.terms
    return _literal(Literal(name, coefficient > 0))


def _both(condition: Formula, truth: Formula) -> Formula:
    if truth.postfix == (True,):
        return condition
    return truth if condition.postfix == (True,) else _joined(condition, truth, Connective.AND)
