"""Arguments that several commands share, and how their texts become values."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError, HysdelError
from hysdel_py.model import Model, load
from hysdel_py.shipped import shipped_models
from hysdel_py.systems.signals import Variable, as_vector

__all__ = [
    "DataError", "add_model", "add_output", "add_parameters", "add_start", "assignments", "example_values",
    "given_vector", "join_negative_values", "load_model", "number", "parts", "span",
]  # fmt: skip

_TRUTH = {"true": 1.0, "false": 0.0}
_OPTION = re.compile(r"--[a-z][a-z0-9-]*")
_COMMA = re.compile(r",(?![^()]*\))")
"""A comma that does not stand between parentheses, as the one of ``W(2,1)`` does."""
_NEGATIVE = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)


class DataError(HysdelError):
    """What the command line names exists but cannot be used: a file with a mistake, a package that is missing."""


def join_negative_values(arguments: Sequence[str]) -> list[str]:
    """Join an option and the negative number behind it: ``--x0 -1,2`` becomes ``--x0=-1,2``.

    The standard parser takes whatever begins with a minus for an option.
    """
    joined: list[str] = []
    for text in arguments:
        if joined and _OPTION.fullmatch(joined[-1]) and _NEGATIVE.match(text):
            joined[-1] += f"={text}"
        else:
            joined.append(text)
    return joined


def add_model(parser: argparse.ArgumentParser) -> None:
    """Add the model file and its parameters."""
    shipped = ", ".join(shipped_models())
    parser.add_argument("file", metavar="FILE", help=f"a .hys file, or a shipped model: {shipped}")
    add_parameters(parser)


def add_parameters(parser: argparse.ArgumentParser) -> None:
    """Add the values of parameters."""
    parser.add_argument(
        "--param", metavar="NAME=VALUE", action="append", default=[], help="value of a parameter; may be repeated"
    )


def add_start(parser: argparse.ArgumentParser) -> None:
    """Add the first state."""
    parser.add_argument("--x0", metavar="STATE", default="", help="first state: 1,0,2 or a=1,b=0,c=2")


def add_output(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the choice of plain data for programs."""
    parser.add_argument("--json", action="store_true", help=f"print {what} as JSON")


def load_model(options: argparse.Namespace) -> Model:
    """The model that the arguments name."""
    values: dict[str, Any] = dict(assignments(options.param, "--param"))
    return load(options.file, **values)


def parts(texts: Sequence[str], option: str, form: str) -> list[tuple[str, str | None]]:
    """Names and values of ``NAME=VALUE`` texts; several may stand in one text, parted by commas.

    Commas between parentheses part nothing, as in ``W(2,1)=3``.

    Raises
    ------
    ArgumentError
        A name is missing or given twice.
    """
    found: dict[str, str | None] = {}
    for part in (part for text in texts for part in _COMMA.split(text)):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not name:
            raise ArgumentError(f"{option} '{part}': {form} was expected")
        if name in found:
            raise ArgumentError(f"{option} {name} is given twice: one value was expected")
        found[name] = value if equals else None
    return list(found.items())


def assignments(texts: Sequence[str], option: str) -> dict[str, float]:
    """Values of ``NAME=VALUE`` texts."""
    values = {}
    for name, value in parts(texts, option, "NAME=VALUE"):
        if value is None:
            raise ArgumentError(f"{option} {name}: NAME=VALUE was expected, as in {option} {name}=1")
        values[name] = number(value, f"{option} {name}")
    return values


def number(text: str, what: str) -> float:
    """A number, or true and false as 1 and 0."""
    word = text.strip().lower()
    if word in _TRUTH:
        return _TRUTH[word]
    try:
        return float(word)
    except ValueError:
        raise ArgumentError(f"{what} is '{text.strip()}': a number was expected") from None


def given_vector(text: str, variables: Sequence[Variable], option: str, what: str) -> NDArray[np.float64]:
    """A state or input: numbers in order, as in ``1,0,2``, or by name, as in ``a=1,b=0``.

    Raises
    ------
    ArgumentError
        Wrong number of values, unknown or missing name, a value that its variable cannot have; `what` is the word for
        the vector.
    """
    order = ", ".join(v.name for v in variables)
    if not text.strip() and variables:
        raise ArgumentError(f"{option} is missing: the {what} is {order}, as in {option} {example_values(variables)}")
    if "=" in text:
        values: dict[str, float] | list[float] = assignments([text], option)
    else:
        values = [number(part, option) for part in text.split(",")] if text.strip() else []
        if len(values) != len(variables):
            expected = f"{len(variables)} were expected, in the order {order}" if variables else "none was expected"
            raise ArgumentError(f"{option} has {len(values)} number{'s' * (len(values) != 1)}: {expected}")
    try:
        return as_vector(values, variables, what)
    except ArgumentError as error:
        raise ArgumentError(f"{option}: {error}") from None


def example_values(variables: Sequence[Variable]) -> str:
    """Values by name that are allowed, zero where that is possible, to show in a message."""
    return ",".join(f"{v.name}={min(max(0.0, v.low), v.high) + 0.0:g}" for v in variables)


def span(text: str, what: str) -> tuple[float, float]:
    """Two ends as in ``0:5``; an end that is left out is infinite."""
    low, colon, high = text.partition(":")
    if not colon:
        raise ArgumentError(f"{what} is '{text}': LOW:HIGH was expected, one of them may be left out")
    return (number(low, what) if low.strip() else -inf, number(high, what) if high.strip() else inf)
