"""Names of elements and of variables in modules, such as ``W(2,1)`` and ``t1.level``, as identifiers."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

__all__ = ["element_of", "identifiers"]

_OTHER = re.compile(r"[^A-Za-z0-9_]+")
_ELEMENT = re.compile(r"([^()]+)\((\d+(?:,\d+)?)\)")


def identifiers(names: Iterable[str], taken: Callable[[str], bool] = lambda _: False) -> dict[str, str]:
    """An identifier for each name, no two alike; names that are identifiers and not taken stay as they are.

    Parameters
    ----------
    names : iterable of str
    taken : callable
        Whether an identifier stands for something else; such ones get underscores at the end.

    Examples
    --------
    >>> identifiers(["W(2,1)", "t1.level", "W_2_1"])
    {'W(2,1)': 'W_2_1_', 't1.level': 't1_level', 'W_2_1': 'W_2_1'}
    """
    names = list(names)
    used = {name for name in names if not _OTHER.search(name)}
    found = {}
    for name in names:
        free = _OTHER.sub("_", name.rstrip(")"))
        while taken(free) or (free != name and free in used):
            free += "_"
        used.add(free)
        found[name] = free
    return found


def element_of(name: str) -> tuple[str, tuple[int, ...]]:
    """Vector or matrix and indices of an element; the name and no indices for anything else.

    Examples
    --------
    >>> element_of("t1.W(2,1)")
    ('t1.W', (2, 1))
    """
    match = _ELEMENT.fullmatch(name)
    return (match[1], tuple(map(int, match[2].split(",")))) if match else (name, ())
