"""An explicit law as C99: a header and a source without allocation and without the mathematical library.

The function tells by its result whether the point belongs to the map; outside it writes nothing. A macro compiles a
program that replays points whose moves were computed in Python.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.law_signals import last_input_name
from hysdel_py.errors import ArgumentError
from hysdel_py.export.c_text import chosen_prefix, comment, float_text, guard, source_path
from hysdel_py.export.law_c_code import evaluation, prototype
from hysdel_py.export.law_c_tables import c_tables
from hysdel_py.export.law_c_test import self_test
from hysdel_py.export.law_choice import chosen_table
from hysdel_py.export.law_number import Number
from hysdel_py.export.law_points import replay_points
from hysdel_py.export.law_table import LawTable, Method
from hysdel_py.version import __version__

__all__ = ["LawCode", "labels", "law_to_c", "write_lines"]

_PROMISE = (
    "{0}_INSIDE and the move u of a point zeta of the map;",
    "{0}_OUTSIDE for every other point, also for one that is no number: u keeps what it holds.",
)
_AGAIN = (
    "The same, and *region, if it is the number of a region, is tried first; afterwards it holds the",
    "region of the point, -1 outside. A point on a border does not switch to and fro.",
)


@dataclass(frozen=True, slots=True)
class LawCode:
    """What was written.

    Attributes
    ----------
    files : tuple of Path
        Source and header.
    prefix : str
    number, method : str
    table_bytes : int
        Size of all constant tables.
    regions, laws, planes, tests, depth : int
        Regions of the law, distinct laws of the moves, hyperplanes, tests of the tree and the most on one way.
    open_leaves : int
        Leaves of the tree at which regions have to be tried, because the map has holes or notches there, or because the
        growth of the tree was limited.
    points : int
        Points of the self-test.
    reason : str
        Why this method was taken.
    """

    files: tuple[Path, ...]
    prefix: str
    number: str
    method: str
    table_bytes: int
    regions: int
    laws: int
    planes: int
    tests: int
    depth: int
    open_leaves: int
    points: int
    reason: str = ""


def law_to_c(
    law: ExplicitLaw,
    path: str | PathLike[str],
    *,
    number: str = "double",
    method: str = "auto",
    prefix: str | None = None,
    units: Sequence[str] = (),
    moves: Sequence[str] = (),
    points: int = 50,
    seed: int = 0,
) -> LawCode:
    """Write a law as C: a source that ends in .c, and a header beside it.

    Parameters
    ----------
    law : ExplicitLaw
    path : str or path
        Of the source.
    number : str
        ``"double"``, ``"float"``, ``"int32"`` or ``"int16"``. With the last two the code computes with integers:
        parameters and moves are integers too, and macros of the header hold their scale.
    method : str
        ``"tree"``: hyperplane tests lead to the law; ``"sequential"``: the regions are tried in turn, and a second
        function tries the region of the step before first. ``"auto"`` takes the tree if size times rows evaluated at a
        point is less, and otherwise the sequence; `LawCode.reason` has the figures.
    prefix : str, optional
        Of all names; by default the name of the file.
    units : sequence of str
        Of the parameters, for comments.
    moves : sequence of str
        Names of the moves, with units, for comments.
    points : int
        Points of the self-test, which is compiled where the macro ``PREFIX_SELF_TEST`` is defined.
    seed : int
        Of these points.

    Returns
    -------
    LawCode

    Raises
    ------
    ArgumentError
        An option is not one of these, the law has no regions, or its domain is unbounded.
    """
    source = source_path(path)
    header = source.with_suffix(".h")
    name = chosen_prefix(prefix, source)
    names = labels(law.names, units or _known_units(law), law.p, "units")
    move_names = labels(
        tuple(f"u{i}" for i in range(law.moves)), moves or _known_moves(law), law.moves, "moves", replaced=True
    )
    table, reason = chosen_table(law, Number.of(number), Method.of(method))
    replay = replay_points(law, table.scaling, points, seed)
    tables = c_tables(table)
    legend = [*_legend(law, table, tables.bytes), "", *_signals(table, names, move_names)]
    code = [*tables.lines, "", *evaluation(table, name), *self_test(table, name, replay)]
    write_lines(header, _header(table, name, legend))
    write_lines(source, [*comment([legend[0]]), *_includes(header), "", *code])
    return LawCode(
        (source, header), name, table.scaling.number.value, table.method.value, tables.bytes, law.count,
        len(table.maps), len(table.planes), len(table.tests), table.depth, len(table.leaves), len(replay.zeta),
        reason,
    )  # fmt: skip


def labels(
    names: tuple[str, ...], given: Sequence[str], count: int, what: str, *, replaced: bool = False
) -> tuple[str, ...]:
    """Names with units, or given labels in their place."""
    if not given:
        return names
    if isinstance(given, str) or len(given) != count:
        raise ArgumentError(f"{what} are {given!r}: {count} texts were expected")
    return tuple(given) if replaced else tuple(f"{n} [{u}]" if u else n for n, u in zip(names, given, strict=True))


def _known_units(law: ExplicitLaw) -> tuple[str, ...]:
    """Units of the parameters, where the law knows its signals."""
    if law.signals is None:
        return ()
    units = {v.name: v.unit for v in law.signals.x}
    units |= {last_input_name(v.name): v.unit for v in law.signals.u}
    return tuple(units.get(name, "") for name in law.names)


def _known_moves(law: ExplicitLaw) -> tuple[str, ...]:
    """Names of the moves with their units, where the law knows its signals."""
    signals = law.signals
    if signals is None or len(signals.u) != law.moves:
        return ()
    return tuple(f"increment of {v.label}" if signals.increment else v.label for v in signals.u)


def _legend(law: ExplicitLaw, table: LawTable, size: int) -> Iterator[str]:
    yield f"Explicit control law, written by hysdel_py {__version__}."
    yield ""
    complete = "" if law.complete else "; the map may be incomplete"
    yield f"{law.count} regions, {len(table.maps)} distinct laws, {len(table.planes)} hyperplanes{complete}."
    number = table.scaling.number.c_type
    how = f"search tree of {len(table.tests)} tests, {table.depth} deep" if table.tests else "regions one by one"
    if table.method is Method.TREE and not table.tests:
        how = "search tree without tests"
    yield f"Tables of {size} bytes in {number}; {how}."


def _signals(table: LawTable, names: Sequence[str], moves: Sequence[str]) -> Iterator[str]:
    scaling = table.scaling
    scales = [_scale(zero, step) for zero, step in zip(scaling.zero.tolist(), scaling.step.tolist(), strict=True)]
    units = [_scale(0.0, unit) for unit in scaling.unit.tolist()]
    for title, labels, texts in (("zeta", names, scales), ("u", moves, units)):
        for index, (label, text) in enumerate(zip(labels, texts, strict=True)):
            yield f"{title}[{index}]: {label}" + text * scaling.number.is_fixed


def _scale(zero: float, step: float) -> str:
    return f" = {zero:.9g} + {step:.9g} * raw" if zero else f" = {step:.9g} * raw"


def _header(table: LawTable, name: str, legend: Sequence[str]) -> Iterator[str]:
    upper, number = name.upper(), table.scaling.number
    yield from comment(legend)
    yield f"#ifndef {guard(name)}"
    yield f"#define {guard(name)}"
    if number.is_fixed:
        yield from ("", "#include <stdint.h>")
    yield ""
    yield f"#define {upper}_PARAMETERS {table.p}"
    yield f"#define {upper}_MOVES {table.moves}"
    yield f"#define {upper}_INSIDE 0"
    yield f"#define {upper}_OUTSIDE 1"
    if number.is_fixed:
        yield from _scales(table, upper)
    yield ""
    yield from comment(line.format(upper) for line in _PROMISE)
    yield f"{prototype(table, name)};"
    if table.method is Method.SEQUENTIAL:
        yield from comment(_AGAIN)
        yield f"{prototype(table, name, last=True)};"
    yield from ("", "#endif")


def _scales(table: LawTable, upper: str) -> Iterator[str]:
    scaling = table.scaling
    named = (("ZERO", scaling.zero), ("STEP", scaling.step), ("UNIT", scaling.unit))
    yield ""
    yield from comment(["Initialisers: parameter = ZERO + STEP * raw, move = UNIT * raw."])
    for title, values in named:
        yield f"#define {upper}_{title} {{{', '.join(map(float_text, values.tolist()))}}}"


def _includes(header: Path) -> Iterator[str]:
    yield f'#include "{header.name}"'
    yield "#include <stdint.h>"


def write_lines(path: Path, lines: Sequence[str] | Iterator[str]) -> None:
    """Write lines of a source."""
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
