"""Analytical dynamic programming: linear systems, quadratic cost, terminal equality, in closed form.

::

    min  sum_k 1/2 [x'Q x + 2 x'S u + u'R u] + q'x + r'u   +   1/2 x_N'P x_N + p'x_N
    with x_k+1 = A x_k + B u_k + d,     C x_N + c = 0

Section 9.2 of J.R.P. Kusters, "Modelling and coordinated control of advanced automotive transmissions", TU/e, DCT
2005-58, after M. Haj-Fraj and F. Pfeiffer (2001). The cost to go of stage k is a quadratic function with a value only
where ``C_k x + c_k = 0``. A step back splits the inputs by a singular value decomposition of ``C_k B``: one part is
needed to meet the equality, the rest is free and minimises. What the inputs cannot meet becomes an equality of the
stage before, so actuators with lag and more equalities than inputs work as well.

There are no constraints: inputs and states are kept within their limits by weights.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.dynamic_programming.affine_feedback import AffineFeedback, ReachableSet
from hysdel_py.errors import ArgumentError

__all__ = ["AnalyticalDp"]

Matrix = NDArray[np.float64]

DEPENDENT = 1e-9
"""Singular values of C B, C with rows of length one, below this share of the norm of B are zero."""
DEFINITE = 1e-12
"""Least eigenvalue of the Hessian of a stage, as a share of the largest entry, that counts as positive."""


@dataclass(frozen=True, eq=False)
class AnalyticalDp:
    """A linear system with quadratic cost over N steps; all arrays as in the equations of the module.

    Attributes
    ----------
    A, B, d : arrays of shapes (nx, nx), (nx, nu), (nx,)
    Q, R, S : arrays of shapes (nx, nx), (nu, nu), (nx, nu)
        Symmetric Q and R; they may be indefinite where the problem as a whole has a minimum.
    q, r : arrays of shapes (nx,), (nu,)
    P, p : arrays of shapes (nx, nx), (nx,)
        End cost.
    C, c : arrays of shapes (m, nx), (m,)
        Terminal equality.
    stages : int
    names : mapping, optional
        ``{"x": (...), "u": (...)}``, for messages and text.

    Raises
    ------
    ArgumentError
        Wrong shapes, entries that are not finite, matrices that are not symmetric.
    """

    A: Matrix
    B: Matrix
    stages: int
    Q: ArrayLike
    R: ArrayLike
    S: ArrayLike | None = None
    d: ArrayLike | None = None
    q: ArrayLike | None = None
    r: ArrayLike | None = None
    P: ArrayLike | None = None
    p: ArrayLike | None = None
    C: ArrayLike | None = None
    c: ArrayLike | None = None
    names: Mapping[str, tuple[str, ...]] | None = None

    def __post_init__(self) -> None:
        A = np.atleast_2d(np.array(self.A, dtype=float))
        nx, B = len(A), np.array(self.B, dtype=float)
        nu = B.shape[1] if B.ndim == 2 else 0
        if nx == 0 or nu == 0:
            raise ArgumentError(f"A has shape {A.shape} and B {B.shape}: (nx, nx) and (nx, nu) were expected")
        m = 0 if self.C is None else np.atleast_2d(np.asarray(self.C, dtype=float)).shape[0]
        shapes = {
            "A": (nx, nx), "B": (nx, nu), "Q": (nx, nx), "R": (nu, nu), "S": (nx, nu), "d": (nx,), "q": (nx,),
            "r": (nu,), "P": (nx, nx), "p": (nx,), "C": (m, nx), "c": (m,),
        }  # fmt: skip
        for name, shape in shapes.items():
            object.__setattr__(self, name, _array(getattr(self, name), shape, name))
        for name in ("Q", "R", "P"):
            _require_symmetric(getattr(self, name), name)
        if isinstance(self.stages, bool) or self.stages != int(self.stages) or self.stages < 1:
            raise ArgumentError(f"stages is {self.stages}: a whole number of at least 1 was expected")

    @classmethod
    def from_continuous(
        cls, A: ArrayLike, B: ArrayLike, sample_time: float, d: ArrayLike | None = None, **more: Any
    ) -> AnalyticalDp:
        """Sample ``x' = A x + B u + d`` with inputs that are held; other arguments as for the constructor."""
        from scipy.linalg import expm

        A, B = np.atleast_2d(np.asarray(A, dtype=float)), np.asarray(B, dtype=float)
        nx, nu = B.shape
        drift = np.zeros(nx) if d is None else np.asarray(d, dtype=float)
        block = np.zeros((nx + nu + 1, nx + nu + 1))
        block[:nx, :nx], block[:nx, nx : nx + nu], block[:nx, -1] = A, B, drift
        sampled = expm(block * sample_time)
        return cls(sampled[:nx, :nx], sampled[:nx, nx : nx + nu], d=sampled[:nx, -1], **more)

    def solve(self) -> AffineFeedback:
        """The feedback ``u_k = K_k x_k + k_k`` and the cost to go of every stage.

        Raises
        ------
        ArgumentError
            The second-order condition fails at some stage: the cost has no minimum, and the message says where.
        """
        P, p, constant = np.asarray(self.P), np.asarray(self.p), 0.0
        reach = ReachableSet(np.asarray(self.C), np.asarray(self.c)).reduced()
        gains, offsets, values, sets = [], [], [(P, p, constant)], [reach]
        for k in reversed(range(self.stages)):
            K, offset, reach = self._law(k, P, p, reach)
            P, p, constant = self._cost_to_go(P, p, constant, K, offset)
            gains.append(K)
            offsets.append(offset)
            values.append((P, p, constant))
            sets.append(reach)
        return AffineFeedback(
            np.array(gains[::-1]), np.array(offsets[::-1]), tuple(values[::-1]), tuple(sets[::-1]), self
        )  # fmt: skip

    def _law(self, k: int, P: Matrix, p: Matrix, reach: ReachableSet) -> tuple[Matrix, Matrix, ReachableSet]:
        """The feedback of one stage, from the cost to go and the equality after it."""
        A, B, d = np.asarray(self.A), np.asarray(self.B), np.asarray(self.d)
        H = np.asarray(self.R) + B.T @ P @ B
        F = np.asarray(self.S).T + B.T @ P @ A
        f = np.asarray(self.r) + B.T @ (P @ d + p)
        N, E, e = reach.C @ B, reach.C @ A, reach.C @ d + reach.c
        forced, free, remaining = _split(N, float(np.linalg.norm(B, 2)))
        Ky, ky = -forced @ E, -forced @ e
        Z = free.T @ H @ free
        self._require_definite(k, Z, H)
        step = np.linalg.solve(Z, free.T) if free.size else np.zeros((0, len(H)))
        K, offset = Ky - free @ step @ (F + H @ Ky), ky - free @ step @ (f + H @ ky)
        return K, offset, ReachableSet(remaining.T @ E, remaining.T @ e).reduced()

    def _cost_to_go(self, P: Matrix, p: Matrix, constant: float, K: Matrix, k: Matrix) -> tuple[Matrix, Matrix, float]:
        A, B, d = np.asarray(self.A), np.asarray(self.B), np.asarray(self.d)
        Q, R, S, q, r = (np.asarray(getattr(self, name)) for name in ("Q", "R", "S", "q", "r"))
        closed, shift = A + B @ K, B @ k + d
        before = Q + S @ K + K.T @ S.T + K.T @ R @ K + closed.T @ P @ closed
        linear = q + S @ k + K.T @ (R @ k + r) + closed.T @ (P @ shift + p)
        number = constant + 0.5 * k @ R @ k + r @ k + 0.5 * shift @ P @ shift + p @ shift
        return 0.5 * (before + before.T), linear, float(number)

    def _require_definite(self, k: int, Z: Matrix, H: Matrix) -> None:
        if not Z.size:
            return
        least = float(np.linalg.eigvalsh(0.5 * (Z + Z.T))[0])
        if least <= DEFINITE * max(float(np.abs(H).max()), 1e-300):
            raise ArgumentError(
                f"the cost has no unique minimum: at stage {k} the second derivative by the inputs, R + B'P B on the "
                f"inputs that the terminal equality leaves free, has the eigenvalue {least:.3g} where a positive one "
                "was expected; give every input a weight in R"
            )


def _split(N: Matrix, size: float) -> tuple[Matrix, Matrix, Matrix]:
    """Pseudo-inverse of N, basis of its null space, and basis of what its columns do not reach."""
    if not N.shape[0]:
        return np.zeros((N.shape[1], 0)), np.eye(N.shape[1]), np.zeros((0, 0))
    U, s, Vt = np.linalg.svd(N)
    rank = int((s > DEPENDENT * size).sum())
    inverse = Vt[:rank].T @ np.diag(1.0 / s[:rank]) @ U[:, :rank].T
    return inverse, Vt[rank:].T, U[:, rank:]


def _array(value: Any, shape: tuple[int, ...], name: str) -> Matrix:
    array = np.zeros(shape) if value is None else np.array(value, dtype=float)
    if array.ndim < len(shape):
        array = np.atleast_2d(array) if len(shape) == 2 else np.atleast_1d(array)
    if array.shape != shape:
        raise ArgumentError(f"{name} has shape {array.shape}: {shape} was expected")
    if not np.isfinite(array).all():
        raise ArgumentError(f"{name} has an entry that is not a finite number")
    array.flags.writeable = False
    return array


def _require_symmetric(matrix: Matrix, name: str) -> None:
    if np.abs(matrix - matrix.T).max(initial=0.0) > 1e-12 * np.abs(matrix).max(initial=1e-300):
        raise ArgumentError(f"{name} is not symmetric: pass ({name} + {name}')/2, the cost stays the same")
