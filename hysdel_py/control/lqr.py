"""The linear quadratic regulator of a sampled system, and the cost of a stable one.

::

    P = A'P A - A'P B (R + B'P B)^-1 B'P A + Q,    K = -(R + B'P B)^-1 B'P A                          (1)
    P = (A + B K)'P (A + B K) + Q + K'R K                                                             (2)

u = K x minimises the sum of x'Q x + u'R u over all times, which is then x0'P x0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError

__all__ = ["closed_loop_cost", "is_stabilisable", "lqr"]

Matrix = NDArray[np.float64]

_RANK = 1e-9
"""Singular values of (A - s I, B) below this share of the greatest one count as zero."""
_SOLVED = 1e-6
"""Residual of equation (1), relative to its terms, with which a solution is accepted."""


def is_stabilisable(A: Matrix, B: Matrix) -> bool:
    """Whether an input can move every mode that does not vanish by itself (M. Hautus, 1969: rank of (A - s I, B))."""
    return not len(_stuck(A, B))


def lqr(A: Matrix, B: Matrix, Q: Matrix, R: Matrix) -> tuple[Matrix, Matrix]:
    """Gain K and cost P of equation (1).

    Parameters
    ----------
    A, B : arrays of shapes (n, n), (n, m)
    Q, R : arrays of shapes (n, n), (m, m)
        Symmetric positive semidefinite, R definite.

    Raises
    ------
    ArgumentError
        No input reaches an unstable mode, R is singular, or Q does not see a mode on the unit circle.
    """
    stuck = _stuck(A, B)
    if len(stuck):
        raise ArgumentError(
            f"no stabilising gain: the inputs do not reach the unstable mode with the eigenvalue {_text(stuck[0])}; "
            "give terminal and gain as matrices, or track references, which needs neither"
        )
    if R.size and np.linalg.eigvalsh(R)[0] <= 0:
        raise ArgumentError("the weight u is not positive definite, which 'lqr' needs: give every input a weight")
    P = _riccati(A, B, Q, R)
    return np.asarray(-np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A), dtype=np.float64), P


def closed_loop_cost(A: Matrix, B: Matrix, K: Matrix, Q: Matrix, R: Matrix) -> Matrix:
    """P of equation (2): the cost of u = K x from now on.

    Raises
    ------
    ArgumentError
        A + B K is not stable, so that there is no such cost.
    """
    from scipy.linalg import solve_discrete_lyapunov

    closed = A + B @ K
    radius = spectral_radius(closed)
    if radius >= 1:
        what = "A + B K" if K.any() else "A"
        raise ArgumentError(
            f"terminal is 'lyap', but {what} is not stable (spectral radius {radius:.6g}): the cost of the rest of "
            "time is infinite; give terminal='lqr', a stabilising gain, or a matrix"
        )
    P = solve_discrete_lyapunov(closed.T, Q + K.T @ R @ K)
    symmetric: Matrix = (P + P.T) / 2
    return symmetric


def spectral_radius(A: Matrix) -> float:
    """Largest absolute eigenvalue."""
    return float(np.abs(np.linalg.eigvals(A)).max(initial=0.0))


def _riccati(A: Matrix, B: Matrix, Q: Matrix, R: Matrix) -> Matrix:
    from scipy.linalg import solve_discrete_are

    if not B.size:
        return closed_loop_cost(A, B, np.zeros(B.T.shape), Q, R)
    try:
        P = solve_discrete_are(A, B, Q, R)
    except (np.linalg.LinAlgError, ValueError) as error:
        raise ArgumentError(f"no solution of the Riccati equation ({error}): {_UNSEEN}") from None
    gain = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
    residual = np.abs(A.T @ P @ (A - B @ gain) + Q - P).max(initial=0.0)
    if not residual <= _SOLVED * max(1.0, float(np.abs(P).max(initial=0.0))) or spectral_radius(A - B @ gain) >= 1:
        raise ArgumentError(f"no stabilising solution of the Riccati equation: {_UNSEEN}")
    symmetric: Matrix = (P + P.T) / 2
    return symmetric


_UNSEEN = "the weight x must see every mode on the unit circle; weigh more states"


def _stuck(A: Matrix, B: Matrix) -> Matrix:
    """Eigenvalues on or outside the unit circle that no input moves."""
    values = np.linalg.eigvals(A)
    return np.array([s for s in values if abs(s) >= 1 - _RANK and _loses_rank(A, B, s)])


def _loses_rank(A: Matrix, B: Matrix, s: complex) -> bool:
    sizes = np.linalg.svd(np.column_stack([A - s * np.eye(len(A)), B]), compute_uv=False)
    return bool(sizes[len(A) - 1] <= _RANK * max(1.0, sizes[0]))


def _text(value: complex) -> str:
    return f"{value.real:.6g}" if not value.imag else f"{value.real:.6g}{value.imag:+.6g}i"
