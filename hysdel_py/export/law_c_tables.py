"""The tables of an explicit law in C, and how many bytes they take."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate

from hysdel_py.export.c_text import array, index_type, number_text
from hysdel_py.export.law_table import LawTable

__all__ = ["CTables", "c_tables", "combined", "integers_table", "numbers_table"]


@dataclass(frozen=True, slots=True)
class CTables:
    """Text and size of tables; those without entries are left out.

    Attributes
    ----------
    lines : tuple of str
    bytes : int
    """

    lines: tuple[str, ...]
    bytes: int


def c_tables(table: LawTable) -> CTables:
    """All tables of a law."""
    number = table.scaling.number
    parts = [
        numbers_table("planes", f"[{table.p + 1}]", table.planes.tolist(), number.c_type, number.bytes),
        numbers_table("maps", f"[{table.moves * (table.p + 1)}]", table.maps.reshape(len(table.maps), -1).tolist(),
                 number.c_type, number.bytes),
        integers_table("test_plane", "", [test[0] for test in table.tests]),
        integers_table("test_child", "[2]", [child for test in table.tests for child in test[1:]]),
        integers_table("hull", "", table.hull),
        *_lists("region", table.regions),
        integers_table("region_map", "", table.region_maps),
        *_lists("leaf", table.leaves),
    ]  # fmt: skip
    return combined(parts)


def combined(parts: Iterable[CTables | None]) -> CTables:
    """Tables behind each other."""
    found = [part for part in parts if part is not None]
    return CTables(
        tuple(line for part in found for line in part.lines),
        sum(part.bytes for part in found),
    )


def numbers_table(name: str, width: str, rows: Sequence[Sequence[float]], c_type: str, size: int) -> CTables | None:
    """A table of rows of numbers that take so many bytes each."""
    texts = ["{" + ", ".join(number_text(value, c_type) for value in row) + "}" for row in rows]
    return _table(f"{c_type} {name}[{len(rows)}]{width}", texts, size * sum(map(len, rows)))


def integers_table(name: str, width: str, values: Iterable[int]) -> CTables | None:
    """A table of integers, of the smallest type that holds them."""
    numbers = list(values)
    c_type, size = index_type(numbers)
    texts = list(map(str, numbers))
    if width == "[2]":
        texts = [f"{{{first}, {second}}}" for first, second in zip(texts[::2], texts[1::2], strict=True)]
    return _table(f"{c_type} {name}[{len(texts)}]{width}", texts, size * len(numbers))


def _lists(name: str, lists: Sequence[Sequence[int]]) -> tuple[CTables | None, CTables | None]:
    """Lists behind each other, and where each begins."""
    if not lists:
        return None, None
    starts = list(accumulate(map(len, lists), initial=0))
    entries = (i for part in lists for i in part)
    return integers_table(f"{name}_start", "", starts), integers_table(f"{name}_list", "", entries)


def _table(declaration: str, texts: Sequence[str], size: int) -> CTables | None:
    return CTables(tuple(array(declaration, texts)), size) if texts else None
