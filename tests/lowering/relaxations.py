"""Questions about the rows of an Mld, answered by HiGHS, independently of how the rows were made."""

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array, hstack

from hysdel_py.systems.dha import Event


def rows_of(mld):
    """(A, b) with ``A w <= b`` over w = (d, z, u, x)."""
    return csr_array(hstack([mld.E2, mld.E3, -mld.E1, -mld.E4])), mld.E5


def box_of(mld):
    """Ranges of d, u and x; the real auxiliaries are held by the rows alone."""
    low = [*(0.0 for _ in mld.d), *(-np.inf for _ in mld.z), *(v.low for v in (*mld.u, *mld.x))]
    high = [*(1.0 for _ in mld.d), *(np.inf for _ in mld.z), *(v.high for v in (*mld.u, *mld.x))]
    return Bounds(np.array(low), np.array(high))


def greatest(mld, row, side, *, integer):
    """By how much ``row w <= side`` is exceeded within the rows and ranges; minus infinity without a point."""
    A, b = rows_of(mld)
    whole = [v.is_bool for v in (*mld.d, *mld.z, *mld.u, *mld.x)]
    integrality = np.array(whole, dtype=int) if integer else None
    constraints = LinearConstraint(A, -np.inf, b) if len(b) else ()
    question = {"c": -row, "integrality": integrality, "bounds": box_of(mld), "constraints": constraints}
    answer = milp(**question)
    if answer.status == 4:  # some versions of HiGHS stumble over their own presolve
        answer = milp(**question, options={"presolve": False})
    if answer.status == 2:
        return -np.inf
    assert answer.status == 0, answer.message
    return -answer.fun - side


def lost_by(loose, tight):
    """Rows of `tight` that cut off a point which `loose` allows with Booleans at 0 or 1, and by how much."""
    A, b = rows_of(tight)
    old, old_b = rows_of(loose)
    changed = np.flatnonzero((abs(A - old).sum(axis=1) > 0) | (b != old_b))
    found = {int(i): greatest(loose, A[[i]].toarray()[0], b[i], integer=True) for i in changed}
    return {i: excess for i, excess in found.items() if excess > 1e-5 * max(1.0, abs(b[i]))}


def violated(mld, x, u, d, z, tolerance=1e-9):
    """Numbers of the rows that a point violates."""
    A, b = rows_of(mld)
    point = np.concatenate([d, z, u, x])
    size = abs(A) @ abs(point) + abs(b)
    return np.flatnonzero(A @ point > b + tolerance + 1e-14 * size).tolist()


def near_a_threshold(dha, x, u, d, z):
    """Whether a form lies in the gap of its event, where the rows have no point."""
    values = dict(zip([v.name for v in (*dha.d, *dha.z, *dha.u, *dha.x)], [*d, *z, *u, *x], strict=True))
    return any(0 < item.form.value(values) <= item.epsilon for item in dha.items if isinstance(item, Event))
