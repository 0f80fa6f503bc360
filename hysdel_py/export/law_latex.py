"""An explicit law as a LaTeX table of its regions and moves."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.errors import ArgumentError

__all__ = ["check_digits", "check_moves", "finished", "law_table", "law_to_latex", "plain", "symbol"]

_ROUNDING = 1e-12
"""Share of the greatest number of a sum below which a number is rounding."""

_SPECIAL = re.compile(r"[&%$#_{}~^\\]")
_SPELLED = {"~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "\\": r"\textbackslash{}"}
_INDEXED = re.compile(r"([A-Za-z])_?(\d+)")


def law_to_latex(
    law: ExplicitLaw,
    path: str | PathLike[str] | None = None,
    *,
    digits: int = 4,
    moves: Sequence[str] = (),
    document: bool = True,
) -> str:
    """A law as a table of regions, their rows and the moves there.

    Parameters
    ----------
    law : ExplicitLaw
    path : str or path, optional
        Where the text is written as well.
    digits : int
        Significant digits.
    moves : sequence of str
        Names of the moves; u1, u2, ... by default.
    document : bool
        Whether the text is a document that compiles by itself; if not, it needs amsmath and longtable.

    Raises
    ------
    ArgumentError
        Digits out of range, or another number of names.
    """
    check_digits(digits)
    check_moves(moves, law.moves)
    names = tuple(moves) or tuple(f"u{i + 1}" for i in range(law.moves))
    return finished([*law_table(law, names, digits)], path, document=document)


def check_digits(digits: int) -> None:
    """Refuse numbers of digits that a number cannot have."""
    if not 1 <= digits <= 17:
        raise ArgumentError(f"digits is {digits}: a number from 1 to 17 was expected")


def check_moves(moves: Sequence[str], count: int) -> None:
    """Refuse names that are not as many as the moves."""
    if isinstance(moves, str) or (moves and len(moves) != count):
        raise ArgumentError(f"moves are {moves!r}: {count} names were expected")


def finished(lines: Sequence[str], path: str | PathLike[str] | None, *, document: bool) -> str:
    """The whole text, also written to a file where one is named."""
    if document:
        head = [r"\documentclass{article}", r"\usepackage{amsmath,longtable}", r"\begin{document}"]
        lines = [*head, *lines, r"\end{document}"]
    text = "\n".join(lines) + "\n"
    if path is not None:
        Path(path).write_text(text, encoding="utf-8", newline="\n")
    return text


def law_table(law: ExplicitLaw, moves: Sequence[str], digits: int, *, with_value: bool = False) -> Iterator[str]:
    """A long table with a line for each region; the value, where it is asked for, as the last row of the move."""
    names, labels = [symbol(name) for name in law.names], [symbol(name) for name in moves]
    yield r"\begin{longtable}{rll}"
    yield r"\hline"
    yield r"region & where & move \\"
    yield r"\hline"
    yield r"\endhead"
    for region in range(law.count):
        A, b = law.rows(region)
        rows = [
            f"{_sum(row, 0.0, names, digits)} &\\le {_number(side, digits)}" for row, side in zip(A, b, strict=True)
        ]
        values = zip(labels, law.K[region], law.k[region], strict=False)
        laws = [f"{label} &= {_sum(row, float(side), names, digits)}" for label, row, side in values]
        if with_value:
            laws.append(f"V &= {_quadratic(law, region, names, digits)}")
        yield f"{region} & {_aligned(rows)} & {_aligned(laws)} \\\\"
        yield r"\hline"
    yield r"\end{longtable}"


def _aligned(rows: Sequence[str]) -> str:
    return r"$\begin{aligned} " + r" \\ ".join(rows) + r" \end{aligned}$"


def _quadratic(law: ExplicitLaw, region: int, names: Sequence[str], digits: int) -> str:
    """The value of a region, squares first."""
    P = 0.5 * (law.P[region] + law.P[region].T)
    pairs = [(i, j) for i in range(law.p) for j in range(i, law.p)]
    products = [f"{names[i]}^2" if i == j else rf"{names[i]}\,{names[j]}" for i, j in pairs]
    factors = np.array([*(0.5 * P[i, j] if i == j else P[i, j] for i, j in pairs), *law.q[region]])
    return _sum(factors, float(law.r[region]), [*products, *names], digits)


def plain(text: str) -> str:
    """Text with the characters spelled that LaTeX would take for commands."""
    return _SPECIAL.sub(lambda m: _SPELLED.get(m[0], chr(92) + m[0]), text)


def symbol(name: str) -> str:
    """A name in mathematics: a letter with an index where it is one, upright text otherwise."""
    match = _INDEXED.fullmatch(name)
    if match:
        return f"{match[1]}_{{{match[2]}}}"
    if len(name) == 1 and name.isalpha():
        return name
    return rf"\text{{{plain(name)}}}"


def _sum(row: NDArray[np.float64], constant: float, names: Sequence[str], digits: int) -> str:
    size = max(float(np.abs(row).max(initial=0.0)), abs(constant))
    numbers = zip([*row.tolist(), constant], [*names, ""], strict=True)
    terms = [_term(number, name, digits) for number, name in numbers if abs(number) > _ROUNDING * size]
    text = " ".join(terms) or "+ 0"
    return text[2:] if text.startswith("+") else "-" + text[2:]


def _term(number: float, name: str, digits: int) -> str:
    size = _number(abs(number), digits)
    factor = name if name and size == "1" else rf"{size}\,{name}" if name else size
    return f"{'-' if number < 0 else '+'} {factor}"


def _number(value: float, digits: int) -> str:
    """A number with so many digits; powers of ten as such."""
    mantissa, _, exponent = f"{value + 0.0:.{digits}g}".partition("e")
    return rf"{mantissa}\cdot 10^{{{int(exponent)}}}" if exponent else mantissa
