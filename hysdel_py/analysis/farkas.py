"""Which rows of a linear relaxation contradict each other, from the dual values of the least sum of violations."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.milp import Milp
from hysdel_py.analysis.settings import SearchTolerances

__all__ = ["least_violation_duals"]

Vector = NDArray[np.float64]


def least_violation_duals(problem: Milp, tolerances: SearchTolerances) -> Vector | None:
    """Dual values of the rows for the least sum of violations, Booleans being fractions.

    The rows with a dual value other than zero have no point in common within the bounds (J. Farkas, 1902): weighted
    with these values they add up to a row that the bounds forbid.

    Returns
    -------
    array of shape (m,), or None
        None if nothing has to be violated, or if the solver does not say.
    """
    from scipy.optimize import linprog
    from scipy.sparse import eye_array, hstack

    A, low, high = problem.matrix()
    m, n = A.shape
    # A w + below - above = s with low <= s <= high; s as a variable keeps one dual value per row.
    full = hstack([A, eye_array(m), -eye_array(m), -eye_array(m)], format="csr")
    cost = np.concatenate([np.zeros(n), np.ones(2 * m), np.zeros(m)])
    lower = np.concatenate([problem.low, np.zeros(2 * m), low])
    upper = np.concatenate([problem.high, np.full(2 * m, np.inf), high])
    answer: Any = linprog(cost, A_eq=full, b_eq=np.zeros(m), bounds=np.column_stack([lower, upper]), method="highs")
    if answer.status != 0 or answer.fun <= tolerances.rows:
        return None
    duals = np.asarray(answer.eqlin.marginals, dtype=float)
    return np.where(np.abs(duals) > tolerances.duals, duals, 0.0)
