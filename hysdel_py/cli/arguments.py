"""Arguments that several commands share, and how their texts become values."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator, Sequence
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.model import Model, load
from hysdel_py.shipped import shipped_models
from hysdel_py.systems.signals import Variable, as_vector

__all__ = [
    "add_model", "add_output", "add_parameters", "add_start", "assignments", "example_values",
    "given_vector", "load_model", "matrix", "number", "parameter_values", "parts", "span",
]  # fmt: skip

_TRUTH = {"true": 1.0, "false": 0.0}
_COMMA = re.compile(r",(?![^()]*\))(?![^\[\]]*\])")
"""A comma that stands neither between parentheses, as in ``W(2,1)``, nor between brackets, as in ``[1,2]``."""


def add_model(parser: argparse.ArgumentParser) -> None:
    """Add the model file and its parameters."""
    shipped = ", ".join(shipped_models())
    parser.add_argument("file", metavar="FILE", help=f"a .hys file, or a shipped model: {shipped}")
    add_parameters(parser)


def add_parameters(parser: argparse.ArgumentParser) -> None:
    """Add the values of parameters, and where modules are looked for."""
    parser.add_argument(
        "--param",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="value of a parameter; a matrix is written [1,0.1;0,1]; may be repeated",
    )
    parser.add_argument(
        "-I",
        "--search-path",
        metavar="FOLDER",
        action="append",
        default=[],
        help="folder for the files of modules, besides that of the file that names them; may be repeated",
    )


def add_start(parser: argparse.ArgumentParser) -> None:
    """Add the first state."""
    parser.add_argument("--x0", metavar="STATE", default="", help="first state: 1,0,2 or a=1,b=0,c=2")


def add_output(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the choice of plain data for programs."""
    parser.add_argument("--json", action="store_true", help=f"print {what} as JSON")


def load_model(options: argparse.Namespace) -> Model:
    """The model that the arguments name."""
    missing = [folder for folder in options.search_path if not Path(folder).is_dir()]
    if missing:
        raise ArgumentError(f"--search-path {missing[0]}: there is no such folder")
    values: dict[str, Any] = parameter_values(options.param, "--param")
    return load(options.file, search_path=options.search_path, **values)


def parameter_values(texts: Sequence[str], option: str) -> dict[str, float | list[list[float]]]:
    """Values of ``NAME=VALUE`` texts; one in brackets is a matrix, given row by row."""
    return {
        name: matrix(value, f"{option} {name}") if value.startswith("[") else number(value, f"{option} {name}")
        for name, value in _with_values(texts, option)
    }


def matrix(text: str, what: str) -> list[list[float]]:
    """A matrix as in ``[1,0.1;0,1]``: commas part the entries of a row, semicolons the rows."""
    if not text.endswith("]"):
        raise ArgumentError(f"{what} is '{text}': a matrix such as [1,0.1;0,1] was expected")
    rows = [[number(entry, what) for entry in row.split(",")] for row in text[1:-1].split(";")]
    lengths = list(dict.fromkeys(map(len, rows)))
    if len(lengths) > 1:
        raise ArgumentError(
            f"{what} has rows of {lengths[0]} and {lengths[1]} numbers: rows of one length were expected"
        )
    return rows


def parts(texts: Sequence[str], option: str, form: str) -> list[tuple[str, str | None]]:
    """Names and values of ``NAME=VALUE`` texts; several may stand in one text, parted by commas.

    Commas between parentheses or brackets part nothing, as in ``W(2,1)=3`` and ``A=[1,2]``.

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
    return {name: number(value, f"{option} {name}") for name, value in _with_values(texts, option)}


def _with_values(texts: Sequence[str], option: str) -> Iterator[tuple[str, str]]:
    for name, value in parts(texts, option, "NAME=VALUE"):
        if value is None:
            raise ArgumentError(f"{option} {name}: NAME=VALUE was expected, as in {option} {name}=1")
        yield name, value


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
