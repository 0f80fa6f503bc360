"""Innermost steps of the kernels over small dense arrays, in place.

Each step is there twice with one meaning: as loops for the compiler, and as array operations for plain Python.
Tests compare the two.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import compiled, either

__all__ = [
    "back_substituted",
    "blend",
    "differs",
    "doubled",
    "first_hit",
    "greatest",
    "move",
    "reflect",
    "rotate",
    "row_lengths",
    "solve_lower",
    "solve_upper",
    "turned",
    "worst_row",
]


def _worst_row_loops(N: Any, h: Any, m: int, x: Any) -> Any:
    n, row, most = len(x), -1, -np.inf
    for i in range(m):
        excess = -h[i]
        for j in range(n):
            excess += N[i, j] * x[j]
        if excess > most:
            row, most = i, excess
    return row, most


def _worst_row_arrays(N: Any, h: Any, m: int, x: Any) -> Any:
    if not m:
        return -1, -np.inf
    excess = N[:m] @ x - h[:m]
    row = int(excess.argmax())
    return row, float(excess[row])


worst_row = either(_worst_row_loops, _worst_row_arrays)
"""Row of ``N x <= h`` among the first m that is exceeded most, and by how much; -1 without rows."""


def _turned_loops(Qt: Any, a: Any, k: int, d: Any) -> float:
    n, rest = len(a), 0.0
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += Qt[i, j] * a[j]
        d[i] = total
        if i >= k:
            rest += total * total
    return rest


def _turned_arrays(Qt: Any, a: Any, k: int, d: Any) -> float:
    np.dot(Qt, a, d[: len(a)])
    rest = d[k : len(a)]
    return float(rest @ rest)


turned = either(_turned_loops, _turned_arrays)
"""``d = Qt a``; returns the squared length of ``d[k:]``."""


def _back_substituted_loops(R: Any, d: Any, k: int, r: Any) -> None:
    for i in range(k - 1, -1, -1):
        total = d[i]
        for j in range(i + 1, k):
            total -= R[i, j] * r[j]
        r[i] = total / R[i, i]


def _back_substituted_arrays(R: Any, d: Any, k: int, r: Any) -> None:
    for i in range(k - 1, -1, -1):
        r[i] = (d[i] - R[i, i + 1 : k] @ r[i + 1 : k]) / R[i, i]


back_substituted = either(_back_substituted_loops, _back_substituted_arrays)
"""``r[:k] = R^-1 d[:k]`` for the leading block of an upper triangle."""


def _move_loops(x: Any, Qt: Any, d: Any, k: int, length: float) -> None:
    n = len(x)
    for i in range(k, n):
        share = length * d[i]
        for j in range(n):
            x[j] -= share * Qt[i, j]


def _move_arrays(x: Any, Qt: Any, d: Any, k: int, length: float) -> None:
    x -= length * (d[k : len(x)] @ Qt[k:])


move = either(_move_loops, _move_arrays)
"""``x -= length Qt[k:]' d[k:]``."""


def _reflect_loops(Qt: Any, v: Any, k: int, weight: float) -> None:
    n = Qt.shape[1]
    for j in range(n):
        total = 0.0
        for i in range(k, n):
            total += v[i] * Qt[i, j]
        total *= weight
        for i in range(k, n):
            Qt[i, j] -= v[i] * total


def _reflect_arrays(Qt: Any, v: Any, k: int, weight: float) -> None:
    tail = v[k : Qt.shape[1]]
    Qt[k:] -= np.outer(tail, weight * (tail @ Qt[k:]))


reflect = either(_reflect_loops, _reflect_arrays)
"""``Qt[k:] -= weight v (v'Qt[k:])`` with ``v[k:]``."""


def _rotate_loops(A: Any, row: int, first: int, last: int, cosine: float, sine: float) -> None:
    for j in range(first, last):
        upper, lower = A[row, j], A[row + 1, j]
        A[row, j] = cosine * upper + sine * lower
        A[row + 1, j] = cosine * lower - sine * upper


def _rotate_arrays(A: Any, row: int, first: int, last: int, cosine: float, sine: float) -> None:
    upper, lower = A[row, first:last].copy(), A[row + 1, first:last].copy()
    A[row, first:last] = cosine * upper + sine * lower
    A[row + 1, first:last] = cosine * lower - sine * upper


rotate = either(_rotate_loops, _rotate_arrays)
"""Plane rotation of two neighbouring rows between two columns."""


def _first_hit_loops(N: Any, slack: Any, m: int, direction: Any, margin: float, speed: Any) -> int:
    n, hit, fastest = len(direction), -1, 0.0
    for i in range(m):
        total = 0.0
        for j in range(n):
            total += N[i, j] * direction[j]
        speed[i] = total
        if total > fastest * slack[i]:
            hit, fastest = i, total / slack[i]
    if hit < 0:
        return -1
    for i in range(m):
        if i != hit and slack[i] - speed[i] / fastest <= margin:
            return -1
    return hit


def _first_hit_arrays(N: Any, slack: Any, m: int, direction: Any, margin: float, speed: Any) -> int:
    speed[:m] = N[:m] @ direction
    rate = speed[:m] / slack[:m]
    hit = int(rate.argmax())
    if rate[hit] <= 0:
        return -1
    left = slack[:m] - speed[:m] / rate[hit]
    left[hit] = np.inf
    return hit if left.min() > margin else -1


first_hit = either(_first_hit_loops, _first_hit_arrays)
"""Row that a ray from a point with these slacks meets first; -1 if another one is closer than the margin there."""


def _solve_upper_loops(R: Any, k: int, x: Any) -> None:
    for column in range(x.shape[1]):
        for row in range(k - 1, -1, -1):
            total = x[row, column]
            for later in range(row + 1, k):
                total -= R[row, later] * x[later, column]
            x[row, column] = total / R[row, row]


def _solve_upper_arrays(R: Any, k: int, x: Any) -> None:
    for row in range(k - 1, -1, -1):
        x[row] = (x[row] - R[row, row + 1 : k] @ x[row + 1 : k]) / R[row, row]


solve_upper = either(_solve_upper_loops, _solve_upper_arrays)
"""``x = R^-1 x`` in place, column by column, for the leading block of size k."""


def _solve_lower_loops(R: Any, k: int, x: Any) -> None:
    for column in range(x.shape[1]):
        for row in range(k):
            total = x[row, column]
            for earlier in range(row):
                total -= R[earlier, row] * x[earlier, column]
            x[row, column] = total / R[row, row]


def _solve_lower_arrays(R: Any, k: int, x: Any) -> None:
    for row in range(k):
        x[row] = (x[row] - R[:row, row] @ x[:row]) / R[row, row]


solve_lower = either(_solve_lower_loops, _solve_lower_arrays)
"""``x = R'^-1 x`` in place."""


def _blend_loops(weights: Any, A: Any, out: Any, sign: float) -> None:
    for i in range(weights.shape[1]):
        for j in range(A.shape[1]):
            total = 0.0
            for k in range(len(A)):
                total += weights[k, i] * A[k, j]
            out[i, j] += sign * total


def _blend_arrays(weights: Any, A: Any, out: Any, sign: float) -> None:
    out += sign * (weights.T @ A)


blend = either(_blend_loops, _blend_arrays)
"""``out += sign weights'A``."""


def _differs_loops(N: Any, row: int, other: int, tolerance: float) -> bool:
    most = 0.0
    for j in range(N.shape[1]):
        most = max(most, abs(N[row, j] - N[other, j]))
    return most > tolerance


def _differs_arrays(N: Any, row: int, other: int, tolerance: float) -> bool:
    return bool(np.abs(N[row] - N[other]).max(initial=0.0) > tolerance)


differs = either(_differs_loops, _differs_arrays)
"""Whether two rows differ by more than a tolerance."""


def _greatest_loops(A: Any) -> float:
    most = 0.0
    for entry in A.flat:
        most = max(most, abs(entry))
    return most


def _greatest_arrays(A: Any) -> float:
    return float(np.abs(A).max(initial=0.0))


greatest = either(_greatest_loops, _greatest_arrays)
"""Greatest absolute value; zero of nothing."""


def _row_lengths_loops(lines: Any, p: int) -> Any:
    lengths = np.empty(len(lines))
    for row in range(len(lines)):
        total = 0.0
        for i in range(1, 1 + p):
            total += lines[row, i] * lines[row, i]
        lengths[row] = np.sqrt(total)
    return lengths


def _row_lengths_arrays(lines: Any, p: int) -> Any:
    normals = lines[:, 1 : 1 + p]
    return np.sqrt((normals * normals).sum(axis=1))


row_lengths = either(_row_lengths_loops, _row_lengths_arrays)
"""Lengths of the coefficients of p parameters in each affine function."""


@compiled
def doubled(array: Any, count: int) -> Any:
    """The array, or one of twice the length with the same beginning if it has no room for entry number `count`."""
    if count < len(array):
        return array
    larger = np.zeros((2 * count + 8,) + array.shape[1:], array.dtype)  # noqa: RUF005  numba has no unpacking here
    larger[: len(array)] = array
    return larger
