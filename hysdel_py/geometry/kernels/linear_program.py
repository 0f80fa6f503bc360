"""A dual simplex method for linear programs in few variables.

``maximise c'w  subject to  G w <= h,  lb <= w <= ub``

A basis holds n constraints that meet in one point: rows and ends of variables. It starts with the ends that suit the
costs, where the multipliers have the right sign, and keeps that sign: the row that the point exceeds most enters, the
one whose multiplier reaches zero first leaves (C. E. Lemke, "The dual method of solving the linear programming
problem", Naval Research Logistics Quarterly 1, 1954). A missing end lies at M, greater than any number: points and
sides have a finite part and one that counts M, hence unbounded programs need no guess of how large is large.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import either, leaf

__all__ = ["INFEASIBLE", "OPTIMAL", "UNBOUNDED", "UNKNOWN", "product", "solved"]

OPTIMAL, INFEASIBLE, UNBOUNDED, UNKNOWN = 0, 1, 2, 3

_EXCEEDED = 1e-12
"""Rows exceeded by less than this, relative to the size of their terms, are fulfilled."""
_PIVOT = 1e-9
"""Least share of a leaving constraint in the normal of the entering one."""
_PRICE = 1e-12
_NO_PRICE = 1e-10
_CLEARLY = 1e-9
"""A program is infeasible if its multipliers, with the sum 1, prove an excess of this at least."""


def _worst_row_loops(G: Any, h: Any, m: int, near: Any, far: Any, is_far: bool) -> int:
    n = G.shape[1]
    size = 1.0
    for j in range(n):
        size = max(size, abs(near[j]))
    row, most = -1, 0.0
    if is_far:
        most = _EXCEEDED
        for i in range(m):
            speed = 0.0
            for j in range(n):
                speed += G[i, j] * far[j]
            if speed > most:
                row, most = i, speed
        if row >= 0:
            return row
    most = 0.0
    for i in range(m):
        excess = -h[i] - _EXCEEDED * max(size, abs(h[i]))
        for j in range(n):
            excess += G[i, j] * near[j]
        if excess > most:
            speed = 0.0
            if is_far:
                for j in range(n):
                    speed += G[i, j] * far[j]
            if speed >= -_EXCEEDED:
                row, most = i, excess
    return row


def _worst_row_arrays(G: Any, h: Any, m: int, near: Any, far: Any, is_far: bool) -> int:
    if not m:
        return -1
    G, h = G[:m], h[:m]
    size = max(1.0, float(np.abs(near).max()))
    excess = G @ near - h - _EXCEEDED * np.maximum(size, np.abs(h))
    if is_far:
        speed = G @ far
        row = int(speed.argmax())
        if speed[row] > _EXCEEDED:
            return row
        excess[speed < -_EXCEEDED] = -1.0
    row = int(excess.argmax())
    return row if excess[row] > 0.0 else -1


worst_row = either(_worst_row_loops, _worst_row_arrays, leaf)
"""The row that a point ``near + M far`` exceeds most; -1 if it exceeds none."""


@leaf
def _worst_end(lb: Any, ub: Any, near: Any, far: Any, m: int) -> int:
    """The end of a variable that a point exceeds most, by its number among the constraints; -1 if it exceeds none."""
    n, worst, most_near, most_far = len(lb), -1, 0.0, 0.0
    for j in range(2 * n):
        k = j if j < n else j - n
        sign, end = (1.0, ub[k]) if j < n else (-1.0, -lb[k])
        over_far, over = sign * far[k], sign * near[k]
        if end == np.inf:
            over_far -= 1.0
        else:
            over -= end + _EXCEEDED * max(1.0, abs(end))
        if abs(over_far) <= _EXCEEDED:
            over_far = 0.0
        if over_far > most_far or (over_far == most_far and over > most_near and (over_far > 0.0 or over > 0.0)):
            worst, most_near, most_far = m + j, over, over_far
    return worst


@leaf
def _normal_of(constraint: int, G: Any, m: int, normal: Any) -> None:
    """Normal of a constraint: a row, or plus or minus a unit vector for an upper or a lower end."""
    n = G.shape[1]
    if constraint < m:
        for j in range(n):
            normal[j] = G[constraint, j]
        return
    for j in range(n):
        normal[j] = 0.0
    k = constraint - m
    if k < n:
        normal[k] = 1.0
    else:
        normal[k - n] = -1.0


@leaf
def _side_of(constraint: int, h: Any, m: int, lb: Any, ub: Any) -> tuple[float, float]:
    """Side of a constraint, finite and in terms of M."""
    n = len(lb)
    if constraint < m:
        return h[constraint], 0.0
    k = constraint - m
    end = ub[k] if k < n else -lb[k - n]
    return (0.0, 1.0) if end == np.inf else (end, 0.0)


@leaf
def _leaving(price: Any, share: Any) -> int:
    """The constraint whose multiplier reaches zero first; of those that nearly do the one that enters most."""
    least = np.inf
    for k in range(len(price)):
        if share[k] > _PIVOT:
            least = min(least, (price[k] + _PRICE) / share[k])
    leaves, most = -1, 0.0
    for k in range(len(price)):
        if share[k] > max(_PIVOT, most) and price[k] / share[k] <= least:
            leaves, most = k, share[k]
    return leaves


@leaf
def _exchanged(inverse: Any, price: Any, share: Any, leaves: int) -> None:
    """A new row takes the place of a constraint in the basis: its inverse and the multipliers follow."""
    n = len(price)
    step = max(price[leaves], 0.0) / share[leaves]
    for k in range(n):
        price[k] = max(price[k] - step * share[k], 0.0)
    price[leaves] = step
    for i in range(n):
        pivot = inverse[i, leaves] / share[leaves]
        for k in range(n):
            inverse[i, k] -= pivot * share[k]
        inverse[i, leaves] = pivot


@leaf
def _placed(inverse: Any, basis: Any, h: Any, m: int, lb: Any, ub: Any, near: Any, far: Any) -> bool:
    """The point in which the constraints of the basis meet; whether it depends on M."""
    n = len(basis)
    for i in range(n):
        near[i] = far[i] = 0.0
    is_far = False
    for k in range(n):
        side, side_far = _side_of(basis[k], h, m, lb, ub)
        for i in range(n):
            near[i] += inverse[i, k] * side
        if side_far > 0.0:
            for i in range(n):
                far[i] += inverse[i, k]
            is_far = True
    return is_far


@leaf
def _refined(
    inverse: Any, basis: Any, G: Any, h: Any, m: int, lb: Any, ub: Any, near: Any, normal: Any, rest: Any
) -> None:
    """One step against the rounding errors of the point."""
    n = len(basis)
    for k in range(n):
        _normal_of(basis[k], G, m, normal)
        rest[k] = _side_of(basis[k], h, m, lb, ub)[0]
        for j in range(n):
            rest[k] -= normal[j] * near[j]
    for i in range(n):
        for k in range(n):
            near[i] += inverse[i, k] * rest[k]


@leaf
def _how_far(G: Any, h: Any, m: int, lb: Any, ub: Any, near: Any, far: Any) -> float:
    """Least M, not below 1, with which the point fulfils everything."""
    n = G.shape[1]
    most = 1.0
    for i in range(m):
        excess, speed = -h[i], 0.0
        for j in range(n):
            excess += G[i, j] * near[j]
            speed += G[i, j] * far[j]
        if speed < -_EXCEEDED and excess > -speed * most:
            most = excess / -speed
    for j in range(n):
        if far[j] < -_EXCEEDED and ub[j] < np.inf and near[j] - ub[j] > -far[j] * most:
            most = (near[j] - ub[j]) / -far[j]
        if far[j] > _EXCEEDED and lb[j] > -np.inf and lb[j] - near[j] > far[j] * most:
            most = (lb[j] - near[j]) / far[j]
    return most


@leaf
def product(v: Any, w: Any) -> float:
    """Sum of the products of two vectors, from the first to the last."""
    total = 0.0
    for j in range(len(v)):
        total += v[j] * w[j]
    return total


@leaf
def _shared(normal: Any, inverse: Any, share: Any) -> float:
    """A normal as a combination of those of the basis; returns 1 and the sizes of its weights together."""
    n, total = len(normal), 1.0
    for k in range(n):
        share[k] = 0.0
        for j in range(n):
            share[k] += normal[j] * inverse[j, k]
        total += abs(share[k])
    return total


@leaf
def _told(
    c: Any, G: Any, h: Any, m: int, lb: Any, ub: Any, w: Any, y: Any, basis: Any, inverse: Any, space: Any
) -> int:
    """What the last basis says."""
    n, largest = len(c), 0.0
    price, near, far, normal, share = space[0], space[1], space[2], space[3], space[4]
    for j in range(n):
        largest = max(largest, abs(c[j]))
    for k in range(n):
        if _side_of(basis[k], h, m, lb, ub)[1] > 0.0 and price[k] > _NO_PRICE * largest:
            return UNBOUNDED
        if basis[k] < m:
            y[basis[k]] = price[k]
    _refined(inverse, basis, G, h, m, lb, ub, near, normal, share)
    reach = _how_far(G, h, m, lb, ub, near, far)
    for j in range(n):
        w[j] = near[j] + reach * far[j]
    return OPTIMAL


@leaf
def _started(c: Any, lb: Any, ub: Any, m: int, basis: Any, inverse: Any, price: Any) -> None:
    """The ends of the variables that suit the costs."""
    n = len(c)
    for i in range(n):
        for j in range(n):
            inverse[i, j] = 0.0
    for j in range(n):
        up = c[j] > 0.0 or (c[j] == 0.0 and (ub[j] < np.inf or lb[j] == -np.inf))
        basis[j] = m + j if up else m + n + j
        inverse[j, j] = 1.0 if up else -1.0
        price[j] = abs(c[j])


@leaf
def solved(
    c: Any, G: Any, h: Any, m: int, lb: Any, ub: Any, w: Any, y: Any, basis: Any, inverse: Any, space: Any
) -> int:
    """Solve a linear program over the first m rows, of finite sides; w and y hold the point and the multipliers then.

    The answer is not checked. UNKNOWN means that the steps ran out or that too little is left to decide by.

    Parameters
    ----------
    basis, inverse, space : arrays of shapes (n,) of int, (n, n) and (5, n)
        Room to work in.
    """
    n = G.shape[1]
    price, near, far, normal, share = space[0], space[1], space[2], space[3], space[4]
    _started(c, lb, ub, m, basis, inverse, price)
    for i in range(m):
        y[i] = 0.0
    for _ in range(50 + 5 * (m + n)):
        is_far = _placed(inverse, basis, h, m, lb, ub, near, far)
        enters = worst_row(G, h, m, near, far, is_far)
        if enters < 0:
            enters = _worst_end(lb, ub, near, far, m)
        if enters < 0:
            return _told(c, G, h, m, lb, ub, w, y, basis, inverse, space)
        _normal_of(enters, G, m, normal)
        total = _shared(normal, inverse, share)
        leaves = _leaving(price, share)
        if leaves < 0:
            side = _side_of(enters, h, m, lb, ub)[0]
            return INFEASIBLE if product(normal, near) - side > _CLEARLY * total * max(1.0, abs(side)) else UNKNOWN
        _exchanged(inverse, price, share, leaves)
        basis[leaves] = enters
    return UNKNOWN
