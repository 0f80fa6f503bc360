"""The MLD form as the MATLAB file that the original compiler writes.

The script makes one struct ``S`` with the fields that users of the original read: blocks and matrices, sizes, ranges,
and unless refused a table of all names and the origin of each row.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from hysdel_py.export.compiled import Compiled, needed_ranges
from hysdel_py.export.matlab_text import NumberStyle, matrix, parameter_is_missing, quoted, value_text
from hysdel_py.export.matrices import dense
from hysdel_py.export.row_info import row_info
from hysdel_py.export.symbol_table import symbol_table
from hysdel_py.lowering.constants import Constants
from hysdel_py.systems.signals import Variable
from hysdel_py.systems.symbolic_mld import SymbolicMld
from hysdel_py.version import __version__

__all__ = ["MatlabOptions", "matlab_text", "parameter_checks"]

Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class MatlabOptions:
    """What the file holds beside the matrices.

    Attributes
    ----------
    symbol_table, row_info : bool
        Whether names and origins of rows are told.
    parameter_checks : bool
        Whether the file checks that it finds the parameters without value.
    maple : bool
        Whether min and max of expressions go through ``maple``.
    """

    symbol_table: bool = True
    row_info: bool = True
    parameter_checks: bool = True
    maple: bool = False

    @property
    def style(self) -> NumberStyle:
        """How numbers are written."""
        return NumberStyle(self.maple)


def matlab_text(compiled: Compiled, options: MatlabOptions) -> str:
    """Text of the file; the constant columns B5 and D5 are in it if the model was lowered with them."""
    lines = [
        *_header(compiled, options),
        *_matrices(compiled, options.style),
        *(_rows(compiled, options.style) if options.row_info else ["S.rowinfo = [];"]),
        f"S.ne = {len(compiled.mld.rows)};",
        *(_symbols(compiled, options.style) if options.symbol_table else ["S.symtable = [];"]),
        *_sizes(compiled),
        *_ranges(compiled, options.style),
    ]
    return "\n".join(lines) + "\n"


def parameter_checks(names: Sequence[str]) -> Iterator[str]:
    """Lines that stop with a message unless the struct ``params`` has these fields."""
    if names:
        yield "if ~exist('params', 'var'), error('the struct params with the values of the parameters is missing'); end"
    for name in names:
        yield f"if {parameter_is_missing(name)}, error('the value params.{name} is missing'); end"


def _header(compiled: Compiled, options: MatlabOptions) -> Iterator[str]:
    mld = compiled.mld
    yield f"% MLD form of {mld.name}, written by hysdel_py {__version__}"
    yield "% x+ = A x + B1 u + B2 d + B3 z + B5;  y = C x + D1 u + D2 d + D3 z + D5;"
    yield "% E2 d + E3 z <= E1 u + E4 x + E5"
    if options.parameter_checks and isinstance(mld, SymbolicMld):
        yield from parameter_checks(mld.parameters)
    yield f"S.name = {quoted(mld.name)};"
    yield "S.MLDisvalid = 1;"
    yield "S.MLDstructver = 2;"
    yield f"S.MLDsymtable = {int(options.symbol_table)};"
    yield f"S.MLDrowinfo = {int(options.row_info)};"


def _matrices(compiled: Compiled, style: NumberStyle) -> Iterator[str]:
    mld = compiled.mld
    affine = compiled.constants is Constants.AFFINE
    for letters, constant, rows in (("ABBB", "B5", mld.x), ("CDDD", "D5", mld.y)):
        names = [letter + digit for letter, digit in zip(letters, ("", "1", "2", "3"), strict=True)]
        for name, columns in zip(names, (mld.x, mld.u, mld.d, mld.z), strict=True):
            yield from _blocks(name, dense(mld, name), _reals(rows), _column_types(name, columns), style)
        if affine:
            yield matrix(f"S.{constant}", dense(mld, constant)[:, None], style)
    for name in ("E1", "E2", "E3", "E4", "E5"):
        entries = getattr(mld, name)
        yield matrix(f"S.{name}", entries[:, None] if entries.ndim == 1 else entries, style)
    for name in ("A", "B1", "C", "D1"):
        yield f"S.{name} = [S.{name}rr, S.{name}rb; S.{name}br, S.{name}bb];"
    for name in ("B2", "D2"):
        yield f"S.{name} = [S.{name}rb; S.{name}bb];"
    for name in ("B3", "D3"):
        yield f"S.{name} = [S.{name}rr; S.{name}br];"


def _reals(group: Sequence[Variable]) -> int:
    return sum(not v.is_bool for v in group)


def _column_types(name: str, columns: Sequence[Variable]) -> Mapping[str, slice]:
    """Columns of each type; d is Boolean and z real as a whole."""
    if name[1:] in ("2", "3"):
        return {"b" if name[1:] == "2" else "r": slice(None)}
    reals = _reals(columns)
    return {"r": slice(0, reals), "b": slice(reals, None)}


def _blocks(
    name: str, entries: NDArray[Any], reals: int, columns: Mapping[str, slice], style: NumberStyle
) -> Iterator[str]:
    for row_type, rows in (("r", slice(0, reals)), ("b", slice(reals, None))):
        for column_type, part in columns.items():
            yield matrix(f"S.{name}{row_type}{column_type}", entries[rows, part], style)
    yield ""


def _rows(compiled: Compiled, style: NumberStyle) -> Iterator[str]:
    for key in ("state_upd", "output", "ineq"):
        yield f"S.rowinfo.{key} = {{}};"
    for key, number, fields in row_info(compiled, style):
        for field, value in fields.items():
            yield f"S.rowinfo.{key}{{{number}}}.{field} = {value_text(value, style)};"


def _symbols(compiled: Compiled, style: NumberStyle) -> Iterator[str]:
    for number, fields in enumerate(symbol_table(compiled), start=1):
        for field, value in fields.items():
            yield f"S.symtable{{{number}}}.{field} = {value_text(value, style)};"


def _sizes(compiled: Compiled) -> Iterator[str]:
    mld = compiled.mld
    for key, group in (("x", mld.x), ("u", mld.u), ("y", mld.y)):
        yield f"S.n{key}r = {_reals(group)};"
        yield f"S.n{key}b = {len(group) - _reals(group)};"
        yield f"S.n{key} = {len(group)};"
    yield f"S.nd = {len(mld.d)};"
    yield f"S.nz = {len(mld.z)};"


def _ranges(compiled: Compiled, style: NumberStyle) -> Iterator[str]:
    mld = compiled.mld
    groups = {"u": mld.u, "x": mld.x, "y": mld.y, "d": mld.d, "z": mld.z}
    for key in groups:
        yield f"S.{key}l = -inf * ones(S.n{key}, 1);"
        yield f"S.{key}u = +inf * ones(S.n{key}, 1);"
    known = needed_ranges(compiled.dha)
    for key, group in groups.items():
        for number, variable in enumerate(group, start=1):
            yield from _range(key, number, _written_range(key, variable, known), style)


def _written_range(key: str, variable: Variable, known: Mapping[str, Range]) -> Range | None:
    """Range that the original writes: none for outputs and generated names; one that an output declares is written."""
    if variable.generated or (key == "y" and variable.is_bool):
        return None
    return known.get(variable.name)


def _range(key: str, number: int, ends: Range | None, style: NumberStyle) -> Iterator[str]:
    for letter, end in zip("lu", ends or (), strict=False):
        if not math.isinf(end):
            yield f"S.{key}{letter}({number}) = {style.number(end)};"
