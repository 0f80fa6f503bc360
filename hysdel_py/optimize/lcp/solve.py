"""Entry points: choose a method, scale, solve, judge."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.lcp.checks import numbers
from hysdel_py.optimize.lcp.enumerative import enumerate_modes, mode_count
from hysdel_py.optimize.lcp.gauss_seidel import sweep
from hysdel_py.optimize.lcp.lemke import follow_path
from hysdel_py.optimize.lcp.newton import newton
from hysdel_py.optimize.lcp.problem import Lcp, LcpResult, LcpSettings, LcpStatus, residual, states_of

__all__ = ["Lcp", "LcpMethod", "LcpResult", "LcpSettings", "LcpStatus", "solve_boxed_lcp", "solve_lcp", "solve_problem"]

Vector = NDArray[np.float64]
LcpMethod: TypeAlias = Literal["auto", "enumerative", "lemke", "pgs", "newton"]
Answer = tuple[LcpStatus, Vector, int]

FEW_MODES = 32
"""Up to this many modes "auto" tries them all."""
ALL_MODES = 4096
"""Up to this many modes "auto" tries them all in the end."""
LARGEST_TABLEAU = 1000
"""Up to this many rows "auto" asks Lemke's method after another one has failed."""


def solve_lcp(
    M: ArrayLike | Any,
    q: ArrayLike,
    method: LcpMethod = "auto",
    warm: LcpResult | ArrayLike | None = None,
    *,
    settings: LcpSettings | None = None,
) -> LcpResult:
    """Solve ``w = M z + q,  w >= 0,  z >= 0,  z'w = 0``.

    Parameters
    ----------
    M : array_like of shape (n, n), or sparse array
    q : array_like of shape (n,)
    method : {"auto", "enumerative", "lemke", "pgs", "newton"}
        "auto" enumerates where there are few modes, takes Newton's method for a symmetric matrix and Lemke's for any
        other, and asks the other one where the first fails. docs/lcp.md says what each can.
    warm : LcpResult or array_like of shape (n,), optional
        An answer to a similar problem, or a guess of z. Enumeration and Lemke's method start from its mode.
    settings : LcpSettings, optional

    Returns
    -------
    LcpResult
        Never assumed solved: the status is SOLVED only if the residual of z is small.

    Raises
    ------
    ArgumentError
        Wrong shapes, entries that are not finite, an unknown method.

    Examples
    --------
    >>> answer = solve_lcp([[2, 1], [1, 2]], [-5, -6])
    >>> [round(float(z), 6) for z in answer.z]
    [1.333333, 2.333333]
    """
    return solve_boxed_lcp(M, q, 0.0, np.inf, method, warm=warm, settings=settings)


def solve_boxed_lcp(
    M: ArrayLike | Any,
    q: ArrayLike,
    lo: ArrayLike,
    hi: ArrayLike,
    method: LcpMethod = "auto",
    *,
    warm: LcpResult | ArrayLike | None = None,
    settings: LcpSettings | None = None,
) -> LcpResult:
    """Solve ``w = M z + q`` with ``w >= 0`` where ``z = lo``, ``w <= 0`` where ``z = hi``, ``w = 0`` in between.

    For Coulomb friction with impulses P up to F and relative velocities ``gamma = G P + c``, in which P lies in
    ``-F Sign(gamma)``, this is the problem with ``M = G, q = c, lo = -F, hi = F``.

    Parameters
    ----------
    lo, hi : array_like of shape (n,), or numbers
        May be infinite; ``lo <= hi``.
    M, q, method, warm, settings
        As for :func:`solve_lcp`. Lemke's method needs one finite bound per unknown.

    Returns
    -------
    LcpResult

    Raises
    ------
    ArgumentError
        As for :func:`solve_lcp`, or bounds that cross.
    """
    return solve_problem(Lcp(M, numbers(q, "q"), numbers(lo, "lo"), numbers(hi, "hi")), method, warm, settings=settings)


def solve_problem(
    problem: Lcp,
    method: LcpMethod = "auto",
    warm: LcpResult | ArrayLike | None = None,
    *,
    settings: LcpSettings | None = None,
) -> LcpResult:
    """Solve a problem that is already checked; for many problems with one matrix see :meth:`Lcp.with_vectors`."""
    if method not in get_args(LcpMethod):
        raise ArgumentError(f"method is {method!r}: one of {', '.join(get_args(LcpMethod))} was expected")
    guess = _guess(problem, warm)
    settings = settings or LcpSettings()
    if method != "auto":
        return _answered(problem, method, guess, settings)
    return _first_solved(problem, _methods(problem), guess, settings)


def _first_solved(
    problem: Lcp, methods: tuple[LcpMethod, ...], guess: Vector | None, settings: LcpSettings
) -> LcpResult:
    """The first answer that settles the problem; the last one where none does."""
    for method in methods:
        result = _answered(problem, method, guess, settings)
        if result.status in (LcpStatus.SOLVED, LcpStatus.NO_SOLUTION):
            break
    return result


def _methods(problem: Lcp) -> tuple[LcpMethod, ...]:
    if mode_count(problem) <= FEW_MODES:
        return ("enumerative",)
    last: tuple[LcpMethod, ...] = ("enumerative",) if mode_count(problem) <= ALL_MODES else ()
    sides = np.isfinite(problem.lo).astype(int) + np.isfinite(problem.hi)
    if (sides == 0).any() or sides.sum() > LARGEST_TABLEAU:
        return ("newton", *last)
    return ("newton", "lemke", *last) if problem.is_symmetric else ("lemke", "newton", *last)


def _answered(problem: Lcp, method: LcpMethod, guess: Vector | None, settings: LcpSettings) -> LcpResult:
    """Solve the scaled problem and judge the answer in the same way for every method."""
    scaled, unit = problem.scaled, problem.d * problem.size
    start = None if guess is None else guess / unit
    status, x, iterations = _SOLVE[method](scaled, start, settings)
    z = np.clip(x, scaled.lo, scaled.hi) * unit
    w = problem.M @ z + problem.q
    error = residual(problem, z)
    if status is LcpStatus.SOLVED and not error <= settings.tolerance:
        status = LcpStatus.NUMERICAL
    if status is LcpStatus.NO_SOLUTION and error <= settings.tolerance:
        status = LcpStatus.SOLVED
    mode = states_of(scaled, x, scaled.M @ x + scaled.q)
    for array in (z, w, mode):
        array.flags.writeable = False
    message = f"{method}: {_WORDS[status].format(iterations=iterations, residual=error)}"
    return LcpResult(z, w, status, error, iterations, mode, method, message)


def _cold(problem: Lcp, guess: Vector | None) -> Vector:
    """The guess, or the point of the bounds that is nearest to zero."""
    return np.clip(np.zeros(problem.n), problem.lo, problem.hi) if guess is None else guess


_SOLVE: dict[str, Callable[[Lcp, Vector | None, LcpSettings], Answer]] = {
    "enumerative": lambda problem, guess, settings: enumerate_modes(problem, _cold(problem, guess), settings),
    "lemke": follow_path,
    "pgs": lambda problem, guess, settings: sweep(problem, _cold(problem, guess), settings),
    "newton": lambda problem, guess, settings: newton(problem, _cold(problem, guess), settings),
}

_WORDS = {
    LcpStatus.SOLVED: "solved after {iterations} iterations, residual {residual:.2g}",
    LcpStatus.NO_SOLUTION: "there is no solution, proven after {iterations} iterations",
    LcpStatus.RAY: "the path went to infinity after {iterations} pivots; if M is positive semidefinite, or copositive "
    "plus, there is no solution, else another method may find one",
    LcpStatus.ITERATION_LIMIT: "not solved after {iterations} iterations, residual {residual:.2g}; allow more of them "
    "in the settings, or take another method",
    LcpStatus.SINGULAR: "stopped at a singular block after {iterations} iterations, residual {residual:.2g}; take "
    'method="lemke"',
    LcpStatus.NUMERICAL: "the answer has a residual of {residual:.2g}, above the tolerance; the problem may be badly "
    "conditioned",
}


def _guess(problem: Lcp, warm: LcpResult | ArrayLike | None) -> Vector | None:
    if warm is None:
        return None
    z = numbers(warm.z if isinstance(warm, LcpResult) else warm, "warm")
    if z.shape != (problem.n,):
        raise ArgumentError(f"warm has shape {z.shape}: {(problem.n,)} was expected, as q has {problem.n} entries")
    return z if np.isfinite(z).all() else None
