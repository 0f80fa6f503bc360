"""What the commands that prove something share: margins, time limits, and the exit status without an answer."""

from __future__ import annotations

import argparse
from math import inf

from hysdel_py.analysis.margins import Margins
from hysdel_py.errors import ArgumentError

__all__ = ["NOT_SETTLED", "add_margins", "margins_of", "seconds_of"]

NOT_SETTLED = 4
"""Exit status where neither the one answer nor the other was shown."""


def add_margins(parser: argparse.ArgumentParser) -> None:
    """Add band, tolerance and time limit of a proof."""
    margins = Margins()
    parser.add_argument(
        "--band", type=float, default=margins.band, metavar="B",
        help=f"width left out around thresholds, relative to the size of the terms (default {margins.band:g})",
    )  # fmt: skip
    parser.add_argument(
        "--tolerance", type=float, default=margins.tolerance, metavar="T",
        help=f"what counts as a difference, relative to the size of the terms (default {margins.tolerance:g})",
    )  # fmt: skip
    parser.add_argument("--seconds", type=float, default=inf, metavar="T", help="time limit (default none)")


def margins_of(options: argparse.Namespace) -> Margins:
    """Band and tolerance of the arguments."""
    return Margins(options.band, options.tolerance)


def seconds_of(options: argparse.Namespace) -> float:
    """Time limit of the arguments."""
    if not options.seconds > 0:
        raise ArgumentError(f"--seconds {options.seconds:g}: a time above 0 was expected")
    return float(options.seconds)
