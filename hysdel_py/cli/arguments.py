"""Arguments that several commands share, and how their texts become values."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from math import inf

from hysdel_py.errors import ArgumentError
from hysdel_py.model import Model, load
from hysdel_py.systems.signals import Variable

__all__ = ["add_model", "add_output", "assignments", "load_model", "number", "span", "vector"]

_TRUTH = {"true": 1.0, "false": 0.0}


def add_model(parser: argparse.ArgumentParser) -> None:
    """Add the model file and its parameters."""
    parser.add_argument("file", metavar="FILE", help="a .hys file, or the name of a shipped model")
    parser.add_argument(
        "--param", metavar="NAME=VALUE", action="append", default=[], help="value of a parameter; may be repeated"
    )


def add_output(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the choice of plain data for programs."""
    parser.add_argument("--json", action="store_true", help=f"print {what} as JSON")


def load_model(options: argparse.Namespace) -> Model:
    """The model that the arguments name."""
    return load(options.file, **assignments(options.param, "--param"))


def assignments(texts: Sequence[str], option: str) -> dict[str, float]:
    """Values of ``NAME=VALUE`` texts; several may stand in one text, parted by commas."""
    values = {}
    for part in (part for text in texts for part in text.split(",") if part.strip()):
        name, equals, value = part.partition("=")
        if not equals or not name.strip():
            raise ArgumentError(f"{option} {part}: NAME=VALUE was expected")
        values[name.strip()] = number(value, f"{option} {name.strip()}")
    return values


def number(text: str, what: str) -> float:
    """A number, or true and false as 1 and 0."""
    word = text.strip().lower()
    if word in _TRUTH:
        return _TRUTH[word]
    try:
        return float(word)
    except ValueError:
        raise ArgumentError(f"{what} is '{text}': a number was expected") from None


def vector(text: str, variables: Sequence[Variable], what: str) -> list[float] | dict[str, float]:
    """A state or input: numbers in order, as in ``1,0,2``, or by name, as in ``a=1,b=0``."""
    if "=" in text:
        return assignments([text], what)
    return [number(part, what) for part in text.split(",") if part.strip()] if variables or text.strip() else []


def span(text: str, what: str) -> tuple[float, float]:
    """Two ends as in ``0:5``; an end that is left out is infinite."""
    low, colon, high = text.partition(":")
    if not colon:
        raise ArgumentError(f"{what} is '{text}': LOW:HIGH was expected, one of them may be left out")
    return (number(low, what) if low.strip() else -inf, number(high, what) if high.strip() else inf)
