"""Inner products and sums of vectors, over contiguous memory so that several entries are handled at once."""

from __future__ import annotations

from typing import Any

from hysdel_py.compiled import either, leaf, reordered

__all__ = ["add_multiple", "copy_to", "dot", "dot_from", "square"]


@reordered
def dot(a, b):
    """Inner product."""
    total = 0.0
    for i in range(len(a)):
        total += a[i] * b[i]
    return total


@reordered
def dot_from(a, b, first):
    """Inner product of the entries from `first` on."""
    total = 0.0
    for i in range(first, len(a)):
        total += a[i] * b[i]
    return total


@reordered
def square(a, first):
    """Squared length of the entries from `first` on."""
    total = 0.0
    for i in range(first, len(a)):
        total += a[i] * a[i]
    return total


def _copy_loop(target: Any, source: Any) -> None:
    for i in range(len(source)):
        target[i] = source[i]


def _copy_array(target: Any, source: Any) -> None:
    target[: len(source)] = source


copy_to = either(_copy_loop, _copy_array, leaf)
"""Write a vector over the first entries of another one.

numba's own assignment to a slice comes with a message for arrays that do not fit, which takes longer to compile than
any kernel here.
"""


@leaf
def add_multiple(target, factor, a):
    """Add ``factor * a`` to the first entries of `target`."""
    for i in range(len(a)):
        target[i] += factor * a[i]
