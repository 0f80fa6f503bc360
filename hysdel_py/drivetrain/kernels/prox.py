"""Contact problems by projected fixed-point iterations: the augmented Lagrangian (exact regularisation) method.

Source: H. Alart and A. Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991; in drivetrains: Kusters, section 4.3.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled
from hysdel_py.drivetrain.kernels.delassus import slips

__all__ = ["JACOBI", "SEIDEL", "solve_prox"]

JACOBI, SEIDEL = 1.0, 2.0


@compiled
def solve_prox(G, rows, c, lo, hi, P, solver, dt):
    """Iterate ``P_i <- prox(P_i - r_i gamma_i)`` from P, which is overwritten.

    Parameters
    ----------
    G : Delassus
    rows : Rows
        Of G, which SEIDEL goes through.
    solver : (kind, steepness, tolerance, iterations)
        JACOBI takes ``r_i = steepness * dt`` for all contacts together and stops by the change of the torques P/dt;
        SEIDEL takes ``r_i = steepness / G_ii``, one contact after the other, and stops by the slip that is left,
        relative to that before.

    Returns
    -------
    int
        Iterations; -1 where their limit was reached.
    """
    for i in range(len(c)):
        P[i] = min(max(P[i], lo[i]), hi[i])
    for sweep in range(int(solver[3])):
        if solver[0] == JACOBI:
            done = jacobi_sweep(G, c, lo, hi, P, solver[1] * dt) < solver[2] * dt
        else:
            done = seidel_sweep(rows, G.diagonal, c, lo, hi, P, solver[1]) <= solver[2]
        if done:
            return sweep + 1
    return -1


@compiled
def jacobi_sweep(G, c, lo, hi, P, r):
    """One iteration for all contacts at once; Euclidean norm of the change of the impulses."""
    slip = slips(G, c, P)
    change = 0.0
    for i in range(len(c)):
        new = min(max(P[i] - r * slip[i], lo[i]), hi[i])
        change += (new - P[i]) ** 2
        P[i] = new
    return np.sqrt(change)


@compiled
def seidel_sweep(rows, diagonal, c, lo, hi, P, relaxation):
    """One iteration contact after contact; greatest change, as the share of a slip in the size of its terms."""
    worst = 0.0
    for i in range(len(c)):
        slip = c[i]
        size = abs(c[i])
        for k in range(rows.start[i], rows.start[i + 1]):
            term = rows.value[k] * P[rows.column[k]]
            slip += term
            size += abs(term)
        new = min(max(P[i] - relaxation * slip / diagonal[i], lo[i]), hi[i])
        if size > 0.0:
            worst = max(worst, abs(new - P[i]) * diagonal[i] / size)
        P[i] = new
    return worst
