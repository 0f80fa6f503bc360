"""Inner products and sums of vectors, over contiguous memory so that several entries are handled at once."""

from __future__ import annotations

from hysdel_py.optimize.compiled import leaf, reordered

__all__ = ["add_multiple", "dot", "dot_from", "square"]


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


@leaf
def add_multiple(target, factor, a):
    """Add ``factor * a`` to the first entries of `target`."""
    for i in range(len(a)):
        target[i] += factor * a[i]
