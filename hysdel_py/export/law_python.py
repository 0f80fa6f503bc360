"""An explicit law as a Python file of its own that needs nothing but Python."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.export.law_choice import chosen_table
from hysdel_py.export.law_number import Number
from hysdel_py.export.law_table import LawTable, Method
from hysdel_py.version import __version__

__all__ = ["LAW_HEAD", "law_to_python", "listed"]

LAW_HEAD = '''

def law(zeta):
    """Move at a point, as a list; None outside the map."""
    if isinstance(zeta, dict):
        if set(zeta) != set(PARAMETERS):
            raise ValueError(f"the parameters are {', '.join(PARAMETERS)}: got {', '.join(map(str, zeta))}")
        zeta = [zeta[name] for name in PARAMETERS]
    point = [float(number) for number in zeta]
    if len(point) != len(PARAMETERS):
        raise ValueError(f"zeta has {len(point)} entries: {len(PARAMETERS)} were expected ({', '.join(PARAMETERS)})")
    found = _locate(point)
    return None if found is None else [_value(row, found[1]) for row in _MAPS[found[0]]]


def _value(row, point):
    total = row[-1]
    for coefficient, number in zip(row, point):
        total += coefficient * number
    return total


def _holds(row, point):
    value = _value(_PLANES[abs(row) - 1], point)
    return (value if row > 0 else -value) <= _TOLERANCE

'''
"""Text of ``law(zeta)``, which asks ``_locate`` for the number of a map and the point for it."""

_AMONG = """
def _among(regions, point):
    for region in regions:
        if all(_holds(row, point) for row in _REGIONS[region]):
            return _REGION_MAPS[region]
    return None

"""
_TREE = """
def _locate(point):
    if not all(_holds(row, point) for row in _HULL):
        return None
    node = _ROOT
    while node >= 0:
        plane, first, second = _TESTS[node]
        node = second if _value(_PLANES[plane], point) > 0 else first
    if node == -1:
        return None
    number = -2 - node
    if number >= len(_MAPS):
        number = _among(_LEAVES[number - len(_MAPS)], point)
    return None if number is None else (number, point)
"""
_SEQUENTIAL = """
def _locate(point):
    number = _among(range(len(_REGIONS)), point)
    return None if number is None else (number, point)
"""


def law_to_python(law: ExplicitLaw, path: str | PathLike[str], *, method: str = "auto") -> Path:
    """Write a law as a module with ``law(zeta)``; see :meth:`ExplicitLaw.to_python`."""
    table, _ = chosen_table(law, Number.DOUBLE, Method.of(method))
    target = Path(path)
    target.write_text("\n".join(_lines(law, table)), encoding="utf-8", newline="\n")
    return target


def _lines(law: ExplicitLaw, table: LawTable) -> Iterator[str]:
    yield f'"""Explicit control law of {law.count} regions, written by hysdel_py {__version__}; needs only Python."""'
    yield ""
    yield f"PARAMETERS = {law.names!r}"
    yield f"_TOLERANCE = {table.tolerance!r}"
    yield f"_ROOT = {table.root}"
    yield from listed("_PLANES", table.planes.tolist())
    yield from listed("_MAPS", table.maps.tolist())
    for name in ("tests", "hull", "leaves", "regions", "region_maps"):
        yield from listed(f"_{name.upper()}", getattr(table, name))
    yield (LAW_HEAD + _AMONG + (_TREE if table.method is Method.TREE else _SEQUENTIAL)).rstrip("\n")
    yield ""


def listed(name: str, rows: Sequence[Any]) -> Iterator[str]:
    """A list, one entry a line."""
    yield f"{name} = ["
    yield from (f"    {row!r}," for row in rows)
    yield "]"
