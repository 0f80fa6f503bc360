"""An explicit hybrid law as LaTeX: a table of regions, moves and values for each sequence of switches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from os import PathLike

from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.control.hybrid_text import describe_sequence
from hysdel_py.export.law_latex import check_digits, check_moves, finished, law_table, plain

__all__ = ["hybrid_to_latex"]


def hybrid_to_latex(
    law: HybridLaw,
    path: str | PathLike[str] | None = None,
    *,
    digits: int = 4,
    moves: Sequence[str] = (),
    document: bool = True,
) -> str:
    """A hybrid law as tables; where sequences overlap each region has its value too, the least of which decides.

    Parameters
    ----------
    law : HybridLaw
    path : str or path, optional
        Where the text is written as well.
    digits : int
        Significant digits.
    moves : sequence of str
        Names of the moves; those of the inputs by default.
    document : bool
        Whether the text is a document that compiles by itself; if not, it needs amsmath and longtable.

    Raises
    ------
    ArgumentError
        Digits out of range, or another number of names.
    """
    check_digits(digits)
    check_moves(moves, len(law.u))
    names = tuple(moves) or tuple(variable.name for variable in law.u)
    return finished([*_lines(law, names, digits)], path, document=document)


def _lines(law: HybridLaw, names: Sequence[str], digits: int) -> Iterator[str]:
    if not law.partition:
        yield r"Regions of different sequences overlap: the one with the least value $V$ decides."
        yield ""
    for number, sequence in enumerate(law.sequences):
        yield rf"\paragraph{{Sequence {number}}} {plain(describe_sequence(law, number))}"
        yield from law_table(sequence.law, names, digits, with_value=not law.partition)
