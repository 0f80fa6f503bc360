"""Active sets in the order in which they were met, each once; a hash table finds them again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.compiled import compiled
from hysdel_py.optimize.parametric.vectors import doubled

__all__ = ["Frontier", "find"]

_ROOM = 64

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(slots=True)
class Frontier:
    """Queue and hash table in one.

    Attributes
    ----------
    table : int array, its length a power of two
        Numbers of sets, -1 where free.
    sets : int array of shape (room, n)
        Ascending, padded with -1.
    guesses : array of shape (room, p)
        A point near the region of each set.
    count : int
        Sets met so far.
    """

    table: Numbers
    sets: Numbers
    guesses: Matrix
    count: int = 0

    @classmethod
    def empty(cls, n: int, p: int) -> Frontier:
        """Without any set of up to n rows."""
        return cls(np.full(2 * _ROOM, -1), np.empty((_ROOM, n), dtype=np.int64), np.empty((_ROOM, p)))

    def add(self, sets: Numbers, guesses: Matrix) -> Numbers:
        """Numbers of the given sets; those not met before are appended in order."""
        table, sets, guesses, count, numbers = _add(self.table, self.sets, self.guesses, self.count, sets, guesses)
        self.table, self.sets, self.guesses, self.count = table, sets, guesses, count
        return numbers  # type: ignore[no-any-return]

    def row(self, active: tuple[int, ...]) -> Numbers:
        """An active set as a row of `sets`."""
        row = np.full(self.sets.shape[1], -1)
        row[: len(active)] = active
        return row


@compiled
def find(table: Any, sets: Any, row: Any) -> int:
    """Number of a set, -1 if it has not been met."""
    return int(table[_place(table, sets, row)])


@compiled
def _add(table: Any, sets: Any, guesses: Any, count: int, new: Any, points: Any) -> Any:
    numbers = np.empty(len(new), dtype=np.int64)
    for number in range(len(new)):
        if 2 * count >= len(table):
            table = _enlarged(table, sets, count)
        place = _place(table, sets, new[number])
        if table[place] < 0:
            table[place] = count
            sets, guesses = doubled(sets, count), doubled(guesses, count)
            sets[count], guesses[count] = new[number], points[number]
            count += 1
        numbers[number] = table[place]
    return table, sets, guesses, count, numbers


@compiled
def _enlarged(table: Any, sets: Any, count: int) -> Any:
    larger = np.full(2 * len(table), -1)
    for number in range(count):
        larger[_place(larger, sets, sets[number])] = number
    return larger


@compiled
def _place(table: Any, sets: Any, row: Any) -> int:
    """Where a set is in the table, or the free place where it belongs."""
    code = 17
    for entry in row:
        code = (code * 1000003 + entry + 2) % 2147483647
    place = code % len(table)
    while table[place] >= 0 and _differ(sets, table[place], row):
        place = (place + 1) % len(table)
    return int(place)


@compiled
def _differ(sets: Any, number: int, row: Any) -> bool:
    place = 0
    while place < len(row) and sets[number, place] == row[place]:
        place += 1
    return place < len(row)
