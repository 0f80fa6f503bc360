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
from math import log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.kernels.banded import DEPENDENT
from hysdel_py.drivetrain.kernels.box import solve_box
from hysdel_py.drivetrain.kernels.time_stepping import AT_LIMIT
from hysdel_py.drivetrain.structure import delassus_of_matrix
from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.lcp.problem import Lcp, LcpResult, LcpSettings
from hysdel_py.optimize.lcp.solve import LcpMethod, solve_problem

__all__ = ["ContactSolver", "friction_lcp", "independent_contacts", "torques_from"]

Matrix = NDArray[np.float64]


def friction_lcp(decomposition: str, G: Matrix, c: Matrix, lo: Matrix, hi: Matrix) -> tuple[Matrix, Matrix]:
    """Matrix and vector of the LCP; `decomposition` is ``"leine-nijmeijer"`` or ``"pfeiffer-glocker"``."""
    return _matrix(decomposition, G), _vector(decomposition, G, c, lo, hi)


def _matrix(decomposition: str, G: Matrix) -> Matrix:
    one, zero = np.eye(len(G)), np.zeros(G.shape)
    if decomposition == "leine-nijmeijer":
        return np.block([[G, one], [-one, zero]])
    return np.block([[G, -G, one, zero], [-G, G, zero, one], [-one, zero, zero, zero], [zero, -one, zero, zero]])


def _vector(decomposition: str, G: Matrix, c: Matrix, lo: Matrix, hi: Matrix) -> Matrix:
    if decomposition == "leine-nijmeijer":
        return np.concatenate([-c - G @ hi, hi - lo])
    return np.concatenate([c, -c, hi, -lo])


def torques_from(decomposition: str, z: Matrix, hi: Matrix) -> Matrix:
    """P from a solution of the LCP."""
    n = len(hi)
    if decomposition == "leine-nijmeijer":
        return hi - z[:n]
    return z[:n] - z[n : 2 * n]


MODES = {"boxed": 3, "leine-nijmeijer": 4, "pfeiffer-glocker": 16}
"""Modes of one contact."""

SPARSE_FROM, SPARSE_SHARE = 100, 0.1
"""Size of a matrix, and share of its entries that are not zero, from and up to which it is kept in compressed rows."""

MOST_MODES = LcpSettings().modes


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
    _known: tuple[Matrix, Lcp] | None = field(default=None, repr=False)

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
        self._check_size(len(c))
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

    def _check_size(self, contacts: int) -> None:
        """Refuse an enumeration that could not be finished.

        Raises
        ------
        ArgumentError
            The contacts have more modes than are ever tried.
        """
        each = MODES[self.decomposition]
        most = int(log(MOST_MODES) / log(each))
        if self.method == "enumerative" and contacts > most:
            raise ArgumentError(
                f"solver is enumerative: {contacts} contacts have {each}^{contacts} modes ({self.decomposition}), and "
                f'at most {most} contacts can be enumerated: take solver="active-set" or "newton"'
            )

    def _by_lcp(self, G: Matrix, c: Matrix, lo: Matrix, hi: Matrix) -> Matrix | None:
        method: LcpMethod = self.method  # type: ignore[assignment]
        problem = self._problem(G, c, lo, hi)
        answer = solve_problem(problem, method, self._fitting(problem.n))
        self.iterations += answer.iterations
        if not answer.solved:
            return None
        self._warm = answer
        z = np.asarray(answer.z)
        return _at_limits(z if self.decomposition == "boxed" else torques_from(self.decomposition, z, hi), lo, hi)

    def _problem(self, G: Matrix, c: Matrix, lo: Matrix, hi: Matrix) -> Lcp:
        """The problem; its matrix is checked and scaled once as long as G is the same object."""
        boxed = self.decomposition == "boxed"
        q = c if boxed else _vector(self.decomposition, G, c, lo, hi)
        low, high = (lo, hi) if boxed else (np.zeros(len(q)), np.full(len(q), np.inf))
        if self._known is None or self._known[0] is not G:
            M = G if boxed else _matrix(self.decomposition, G)
            self._known = (G, Lcp(_compressed(M), q, low, high))
        return self._known[1].with_vectors(q, low, high)

    def _fitting(self, size: int) -> LcpResult | None:
        return self._warm if self._warm is not None and len(self._warm.z) == size else None


def _at_limits(P: Matrix, lo: Matrix, hi: Matrix) -> Matrix:
    """P inside its limits, and on one where rounding alone keeps it off: a sliding contact must not seem to stick."""
    margin = AT_LIMIT * (hi - lo)
    found: Matrix = np.where(lo + margin >= P, lo, np.where(hi - margin <= P, hi, P))
    return found


def _compressed(M: Matrix) -> Any:
    """A matrix in compressed rows where it is large and mostly zero."""
    if len(M) < SPARSE_FROM or np.count_nonzero(M) > SPARSE_SHARE * M.size:
        return M
    from scipy.sparse import csr_array

    return csr_array(M)


def independent_contacts(G: Matrix, index: NDArray[np.int64]) -> NDArray[np.int64]:
    """The contacts in `index` without those whose slips depend on contacts before them."""
    if len(index) == 0 or not _is_redundant(G[np.ix_(index, index)]):
        return index
    kept: list[int] = []
    for i in index.tolist():
        rest = G[i, i] - G[i, kept] @ np.linalg.solve(G[np.ix_(kept, kept)], G[kept, i])
        if rest > DEPENDENT * G[i, i]:
            kept.append(i)
    return np.array(kept, dtype=np.int64)


def _is_redundant(G: Matrix) -> bool:
    """Whether some slips depend on others."""
    size = np.sqrt(np.diag(G))
    values = np.linalg.eigvalsh(G / np.outer(size, size))
    return bool(len(values) > 1 and values[0] <= len(values) * DEPENDENT)
