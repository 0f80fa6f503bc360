"""The friction law of many contacts as a linear complementarity problem, decomposed in three ways.

The slips after a step are ``gamma = G P + c`` with impulses (or, on acceleration level, torques) ``lo <= P <= hi``;
gamma is zero where P is inside, not negative at the lower limit, not positive at the upper one.

* Leine and Nijmeijer (Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004), 2 unknowns per contact,
  z = (hi - P, gamma+), w = (gamma-, P - lo):  ``M = [[G, I], [-I, 0]],  q = [-c - G hi, hi - lo]``
* Pfeiffer and Glocker, 4 unknowns per contact, z = (P+, P-, gamma-, gamma+), w = (.., .., hi - P+, -lo - P-):
  ``M = [[G, -G, I, 0], [-G, G, 0, I], [-I, 0, 0, 0], [0, -I, 0, 0]],  q = [c, -c, hi, -lo]``
  (Multibody Dynamics with Unilateral Contacts, 1996)
* boxed: P itself, with two bounds.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.kernels.banded import DEPENDENT
from hysdel_py.drivetrain.kernels.box import solve_box
from hysdel_py.drivetrain.structure import delassus_of_matrix
from hysdel_py.optimize.lcp.problem import LcpResult
from hysdel_py.optimize.lcp.solve import LcpMethod, solve_boxed_lcp, solve_lcp

__all__ = ["ContactSolver", "friction_lcp", "torques_from"]

Matrix = NDArray[np.float64]


def friction_lcp(decomposition: str, G: Matrix, c: Matrix, lo: Matrix, hi: Matrix) -> tuple[Matrix, Matrix]:
    """Matrix and vector of the LCP; `decomposition` is ``"leine-nijmeijer"`` or ``"pfeiffer-glocker"``."""
    one, zero = np.eye(len(c)), np.zeros((len(c), len(c)))
    if decomposition == "leine-nijmeijer":
        return np.block([[G, one], [-one, zero]]), np.concatenate([-c - G @ hi, hi - lo])
    M = np.block([[G, -G, one, zero], [-G, G, zero, one], [-one, zero, zero, zero], [zero, -one, zero, zero]])
    return M, np.concatenate([c, -c, hi, -lo])


def torques_from(decomposition: str, z: Matrix, hi: Matrix) -> Matrix:
    """P from a solution of the LCP."""
    n = len(hi)
    if decomposition == "leine-nijmeijer":
        return hi - z[:n]
    return z[:n] - z[n : 2 * n]


@dataclass(slots=True)
class ContactSolver:
    """Solves one contact problem after another, each from the answer of the one before.

    Attributes
    ----------
    decomposition, method : str
        As in the options of the schemes.
    solves, iterations, failures : int
        Problems solved, their iterations, and problems that the method could not solve; those were handed to the
        active-set solver.
    """

    decomposition: str
    method: str
    solves: int = 0
    iterations: int = 0
    failures: int = 0
    _warm: LcpResult | None = field(default=None, repr=False)

    def __call__(self, G: Matrix, c: Matrix, lo: Matrix, hi: Matrix) -> Matrix:
        """Torques or impulses P."""
        return self._answer(self.method, G, c, lo, hi)

    def in_order(self, G: Matrix, c: Matrix, lo: Matrix, hi: Matrix) -> Matrix:
        """The same, but where contacts are redundant the first of them take what they can.

        That is how an integration shares a torque among contacts that stick; another answer would contradict it.
        """
        method = "active-set" if _is_redundant(G) else self.method
        return self._answer(method, G, c, lo, hi)

    def _answer(self, method: str, G: Matrix, c: Matrix, lo: Matrix, hi: Matrix) -> Matrix:
        self.solves += 1
        if method != "active-set" and len(c):
            found = self._by_lcp(G, c, lo, hi)
            if found is not None:
                return found
            self.failures += 1
        P = np.clip(np.zeros(len(c)), lo, hi)
        spent = solve_box(delassus_of_matrix(G), c, lo, hi, P)
        self.iterations += max(spent, 0)
        return P

    def _by_lcp(self, G: Matrix, c: Matrix, lo: Matrix, hi: Matrix) -> Matrix | None:
        method: LcpMethod = self.method  # type: ignore[assignment]
        if self.decomposition == "boxed":
            answer = solve_boxed_lcp(G, c, lo, hi, method, warm=self._fitting(len(c)))
        else:
            M, q = friction_lcp(self.decomposition, G, c, lo, hi)
            answer = solve_lcp(M, q, method, warm=self._fitting(len(q)))
        self.iterations += answer.iterations
        if not answer.solved:
            return None
        self._warm = answer
        z = np.asarray(answer.z)
        return np.clip(z if self.decomposition == "boxed" else torques_from(self.decomposition, z, hi), lo, hi)

    def _fitting(self, size: int) -> LcpResult | None:
        return self._warm if self._warm is not None and len(self._warm.z) == size else None


def _is_redundant(G: Matrix) -> bool:
    """Whether some slips depend on others."""
    size = np.sqrt(np.diag(G))
    values = np.linalg.eigvalsh(G / np.outer(size, size))
    return bool(len(values) > 1 and values[0] <= len(values) * DEPENDENT)
