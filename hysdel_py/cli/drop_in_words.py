"""The options of the original compiler: its command line is meant where the first argument is one of them."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["FLAGS", "WITH_VALUE", "is_drop_in", "joined_verbosity"]

WITH_VALUE = {"-i": "source", "-m": "matlab", "-s": "simulator", "-v": "verbosity"}
FLAGS = {
    "-a": "aux",
    "-5": "affine",
    "-p": "every_parameter",
    "--no-symbol-table": "no_symbol_table",
    "--no-row-info": "no_row_info",
    "--no-params-checks": "no_parameter_checks",
    "--matlab-symbolic": "maple",
}


def is_drop_in(arguments: Sequence[str]) -> bool:
    """Whether the first argument is an option of the original compiler."""
    first = arguments[0] if arguments else ""
    return first in FLAGS or first in WITH_VALUE or joined_verbosity(first)


def joined_verbosity(text: str) -> bool:
    """Whether a word is ``-v`` and its value in one."""
    return text.startswith("-v") and text[2:].isdigit()
