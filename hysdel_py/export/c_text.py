"""Pieces of C text that the writers of laws and plants share."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from os import PathLike
from pathlib import Path

import numpy as np

from hysdel_py.errors import ArgumentError

__all__ = [
    "array",
    "check_prefix",
    "chosen_prefix",
    "comment",
    "float_text",
    "guard",
    "index_type",
    "number_text",
    "plain",
    "prefix_of",
    "source_path",
]

_WIDTH = 100
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_KEYWORDS = frozenset({
    "auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else", "enum", "extern", "float",
    "for", "goto", "if", "inline", "int", "long", "main", "register", "restrict", "return", "short", "signed", "sizeof",
    "static", "struct", "switch", "typedef", "union", "unsigned", "void", "volatile", "while",
})  # fmt: skip


def prefix_of(path: Path) -> str:
    """Prefix of all names from the name of a file."""
    stem = re.sub(r"\W", "_", path.stem, flags=re.ASCII)
    return stem if _NAME.fullmatch(stem) and stem not in _KEYWORDS else f"c_{stem}"


def source_path(path: str | PathLike[str]) -> Path:
    """Path of a source.

    Raises
    ------
    ArgumentError
        It does not end in .c, or its folder does not exist.
    """
    source = Path(path)
    if source.suffix != ".c":
        raise ArgumentError(f"{source}: a name that ends in .c was expected")
    if not source.parent.is_dir():
        raise ArgumentError(f"{source}: the folder {source.parent} does not exist")
    return source


def check_prefix(prefix: str) -> str:
    """The prefix, if a name in C may begin with it.

    Raises
    ------
    ArgumentError
        It may not.
    """
    if not _NAME.fullmatch(prefix) or prefix in _KEYWORDS:
        raise ArgumentError(f"prefix is {prefix!r}: a letter, then letters, digits and underscores were expected")
    return prefix


def chosen_prefix(prefix: str | None, source: Path) -> str:
    """The prefix that was asked for, checked, or that of the name of the file."""
    return check_prefix(prefix) if prefix is not None else prefix_of(source)


def guard(prefix: str) -> str:
    """Name of the macro that keeps a header from being read twice."""
    return f"{prefix.upper()}_H"


def comment(lines: Iterable[str]) -> list[str]:
    """Lines as a comment; what would end it or join lines is spelled differently."""
    return ["/*", *(f" * {plain(line)}".rstrip() for line in lines), " */"]


def plain(text: str) -> str:
    """A text that may stand in a comment."""
    return " ".join(text.replace("*/", "* /").replace("/*", "/ *").replace("\\", "/").splitlines())


def float_text(value: float) -> str:
    """A double that reads back as the same number."""
    text = repr(float(value) + 0.0)
    return text if any(mark in text for mark in ".en") else f"{text}.0"


def number_text(value: float, c_type: str) -> str:
    """A number of a table in its type."""
    match c_type:
        case "double":
            return float_text(value)
        case "float":
            short = str(np.float32(value) + np.float32(0.0))
            return (short if any(mark in short for mark in ".en") else f"{short}.0") + "f"
        case _:
            return str(int(value))


def index_type(values: Iterable[int]) -> tuple[str, int]:
    """The smallest integer type of C that holds some numbers, and its bytes; signed if one is negative."""
    numbers = list(values)
    low, high = min(numbers, default=0), max(numbers, default=0)
    sign = "" if low < 0 else "u"
    for bits in (8, 16, 32):
        least, greatest = (-(2 ** (bits - 1)), 2 ** (bits - 1)) if low < 0 else (0, 2**bits)
        if least <= low and high < greatest:
            return f"{sign}int{bits}_t", bits // 8
    raise ArgumentError(f"the law has tables of {high} entries: fewer were expected")


def array(declaration: str, items: Sequence[str]) -> Iterator[str]:
    """A table of constants, several to a line."""
    yield f"static const {declaration} = {{"
    line = "   "
    for item in items:
        if len(line) + len(item) + 2 > _WIDTH:
            yield line
            line = "   "
        line += f" {item},"
    yield line
    yield "};"
