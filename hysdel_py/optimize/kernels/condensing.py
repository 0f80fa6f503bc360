"""A node of a branch and bound as a small dense program.

Fixed variables are put in. Rows that demand a value define the variable of theirs that comes last, in terms of earlier
ones: in predictive control, whose variables come stage after stage, these are the next state and every auxiliary whose
pair of big-M rows has closed. What is left are independent variables, ``w = Z v + z0``, and the inequalities that the
box does not settle.

Rows with parallel real parts form a group; where all binaries of several rows of a group are fixed, they are one row
with two sides.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.optimize.compiled import compiled

__all__ = ["condense", "lift_multipliers"]

FIXED = 1e-11
"""A variable whose interval is narrower than this, relative to its size, is fixed in the middle."""
MEET = 1e-9
"""Sides of a group that are closer than this, relative to their size, are one side."""
PIVOT = 1e-3
"""The variable that a row defines has at least this share of its greatest coefficient."""
FREE, DEFINED, CONSTANT = 0, 1, 2


@compiled
def condense(problem, groups, box, wide):
    """Reduce a node.

    Parameters
    ----------
    problem : (P, q, rows, l, u, integer)
        P and rows as (start, column, value) in compressed rows.
    groups : (start, row, scale, integer)
        Members of each group: the real part of a row is its scale times that of the first of the group. The last entry
        marks the binaries among the variables.
    box : (lb, ub)
        Propagated bounds.
    wide : (lb, ub)
        Bounds that the problem itself has.

    Returns
    -------
    Z : array of shape (n, k + 1)
        The last column is z0.
    H, f : arrays of shape (k, k), (k,)
    N, b : rows ``N v >= b`` of unit length
    source : array of shape (rows, 2)
        Row of the problem (or m + variable for a bound) and the sign of its side: 1 for the upper one.
    length : array
        What the row of the problem was divided by.
    definitions : (variable, row at the upper side, row at the lower side, scales of both), in the order of variables
    """
    P, q, rows, l, u, integer = problem
    n = len(q)
    kind, value = classify(box)
    merged = merge_groups(rows, l, u, groups, integer, box)
    defining = define(rows, groups, merged, kind, n)
    place = np.full(n, -1, dtype=np.int64)
    k = 0
    for j in range(n):
        if kind[j] == FREE:
            place[j] = k
            k += 1
    Z = substitute(rows, groups, merged, (kind, value, defining, place), k)
    H, f = project(P, q, Z, k)
    N, b, source, length = inequalities(problem, groups, merged, (kind, defining), (Z, box, wide))
    return Z, H, f, N, b, source, length, defining, merged


@compiled
def classify(box):
    """Which variables are constant, and their values."""
    lb, ub = box
    n = len(lb)
    kind = np.zeros(n, dtype=np.int64)
    value = np.zeros(n)
    for j in range(n):
        width = ub[j] - lb[j]
        if np.isfinite(width) and width <= FIXED * (1.0 + abs(lb[j])):
            kind[j] = CONSTANT
            value[j] = lb[j] if ub[j] <= lb[j] else 0.5 * (lb[j] + ub[j])
    return kind, value


@compiled
def merge_groups(rows, l, u, groups, integer, box):
    """Tightest sides of each group over its rows whose binaries are all fixed.

    Returns arrays of shape (groups,): low, high, the rows that give them (-1 for none), and whether the two meet; and
    for each row whether it went into its group.
    """
    start, member, scale, _ = groups
    count = len(start) - 1
    low, high = np.full(count, -np.inf), np.full(count, np.inf)
    at_low, at_high = np.full(count, -1, dtype=np.int64), np.full(count, -1, dtype=np.int64)
    meet = np.zeros(count, dtype=np.bool_)
    inside = np.zeros(len(l), dtype=np.bool_)
    for g in range(count):
        for at in range(start[g], start[g + 1]):
            row, s = member[at], scale[at]
            base, settled = fixed_part(row, rows, integer, box)
            if not settled:
                continue
            inside[row] = True
            first, second = (l[row] - base) / s, (u[row] - base) / s
            if s < 0:
                first, second = second, first
            if first > low[g]:
                low[g], at_low[g] = first, at
            if second < high[g]:
                high[g], at_high[g] = second, at
        if np.isfinite(low[g]) and np.isfinite(high[g]):
            meet[g] = abs(high[g] - low[g]) <= MEET * (1.0 + abs(high[g]))
    return low, high, at_low, at_high, meet, inside


@compiled
def fixed_part(row, rows, integer, box):
    """Sum of the binary terms of a row, and whether all of them are fixed."""
    start, column, value = rows
    total = 0.0
    for at in range(start[row], start[row + 1]):
        j = column[at]
        if integer[j]:
            if box[0][j] < box[1][j]:
                return 0.0, False
            total += value[at] * box[0][j]
    return total, True


@compiled
def define(rows, groups, merged, kind, n):
    """Let each group whose sides meet define its last free variable; marks these in `kind`.

    Returns the group that defines each variable, -1 for none.
    """
    start, column, value = rows
    defining = np.full(n, -1, dtype=np.int64)
    for g in range(len(merged[4])):
        if not merged[4][g]:
            continue
        row = groups[1][groups[0][g]]
        last, coefficient, greatest = -1, 0.0, 0.0
        for at in range(start[row], start[row + 1]):
            j = column[at]
            if kind[j] != CONSTANT:
                greatest = max(greatest, abs(value[at]))
                if j > last:
                    last, coefficient = j, value[at]
        if last >= 0 and defining[last] < 0 and abs(coefficient) >= PIVOT * greatest:
            defining[last] = g
            kind[last] = DEFINED
    return defining


@compiled
def substitute(rows, groups, merged, places, k):
    """All variables in terms of the free ones, in rising order, so that what a row needs is there already."""
    start, column, value = rows
    kind, constant, defining, place = places
    n = len(kind)
    Z = np.zeros((n, k + 1))
    for j in range(n):
        if kind[j] == FREE:
            Z[j, place[j]] = 1.0
        elif kind[j] == CONSTANT:
            Z[j, k] = constant[j]
        else:
            g = defining[j]
            row = groups[1][groups[0][g]]
            own = 0.0
            for at in range(start[row], start[row + 1]):
                i = column[at]
                if i == j:
                    own = value[at]
                elif not groups[3][i]:
                    for c in range(k + 1):
                        Z[j, c] -= value[at] * Z[i, c]
            Z[j, k] += 0.5 * (merged[0][g] + merged[1][g])
            for c in range(k + 1):
                Z[j, c] /= own
    return Z


@compiled
def project(P, q, Z, k):
    """Hessian and gradient in the free variables."""
    start, column, value = P
    n = len(q)
    H, f = np.zeros((k, k)), np.zeros(k)
    t = np.zeros(k + 1)
    for i in range(n):
        if start[i] == start[i + 1] and q[i] == 0.0:
            continue
        t[:] = 0.0
        for at in range(start[i], start[i + 1]):
            j, p = column[at], value[at]
            for c in range(k + 1):
                t[c] += p * Z[j, c]
        for a in range(k):
            factor = Z[i, a]
            if factor != 0.0:
                f[a] += factor * (t[k] + q[i])
                for c in range(k):
                    H[a, c] += factor * t[c]
    return H, f


@compiled
def inequalities(problem, groups, merged, places, ranges):
    """Sides of rows and bounds of variables that the box does not settle, as rows ``N v >= b`` of unit length."""
    rows, l = problem[2], problem[3]
    kind, defining = places
    Z, box, wide = ranges
    n, k, m = len(kind), Z.shape[1] - 1, len(l)
    limit = 2 * (m + n)
    N, b = np.zeros((limit, k)), np.zeros(limit)
    source = np.zeros((limit, 2), dtype=np.int64)
    length = np.zeros(limit)
    count = 0
    for g in range(len(merged[4])):
        if merged[4][g] and owned(g, rows, groups, defining):
            continue
        for side in range(2):  # of the merged row: the upper, then the lower one
            at = merged[3][g] if side == 0 else merged[2][g]
            if at >= 0:
                row = groups[1][at]
                upper = (groups[2][at] > 0) == (side == 0)
                count = put_row(row, upper, problem, (Z, box), (N, b, source, length), count)
    for row in range(m):
        if not merged[5][row]:
            count = put_row(row, True, problem, (Z, box), (N, b, source, length), count)
            count = put_row(row, False, problem, (Z, box), (N, b, source, length), count)
    for j in range(n):
        if kind[j] == CONSTANT:
            continue
        low, high = (box[0][j], box[1][j]) if kind[j] == FREE else (wide[0][j], wide[1][j])
        if kind[j] == DEFINED and implied(j, defining[j], rows, groups, merged, box, low, high):
            continue
        if np.isfinite(high):
            count = put(Z[j], 1.0, high, (m + j, 1), (N, b, source, length), count)
        if np.isfinite(low):
            count = put(Z[j], -1.0, -low, (m + j, -1), (N, b, source, length), count)
    return N[:count], b[:count], source[:count], length[:count]


@compiled
def owned(g, rows, groups, defining):
    """Whether a group defines a variable."""
    row = groups[1][groups[0][g]]
    for at in range(rows[0][row], rows[0][row + 1]):
        if defining[rows[1][at]] == g:
            return True
    return False


@compiled
def implied(j, g, rows, groups, merged, box, low, high):
    """Whether the definition keeps a variable within its bounds for every point of the box."""
    start, column, value = rows
    row = groups[1][groups[0][g]]
    least = most = 0.5 * (merged[0][g] + merged[1][g])
    own = 1.0
    for at in range(start[row], start[row + 1]):
        i, a = column[at], value[at]
        if i == j:
            own = a
        elif not groups[3][i]:
            least -= max(a * box[0][i], a * box[1][i])
            most -= min(a * box[0][i], a * box[1][i])
    first, second = least / own, most / own
    if own < 0:
        first, second = second, first
    return first >= low and second <= high


@compiled
def put_row(row, upper, problem, ranges, out, count):
    """One side of a row of the problem, unless the box settles it."""
    start, column, value = problem[2]
    side = problem[4][row] if upper else problem[3][row]
    if not np.isfinite(side):
        return count
    Z, box = ranges
    sign = 1.0 if upper else -1.0
    reach = 0.0
    total = np.zeros(Z.shape[1])
    for at in range(start[row], start[row + 1]):
        j, a = column[at], sign * value[at]
        reach += max(a * box[0][j], a * box[1][j])
        for c in range(Z.shape[1]):
            total[c] += a * Z[j, c]
    if reach <= sign * side:
        return count
    return put(total, 1.0, sign * side, (row, 1 if upper else -1), out, count)


@compiled
def put(form, sign, side, source, out, count):
    """``sign * form <= side`` as a row of unit length, unless nothing free is in it."""
    N, b, sources, length = out
    k = N.shape[1]
    size = 0.0
    for c in range(k):
        size += form[c] * form[c]
    size = np.sqrt(size)
    if size <= 1e-12:
        return count
    for c in range(k):
        N[count, c] = -sign * form[c] / size
    b[count] = (sign * form[k] - side) / size
    sources[count, 0], sources[count, 1] = source
    length[count] = size
    return count + 1


@compiled
def lift_multipliers(problem, groups, condensed, gradient, active, weight):
    """Multipliers of all rows from those of the active inequalities.

    Parameters
    ----------
    gradient : array of shape (n,)
        Of the objective at the solution; zero for a ray. Changed in place.
    active, weight : arrays
        Numbers of the inequalities and their multipliers.

    Returns
    -------
    y : array of shape (m,)
        Positive at upper sides. Those of the rows that define a variable make its reduced cost vanish.
    """
    rows, m = problem[2], len(problem[3])
    source, length, defining, merged = condensed
    y = np.zeros(m)
    for i in range(len(active)):
        which, sign = source[active[i], 0], float(source[active[i], 1])
        amount = sign * weight[i] / length[active[i]]
        if which >= m:
            gradient[which - m] += amount
        else:
            y[which] += amount
            spread(which, amount, rows, gradient)
    for j in range(len(defining) - 1, -1, -1):
        g = defining[j]
        if g >= 0:
            first = groups[0][g]
            need = -gradient[j] / entry(groups[1][first], j, rows)  # of the first row of the group
            at = merged[3][g] if need > 0 else merged[2][g]
            row, amount = groups[1][at], need / groups[2][at]
            y[row] += amount
            spread(row, amount, rows, gradient)
    return y


@compiled
def spread(row, amount, rows, gradient):
    """Add a multiple of a row to the gradient."""
    for at in range(rows[0][row], rows[0][row + 1]):
        gradient[rows[1][at]] += amount * rows[2][at]


@compiled
def entry(row, j, rows):
    """Coefficient of a variable in a row."""
    for at in range(rows[0][row], rows[0][row + 1]):
        if rows[1][at] == j:
            return rows[2][at]
    return 0.0
