"""Words of Booleans that the modes of a Pwa stand for, and what the definitions of a Dha come to under a word."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

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
from hysdel_py.systems.formula import Formula
from hysdel_py.systems.mode import Mode
from hysdel_py.systems.pwa import Pwa
from hysdel_py.systems.signals import Variable

__all__ = ["Cell", "Evaluation", "FullWord", "cells_of", "evaluated"]

Vector = NDArray[np.float64]
FullWord = tuple[tuple[str, bool], ...]

MOST_FREE = 10
"""A joined mode may leave so many Boolean states and inputs free; each doubles its words."""


@dataclass(frozen=True, slots=True)
class Cell:
    """The states and inputs at which the Booleans of a Dha have certain values.

    Attributes
    ----------
    word : tuple of (name, value)
        All Boolean auxiliaries, and those Boolean states and inputs on which something depends.
    modes : tuple of int
        Modes that list the word.
    is_sure : bool
        Whether the word belongs to its mode. Where modes were joined, only a point of the cell tells which mode has it.
    """

    word: FullWord
    modes: tuple[int, ...]
    is_sure: bool


def cells_of(pwa: Pwa) -> tuple[Cell, ...] | None:
    """The cells of all modes; None where joined modes have too many words, or words that are not known."""
    found: dict[FullWord, list[int]] = {}
    joined: set[FullWord] = set()
    for mode in pwa.modes:
        if not _is_joined(pwa, mode):
            found.setdefault(_fixed(mode), []).append(mode.index)
            continue
        words = tuple(_words_of_joined(pwa, mode))
        if not words:
            return None
        joined.update(words)
        for word in dict.fromkeys(words):
            found.setdefault(word, []).append(mode.index)
    return tuple(
        Cell(word, tuple(modes), is_sure=len(modes) == 1 and word not in joined) for word, modes in found.items()
    )


def _is_joined(pwa: Pwa, mode: Mode) -> bool:
    values = mode.values
    return any(values.get(v.name) is None for v in pwa.d)


def _fixed(mode: Mode) -> FullWord:
    return tuple((name, value) for name, value in mode.word if value is not None)


def _words_of_joined(pwa: Pwa, mode: Mode) -> Iterator[FullWord]:
    """The d of each part, with every value of the Boolean states and inputs that the joined mode leaves free."""
    given = [v.name for v in (*pwa.x, *pwa.u) if v.is_bool and v.name in mode.values]
    fixed = {name: mode.values[name] for name in given}
    free = [name for name in given if fixed[name] is None]
    if len(free) > MOST_FREE:
        return
    parts = [leaf for leaf, owner in zip(pwa.leaves, pwa.owner, strict=False) if owner == mode.index]
    for part, values in product(parts, product((False, True), repeat=len(free))):
        known = fixed | dict(zip(free, values, strict=True))
        d = {v.name: bool(value > 0.5) for v, value in zip(pwa.d, part.d, strict=True)}
        yield tuple((name, bool({**known, **d}[name])) for name, _ in mode.word)


@dataclass(frozen=True, eq=False, slots=True)
class Evaluation:
    """What the definitions of a Dha come to under a word, as maps of ``(x, u, 1)``.

    Coordinates with a value in the word are numbers.

    Attributes
    ----------
    results : mapping of name to array of shape (n + 1,)
        Next states (marked by a ``'``) and outputs.
    events : tuple of (Event, array of shape (n + 1,))
    requirements : tuple of (AffineRequirement, array of shape (n + 1,))
    is_possible : bool
        Whether logic gives the values of the word and meets MUST.
    """

    results: Mapping[str, Vector]
    events: tuple[tuple[Event, Vector], ...]
    requirements: tuple[tuple[AffineRequirement, Vector], ...]
    is_possible: bool


def evaluated(dha: Dha, word: FullWord) -> Evaluation | None:
    """None where a value does not follow without a search.

    That is so in an algebraic loop, and where logic reads a Boolean that the word leaves free.
    """
    known = _Known.of(dha, word)
    try:
        for name in (n for n in dha.evaluation_order if n not in known.maps):
            known.maps[name] = known.value_of(dha.definitions.get(name))
        results = {f"{v.name}'": known.value_of(dha.definitions.get(v.name)) for v in dha.x}
        results |= {v.name: known.value_of(dha.definitions.get(v.name)) for v in dha.y}
        events = tuple((item, known.map_of(item.form)) for item in dha.items if isinstance(item, Event))
        affine = tuple(
            (item, known.map_of(item.value)) for item in dha.requirements if isinstance(item, AffineRequirement)
        )
        return Evaluation(results, events, affine, known.agrees_with(dha))
    except KeyError:  # a variable that is not known
        return None


@dataclass(frozen=True, eq=False, slots=True)
class _Known:
    """Maps of the variables so far, and the Booleans of the word; asking for another one is a KeyError."""

    maps: dict[str, Vector]
    truths: Mapping[str, float]
    size: int

    @classmethod
    def of(cls, dha: Dha, word: FullWord) -> _Known:
        names = [v.name for v in (*dha.x, *dha.u)]
        truths = {name: float(value) for name, value in word}
        known = cls(dict(zip(names, np.eye(len(names), len(names) + 1), strict=True)), truths, len(names))
        undefined = {v.name: 0.0 for v in (*dha.d, *dha.z) if v.name not in dha.definitions}
        known.maps.update({name: known.number(value) for name, value in {**undefined, **truths}.items()})
        return known

    def number(self, value: float) -> Vector:
        return np.append(np.zeros(self.size), value)

    def map_of(self, form: Affine) -> Vector:
        return sum((c * self.maps[name] for name, c in form.terms if c), start=self.number(form.constant))

    def value_of(self, definition: Definition | None) -> Vector:
        match definition:
            case Switch(condition=condition, then=then, otherwise=otherwise):
                return self.map_of(then if self.truths[condition.name] == condition.positive else otherwise)
            case AffineEquation(value=value):
                return self.map_of(value)
            case LogicEquation(value=formula):
                literal = formula.literal
                if literal is None or literal.name in self.truths:
                    return self.number(self._truth(formula))
                own = self.maps[literal.name]
                return own if literal.positive else self.number(1.0) - own
            case _:
                return self.number(0.0)

    def _truth(self, formula: Formula) -> float:
        return float(formula.value({name: self.truths[name] for name in formula.names}))

    def agrees_with(self, dha: Dha) -> bool:
        own = all(self._truth(dha.definitions[v.name].value) == self.truths[v.name] for v in _logical(dha))  # type: ignore[union-attr, arg-type]
        must = (item.value for item in dha.requirements if isinstance(item, LogicRequirement))
        return own and all(map(self._truth, must))


def _logical(dha: Dha) -> Iterator[Variable]:
    """Boolean auxiliaries that logic defines."""
    return (v for v in dha.d if isinstance(dha.definitions.get(v.name), LogicEquation))
