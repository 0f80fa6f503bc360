"""Extreme rays of a cone ``{z : H z >= 0}`` by the double description method.

At first all directions are lines. A row that a line does not keep makes a ray of it; a row that all lines keep cuts
off the rays on its far side, and every two neighbours that it parts make a new one (T. S. Motzkin, H. Raiffa, G. L.
Thompson and R. M. Thrall, "The double description method", 1953). Two rays are neighbours if no third one fulfils with
equality all rows that both do (K. Fukuda and A. Prodon, "Double description method revisited", 1996, proposition 7);
sets of rows are bits.

The method decides by signs. A value that is neither clearly zero nor clearly not makes the answer UNSURE, as does a ray
that does not stand the check at the end; TOO_LONG says that there is more to do than is worth it. Then the caller takes
another way.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.compiled import either, leaf
from hysdel_py.geometry.kernels.linear_program import product

__all__ = ["TOO_LONG", "UNSURE", "extreme_rays"]

UNSURE, TOO_LONG = -1, -2

_ZERO = 1e-12
"""A value of unit rows and rays below this is zero."""
_SURE = 1e-10
"""A value above this is not."""
_CLEAR = 1e-9
"""A line that is to become a ray has a value above this."""
_ONE = np.uint64(1)
_NONE = np.uint64(0)


@leaf
def _to_unit(rays: Any, k: int) -> None:
    total = np.sqrt(product(rays[k], rays[k]))
    for j in range(rays.shape[1]):
        rays[k, j] /= total


@leaf
def _moved_onto(H: Any, row: int, ray: Any, others: Any, count: int) -> None:
    """Move the first of some lines or rays along a ray onto a row, on which the ray has the value 1."""
    for k in range(count):
        share = product(H[row], others[k])
        for j in range(H.shape[1]):
            others[k, j] -= share * ray[j]
        _to_unit(others, k)


@leaf
def _farthest_from_lines(H: Any, lines: Any, left: int, used: Any, pair: Any) -> float:
    """The unused row and the line with the greatest value, and that value; the first of about equal ones."""
    most = 0.0
    for i in range(len(H)):
        if used[i]:
            continue
        for k in range(left):
            value = product(H[i], lines[k])
            if abs(value) > 1.001 * most:
                pair[0], pair[1], most = i, k, abs(value)
    return most


@leaf
def _made_ray(H: Any, lines: Any, left: int, pair: Any, rays: Any, count: int) -> None:
    """The line of a pair becomes the last ray; the other lines and rays move along it onto the row of the pair."""
    row, line, d = pair[0], pair[1], H.shape[1]
    value = product(H[row], lines[line])
    for j in range(d):
        rays[count, j] = lines[line, j] / value
        lines[line, j] = lines[left - 1, j]
    _moved_onto(H, row, rays[count], lines, left - 1)
    _moved_onto(H, row, rays[count], rays, count)
    _to_unit(rays, count)


@leaf
def _judged(H: Any, row: int, rays: Any, count: int, values: Any, order: Any) -> int:
    """Values of a row at all rays, zero where they are about zero.

    The rays above are listed at the start of the order, those below from its end. Returns how many there are above,
    or UNSURE.
    """
    above, below = 0, len(order)
    for k in range(count):
        value = product(H[row], rays[k])
        if abs(value) <= _ZERO:
            value = 0.0
        elif abs(value) < _SURE:
            return UNSURE
        values[k] = value
        if value > 0.0:
            order[above] = k
            above += 1
        elif value < 0.0:
            below -= 1
            order[below] = k
    values[count] = len(order) - below
    return above


@leaf
def _are_neighbours(bits: Any, count: int, p: int, q: int, least: int) -> bool:
    """Whether no third ray fulfils with equality all rows that two do; there must be a least number of them."""
    words, shared = bits.shape[1], 0
    for v in range(words):
        both = bits[p, v] & bits[q, v]
        while both != _NONE and shared < least:
            both &= both - _ONE
            shared += 1
    if shared < least:
        return False
    for k in range(count):
        holds = k not in (p, q)
        for v in range(words):
            both = bits[p, v] & bits[q, v]
            if bits[k, v] & both != both:
                holds = False
                break
        if holds:
            return False
    return True


def _neighbours_loops(bits: Any, count: int, order: Any, above: int, below: int, least: int, pairs: Any) -> int:
    found = 0
    for i in range(above):
        for k in range(below):
            p, q = order[i], order[len(order) - 1 - k]
            if _are_neighbours(bits, count, p, q, least):
                if found == len(pairs):
                    return TOO_LONG
                pairs[found, 0], pairs[found, 1] = p, q
                found += 1
    return found


def _neighbours_arrays(bits: Any, count: int, order: Any, above: int, below: int, least: int, pairs: Any) -> int:
    p, q = order[:above], order[::-1][:below]
    both = bits[p][:, None] & bits[q][None]
    enough = np.unpackbits(both.view(np.uint8), axis=-1).sum(axis=-1) >= least
    i, k = np.nonzero(enough)
    both = both[i, k]
    holders = np.all(bits[None, :count] & both[:, None] == both[:, None], axis=-1).sum(axis=1)
    i, k = i[holders == 2], k[holders == 2]
    if len(i) > len(pairs):
        return TOO_LONG
    pairs[: len(i), 0], pairs[: len(i), 1] = p[i], q[k]
    return len(i)


_neighbours = either(_neighbours_loops, _neighbours_arrays, leaf)
"""Pairs of neighbours on two sides of a row, in order; how many."""


@leaf
def _joined(rays: Any, bits: Any, count: int, values: Any, pairs: Any, found: int) -> int:
    """Add the ray on a row between each pair of neighbours; how many there are then."""
    if count + found >= len(rays):
        return TOO_LONG
    for i in range(found):
        p, q, new = pairs[i, 0], pairs[i, 1], count + i
        for j in range(rays.shape[1]):
            rays[new, j] = values[p] * rays[q, j] - values[q] * rays[p, j]
        _to_unit(rays, new)
        for v in range(bits.shape[1]):
            bits[new, v] = bits[p, v] & bits[q, v]
        values[new] = 0.0
    return count + found


@leaf
def _kept(rays: Any, bits: Any, total: int, values: Any, row: int) -> int:
    """Drop the rays on the far side of a row, and note those on the row."""
    left = 0
    for k in range(total):
        if values[k] < 0.0:
            continue
        for j in range(rays.shape[1]):
            rays[left, j] = rays[k, j]
        for v in range(bits.shape[1]):
            bits[left, v] = bits[k, v]
        if values[k] == 0.0:
            bits[left, row >> 6] |= _ONE << np.uint64(row & 63)
        left += 1
    return left


@leaf
def _stands(H: Any, rays: Any, bits: Any, count: int) -> bool:
    """Whether each ray fulfils all rows, and those with equality that it should."""
    for k in range(count):
        for i in range(len(H)):
            value = product(H[i], rays[k])
            is_on = (bits[k, i >> 6] >> np.uint64(i & 63)) & _ONE
            if value < -_ZERO or (is_on != _NONE) != (value <= _ZERO):
                return False
    return True


@leaf
def _started(H: Any, lines: Any, rays: Any, bits: Any, used: Any, pair: Any) -> int:
    """The rays of the cone of some independent rows; what is left of the lines stays. How many rays, or UNSURE."""
    d: int = H.shape[1]
    for j in range(d):
        for k in range(d):
            lines[j, k] = 1.0 if j == k else 0.0
    for count in range(d):
        most = _farthest_from_lines(H, lines, d - count, used, pair)
        if most < _CLEAR:
            return count if most <= _ZERO else UNSURE
        _made_ray(H, lines, d - count, pair, rays, count)
        row = int(pair[0])
        for i in range(len(H)):
            if used[i]:
                bits[count, i >> 6] |= _ONE << np.uint64(i & 63)
        for k in range(count):
            bits[k, row >> 6] |= _ONE << np.uint64(row & 63)
        used[row] = True
    return d


@leaf
def extreme_rays(
    H: Any, most_work: float, lines: Any, rays: Any, bits: Any, values: Any, order: Any, pairs: Any, used: Any
) -> int:
    """Fill in extreme rays of unit length with the rows that they fulfil with equality, and unit lines.

    Returns the number of rays, UNSURE or TOO_LONG. Afterwards ``order[0]`` is the rank of the rows; the lines are the
    first of those given, as many as the width less the rank, not orthogonal yet.

    Parameters
    ----------
    H : array of shape (m, d)
        Rows of about unit length.
    most_work : float
        Comparisons of sets after which to stop.
    lines : array of shape (d, d)
    rays, bits, values, order : arrays of shapes (k, d), (k, w) of uint64, (k,) and (k,) of int, w >= m / 64
        Room for k rays.
    pairs, used : arrays of shapes (k, 2) of int and (m,) of bool
        Room to work in; all False.
    """
    rank = count = _started(H, lines, rays, bits, used, order)
    if rank < 0:
        return UNSURE
    for row in range(len(H)):
        if used[row]:
            continue
        above = _judged(H, row, rays, count, values, order)
        if above < 0:
            return UNSURE
        below, total = int(values[count]), count
        if above and below:
            most_work -= above * below * 4.0 + count * len(H) * 0.5
            if most_work < 0.0:
                return TOO_LONG
            found = _neighbours(bits, count, order, above, below, rank - 2, pairs)
            total = _joined(rays, bits, count, values, pairs, found) if found >= 0 else TOO_LONG
            if total < 0:
                return TOO_LONG
        count = _kept(rays, bits, total, values, row)
    order[0] = rank
    return count if _stands(H, rays, bits, count) else UNSURE
