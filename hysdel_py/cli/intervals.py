"""Sets of states and inputs as arguments: ``level=0.1:0.3,open=1``."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from hysdel_py.cli.arguments import number, parts, span
from hysdel_py.errors import ArgumentError

__all__ = ["add_runs", "intervals"]

Ends = tuple[float, float]


def add_runs(parser: argparse.ArgumentParser, *, required: bool = True) -> None:
    """Add from where, under which inputs and for how long."""
    parser.add_argument(
        "--x0", metavar="NAME=LOW:HIGH", action="append", default=[],
        help="first states: intervals or values; a state that is not named has its whole range; may be repeated",
    )  # fmt: skip
    parser.add_argument(
        "--input", metavar="NAME=LOW:HIGH", action="append", default=[],
        help="allowed inputs; one that is not named has its whole range; may be repeated",
    )  # fmt: skip
    parser.add_argument("--steps", type=int, required=required, metavar="N", help="number of steps")


def intervals(texts: Sequence[str], option: str) -> dict[str, Ends]:
    """Intervals of ``NAME=LOW:HIGH`` and ``NAME=VALUE`` texts.

    Raises
    ------
    ArgumentError
        A name without a value, or one that is no number.
    """
    return {name: _ends(value, f"{option} {name}") for name, value in parts(texts, option, "NAME=LOW:HIGH")}


def _ends(text: str | None, what: str) -> Ends:
    if text is None:
        raise ArgumentError(f"{what}: a value or LOW:HIGH was expected, as in {what}=0:1")
    if ":" in text:
        return span(text, what)
    value = number(text, what)
    return value, value
