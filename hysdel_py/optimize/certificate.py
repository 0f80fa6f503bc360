"""Bounds that hold whatever the solver did.

A convex function lies above its tangents: for any point x, ``f(w) >= -1/2 x'P x + g'w`` with ``g = P x + q``. For any
multipliers y, ``g'w = (g + A'y)'w - y'(A w)``, and both terms have a least value over the box of w and over the
interval of ``A w``. The sum is a lower bound of the problem for *every* x and y; with those of a solution it is the
optimal value. Setting the objective to zero gives the lemma of Farkas: a positive bound proves that no point satisfies
the rows.

Source: A. Neumaier and O. Shcherbina, "Safe bounds in linear and mixed-integer linear programming", Mathematical
Programming 99, 2004, equations (3) to (8); here with a quadratic objective, and with an allowance for rounding from
the standard model of floating-point arithmetic instead of directed rounding.

A variable without bounds makes the linear bound useless as soon as its reduced cost is not exactly zero. Where the
Hessian has curvature in that variable, ``P - diag(c)`` still being positive semidefinite, the tangent is replaced by
the parabola ``c_j/2 (w_j - x_j)^2``, which costs only ``r_j^2 / (2 c_j)``.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.qp import Qp

__all__ = ["Certifier", "diagonal_curvature", "dual_bound", "farkas_bound", "spare_curvature"]

Vector = NDArray[np.float64]
UNIT_ROUNDOFF = float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False, slots=True)
class Certifier:
    """The transposed and absolute matrices that the bounds of many points and boxes share.

    Attributes
    ----------
    P, Pabs : sparse arrays of shape (n, n)
    At, Atabs : sparse arrays of shape (n, m)
    curvature : array of shape (n,), or None
        c >= 0 with P - diag(c) positive semidefinite.
    rounding : float
        Relative error of one dot product and of the sums over it.
    """

    P: Any
    Pabs: Any
    At: Any
    Atabs: Any
    curvature: Vector | None
    rounding: float

    @classmethod
    def of(cls, qp: Qp, curvature: Vector | None = None) -> Certifier:
        """Prepare the certificates of a problem."""
        from scipy.sparse import csr_array

        At, P = qp.At, csr_array(qp.P)
        operations = 2 * (qp.n + qp.m + 8)
        return cls(P, abs(P), At, abs(At), curvature, operations * UNIT_ROUNDOFF)

    def dual_bound(self, qp: Qp, x: Vector, y: Vector) -> float:
        """Lower bound of the problem, valid for any x and y; see :func:`dual_bound`."""
        if not (np.isfinite(x).all() and np.isfinite(y).all()):
            return -inf
        y = usable_multipliers(y, qp.l, qp.u)
        Px = self.P @ x
        reduced = Px + qp.q + self.At @ y
        noise = self.rounding * (self.Pabs @ np.abs(x) + np.abs(qp.q) + self.Atabs @ np.abs(y))
        value = qp.constant - 0.5 * (x @ Px) + self._least(reduced, noise, x, qp) - _greatest(y, qp)
        return float(value - self._allowance(x, y, qp))

    def farkas_bound(self, qp: Qp, y: Vector) -> float:
        """Least value of the combined rows over the box; positive proves infeasibility; see :func:`farkas_bound`."""
        if not np.isfinite(y).all():
            return -inf
        y = usable_multipliers(y, qp.l, qp.u)
        reduced, noise = self.At @ y, self.rounding * (self.Atabs @ np.abs(y))
        value = _least_linear(reduced, noise, qp.lb, qp.ub) - _greatest(y, qp)
        return float(value - self.rounding * _size(y, qp)) if not np.isnan(value) else -inf

    def _least(self, reduced: Vector, noise: Vector, x: Vector, qp: Qp) -> float:
        if self.curvature is None:
            return _least_linear(reduced, noise, qp.lb, qp.ub)
        return _least_curved(reduced, noise, x, self.curvature, qp)

    def _allowance(self, x: Vector, y: Vector, qp: Qp) -> float:
        size = abs(qp.constant) + 0.5 * (np.abs(x) @ (self.Pabs @ np.abs(x))) + _size(y, qp)
        return float(self.rounding * size)


def dual_bound(qp: Qp, x: Vector, y: Vector) -> float:
    """Lower bound of a convex quadratic program for any point and any multipliers.

    Parameters
    ----------
    qp : Qp
        The problem; its bounds may be replaced by tighter implied ones.
    x : array of shape (n,)
        Where the objective is linearised.
    y : array of shape (m,)
        Multipliers of the rows; one that points at an infinite side counts as zero.

    Returns
    -------
    float
        A number not above the objective of any feasible point; minus infinity if a variable without bounds has a
        reduced cost that is not zero, or if x or y is not finite.
    """
    return Certifier.of(qp).dual_bound(qp, np.asarray(x, dtype=float), np.asarray(y, dtype=float))


def farkas_bound(qp: Qp, y: Vector) -> float:
    """Lower bound of the zero function over the feasible set, from any multipliers; positive proves it empty."""
    return Certifier.of(qp).farkas_bound(qp, np.asarray(y, dtype=float))


def spare_curvature(qp: Qp, free: NDArray[np.bool_], share: float = 0.5) -> Vector | None:
    """Curvature c >= 0 on the marked variables such that P - diag(c) stays positive semidefinite, or None.

    A multiple of the identity on the marked block: by Schur's complement the largest admissible one is the least
    eigenvalue of ``P_ff - P_fk P_kk^+ P_kf``; half of it is taken and the result is checked by eigenvalues.
    """
    if not free.any() or qp.P.nnz == 0:
        return None
    P = qp.P.toarray()
    Pff, Pfk, Pkk = P[np.ix_(free, free)], P[np.ix_(free, ~free)], P[np.ix_(~free, ~free)]
    schur = Pff - Pfk @ np.linalg.pinv(Pkk, hermitian=True) @ Pfk.T if (~free).any() else Pff
    least = np.linalg.eigvalsh(schur)[0]
    noise = len(P) * UNIT_ROUNDOFF * np.abs(P).max()
    curvature = np.where(free, share * least, 0.0)
    if least <= 100 * noise or np.linalg.eigvalsh(P - np.diag(curvature))[0] < -10 * noise:
        return None
    return curvature


def diagonal_curvature(P: Any) -> Vector:
    """Curvature c >= 0 of single variables such that P - diag(c) stays positive semidefinite.

    Variables that P does not couple with each other are apart; of each coupled group all get its least eigenvalue.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    rows = csr_array(P)
    curvature: Vector = np.maximum(0.0, rows.diagonal())
    _, group = connected_components(rows, directed=False)
    for number in np.flatnonzero(np.bincount(group) > 1):
        members = np.flatnonzero(group == number)
        curvature[members] = _least_eigenvalue(rows[members][:, members].toarray())
    return curvature


def _least_eigenvalue(block: NDArray[np.float64]) -> float:
    """Least eigenvalue less its possible error, or 0."""
    noise = 10 * len(block) * UNIT_ROUNDOFF * float(np.abs(block).max())
    return max(0.0, float(np.linalg.eigvalsh(block)[0]) - noise)


def usable_multipliers(y: Vector, l: Vector, u: Vector) -> Vector:  # noqa: E741
    """Multipliers with those that point at an infinite side set to zero."""
    wrong = ((y > 0) & (u == inf)) | ((y < 0) & (l == -inf))
    return np.where(wrong, 0.0, y) if wrong.any() else y


def _least_linear(reduced: Vector, noise: Vector, lb: Vector, ub: Vector) -> float:
    """Least value of (reduced ± noise)'w over the box; minus infinity where a side that matters is missing."""
    low, high = reduced - noise, reduced + noise
    ends = [_times(low, lb), _times(high, lb), _times(low, ub), _times(high, ub)]
    return float(np.minimum.reduce(ends).sum())


def _times(coefficient: Vector, bound: Vector) -> Vector:
    """Product in which zero times infinity is zero: the variable does not matter."""
    return coefficient * np.where(coefficient == 0, 0.0, bound)


def _least_curved(reduced: Vector, noise: Vector, x: Vector, curvature: Vector, qp: Qp) -> float:
    """The same with the parabola ``c/2 (w - x)^2`` added where there is curvature."""
    curved = curvature > 0
    flat = _least_linear(reduced[~curved], noise[~curved], qp.lb[~curved], qp.ub[~curved])
    r, e, c, at = reduced[curved], noise[curved], curvature[curved], x[curved]
    step = (np.abs(r) + e) / c
    value = r * at - e * np.abs(at) - 0.5 * c * step**2
    return flat + float(value.sum())


def _greatest(y: Vector, qp: Qp) -> float:
    """Greatest value of y's over the sides of the rows."""
    side = np.where(y > 0, qp.u, qp.l)
    return float(np.sum(y * np.where(y == 0, 0.0, side)))


def _size(y: Vector, qp: Qp) -> float:
    side = np.where(y > 0, qp.u, qp.l)
    return float(np.sum(np.abs(y) * np.abs(np.where(y == 0, 0.0, side))))
