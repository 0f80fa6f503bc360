"""An explicit hybrid law as a Python file of its own that needs nothing but Python."""

from __future__ import annotations

from collections.abc import Iterator
from os import PathLike
from pathlib import Path

from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.export.hybrid_table import HybridTable, hybrid_table
from hysdel_py.export.law_number import Number
from hysdel_py.export.law_python import LAW_HEAD, listed
from hysdel_py.version import __version__

__all__ = ["hybrid_to_python"]

_CODE = """
def _locate(zeta):
    if any(zeta[place] not in (0.0, 1.0) for place in _BOOLEAN):
        return None
    word = sum(int(zeta[place]) << bit for bit, place in enumerate(_BOOLEAN))
    if word not in _WORDS:
        return None
    group = _WORDS.index(word)
    point = [zeta[place] for place in _REAL]
    chosen, least = None, None
    for region in range(_STARTS[group], _STARTS[group + 1]):
        if all(_holds(row, point) for row in _REGIONS[region]):
            if not _VALUES:
                return _REGION_MAPS[region], point
            found = _cost(_VALUES[_REGION_VALUES[region]], point)
            if chosen is None or found < least - _TIE * max(1.0, abs(least)):
                chosen, least = region, found
    return None if chosen is None else (_REGION_MAPS[chosen], point)


def _cost(row, point):
    size = len(point)
    total = row[-1]
    for coefficient, number in zip(row[-1 - size :], point):
        total += coefficient * number
    products = (point[i] * point[j] for i in range(size) for j in range(i, size))
    for coefficient, number in zip(row[: -1 - size], products):
        total += coefficient * number
    return total
"""


def hybrid_to_python(law: HybridLaw, path: str | PathLike[str]) -> Path:
    """Write a law as a module with ``law(zeta)``; see :meth:`HybridLaw.to_python`."""
    table = hybrid_table(law, Number.DOUBLE)
    target = Path(path)
    target.write_text("\n".join(_lines(law, table)), encoding="utf-8", newline="\n")
    return target


def _lines(law: HybridLaw, table: HybridTable) -> Iterator[str]:
    yield f'"""Explicit law of a hybrid controller, written by hysdel_py {__version__}; needs only Python."""'
    yield ""
    yield f"PARAMETERS = {law.names!r}"
    yield f"_TOLERANCE = {table.table.tolerance!r}"
    yield f"_TIE = {table.tie!r}"
    for name in ("real", "boolean", "words", "starts"):
        yield f"_{name.upper()} = {getattr(table, name)!r}"
    yield from listed("_PLANES", table.table.planes.tolist())
    yield from listed("_MAPS", table.table.maps.tolist())
    yield from listed("_REGIONS", table.table.regions)
    yield from listed("_REGION_MAPS", table.table.region_maps)
    yield from listed("_VALUES", table.values.tolist())
    yield from listed("_REGION_VALUES", table.region_value)
    yield (LAW_HEAD + _CODE).rstrip("\n")
    yield ""
