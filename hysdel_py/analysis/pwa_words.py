"""Words of Booleans that the modes of a Pwa stand for, and what the definitions of a Dha come to under a word."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, Definition, Dha, LogicEquation, Switch, read_by
from hysdel_py.systems.mode import Mode
from hysdel_py.systems.pwa import Pwa

__all__ = ["Cell", "FullWord", "cells_of", "maps_under"]

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


def maps_under(dha: Dha, word: FullWord) -> dict[str, Vector] | None:
    """Next states (marked by a ``'``) and outputs as maps of ``(x, u, 1)`` where the Booleans have their values.

    Coordinates with a value in the word are numbers. None where a value does not follow without a search: in an
    algebraic loop, or where logic reads a Boolean that the word leaves free.
    """
    names = [v.name for v in (*dha.x, *dha.u)]
    truths = {name: float(value) for name, value in word}
    maps = dict(zip(names, np.eye(len(names), len(names) + 1), strict=True))
    maps |= {name: _number(value, len(names)) for name, value in truths.items()}
    for v in (*dha.d, *dha.z):
        if v.name not in dha.definitions:
            maps.setdefault(v.name, _number(0.0, len(names)))
    for name in (n for n in dha.evaluation_order if n not in maps):
        found = _map_of(dha.definitions.get(name), maps, truths)
        if found is None:
            return None
        maps[name] = found
    results = {f"{v.name}'": _map_of(dha.definitions.get(v.name), maps, truths) for v in dha.x}
    results |= {v.name: _map_of(dha.definitions.get(v.name), maps, truths) for v in dha.y}
    known = {name: value for name, value in results.items() if value is not None}
    return known if len(known) == len(results) else None


def _number(value: float, columns: int) -> Vector:
    return np.append(np.zeros(columns), value)


def _map_of(
    definition: Definition | None, maps: Mapping[str, Vector], truths: Mapping[str, float]
) -> Vector | None:
    """The map of a definition, None where it reads what is not known."""
    columns = len(next(iter(maps.values()))) - 1 if maps else 0
    if definition is None:
        return _number(0.0, columns)
    match definition:
        case Switch(condition=condition) if condition.name in truths:
            return _map_of_form(definition.branch(truths), maps, columns)
        case AffineEquation(value=value):
            return _map_of_form(value, maps, columns)
        case LogicEquation(value=formula):
            if all(name in truths for name in read_by(definition)):
                return _number(float(formula.value(truths)), columns)
            literal = formula.literal
            if literal is None or literal.name not in maps:
                return None
            return maps[literal.name] if literal.positive else _number(1.0, columns) - maps[literal.name]
        case _:
            return None


def _map_of_form(form: Affine, maps: Mapping[str, Vector], columns: int) -> Vector | None:
    result = _number(form.constant, columns)
    for name, coefficient in form.terms:
        if coefficient and name not in maps:
            return None
        if coefficient:
            result = result + coefficient * maps[name]
    return result
