"""Multi-parametric quadratic and linear programs: all critical regions."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.parametric.atlas import Atlas
from hysdel_py.optimize.parametric.beyond import Verdict
from hysdel_py.optimize.parametric.canonical import Canonical
from hysdel_py.optimize.parametric.exploration import Exploration, Progress, Stop
from hysdel_py.optimize.parametric.neighbours import ActiveSet
from hysdel_py.optimize.parametric.problem import MpQp
from hysdel_py.optimize.parametric.reduction import canonical_form
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["CriticalRegion", "MpQp", "MpQpSettings", "ParametricSolution", "solve_mpqp"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class CriticalRegion:
    """Where one affine law is optimal.

    Attributes
    ----------
    A, b : arrays of shapes (r, p), (r,)
        ``A theta <= b``, irredundant, rows of length one.
    K, k : arrays of shapes (n, p), (n,)
        ``z = K theta + k``.
    P, q, r : arrays of shapes (p, p), (p,) and a number
        Value ``1/2 theta'P theta + q'theta + r``.
    active : tuple of int
        Rows of the problem that hold with equality.
    centre : array of shape (p,)
        An inner point.
    """

    A: Matrix
    b: Vector
    K: Matrix
    k: Vector
    P: Matrix
    q: Vector
    r: float
    active: ActiveSet
    centre: Vector


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class ParametricSolution:
    """Map of a multi-parametric program.

    Attributes
    ----------
    problem : MpQp
    regions : tuple of CriticalRegion
        By the sizes of their active sets, then by the sets; the same for every executor.
    complete : bool
        Whether beyond every facet lies a stored region, an infeasible point or the end of the domain.
    stop : Stop
    open_facets : int
        Facets beyond which nothing is known.
    unclear : int
        Active sets that were not settled numerically.
    explored : int
        Active sets looked at.
    points : int
        Single values of theta solved beyond facets.
    seconds : float
    """

    problem: MpQp
    regions: tuple[CriticalRegion, ...]
    complete: bool
    stop: Stop
    open_facets: int
    unclear: int
    explored: int
    points: int
    seconds: float

    def __repr__(self) -> str:
        state = "complete" if self.complete else f"incomplete, {self.stop.value}"
        return f"<ParametricSolution: {len(self.regions)} regions, {state}>"


def solve_mpqp(
    problem: MpQp,
    settings: MpQpSettings | None = None,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> ParametricSolution:
    """Find all critical regions.

    Parameters
    ----------
    problem : MpQp
    settings : MpQpSettings, optional
    executor : Executor, optional
        Anything with the ``submit`` of ``concurrent.futures``; the answer does not depend on it.
    progress : callable, optional
        Called with the numbers of regions found and of active sets waiting.

    Returns
    -------
    ParametricSolution
        Incomplete after a limit or an interrupt, with what had been found.

    Raises
    ------
    ArgumentError
        The parameters are not a bounded polyhedron with inner points, or H is not positive semidefinite.
    """
    started = perf_counter()
    chosen = settings or MpQpSettings()
    form = canonical_form(problem, chosen)
    if form is None:
        return ParametricSolution(problem, (), True, Stop.DONE, 0, 0, 0, 0, perf_counter() - started)
    run = Exploration(form, chosen, executor, progress, started)
    stop = run.run()
    regions = _critical_regions(problem, form, run)
    open_facets = sum(verdict is Verdict.OPEN for verdict in run.verdicts.values())
    complete = stop is Stop.DONE and not open_facets and not run.unclear
    seconds = perf_counter() - started
    return ParametricSolution(
        problem, regions, complete, stop, open_facets, run.unclear, run.frontier.count, run.points, seconds
    )


def _critical_regions(problem: MpQp, form: Canonical, run: Exploration) -> tuple[CriticalRegion, ...]:
    """Regions in the problem's own variables and parameters, in the order of their active sets; all at once."""
    atlas = run.atlas
    if atlas is None:
        return ()
    laws = form.back @ atlas.laws[:, :, :-1] + form.shift
    K = laws[:, :, 1:] / form.half
    k = laws[:, :, 0] - K @ form.centre
    P, q, r = _values(problem, K, k)
    values = r.tolist()
    A, b = _rows(form, atlas)
    centres = form.unscaled(atlas.centres)
    starts = atlas.starts.tolist()
    active = _active_sets(form, run.frontier.sets[atlas.sets])
    order = sorted(range(len(active)), key=lambda i: (len(active[i]), active[i]))
    return tuple(
        CriticalRegion(
            A[starts[i] : starts[i + 1]],
            b[starts[i] : starts[i + 1]],
            K[i],
            k[i],
            P[i],
            q[i],
            values[i],
            active[i],
            centres[i],
        )
        for i in order
    )


def _rows(form: Canonical, atlas: Atlas) -> tuple[Matrix, Vector]:
    A = atlas.N / form.half
    b = atlas.h + A @ form.centre
    length = np.sqrt((A * A).sum(axis=1))
    return A / length[:, None], b / length


def _active_sets(form: Canonical, sets: NDArray[np.int64]) -> list[ActiveSet]:
    """Rows as stated of sets that are padded with -1."""
    stated = np.append(form.rows, -1)[sets].tolist()
    sizes = (sets >= 0).sum(axis=1).tolist()
    return [tuple(row[:size]) for row, size in zip(stated, sizes, strict=True)]


def _values(problem: MpQp, K: Matrix, k: Matrix) -> tuple[Matrix, Matrix, Vector]:
    """Coefficients of the objective along ``z = K theta + k``, for stacks of laws."""
    assert problem.Y is not None
    assert problem.y is not None
    across = K.swapaxes(1, 2)
    cross = problem.F.T @ K
    P = across @ problem.H @ K + cross + cross.swapaxes(1, 2) + problem.Y
    pull = k @ problem.H + problem.f
    q = (across @ pull[:, :, None])[:, :, 0] + k @ problem.F + problem.y
    r = 0.5 * ((k @ problem.H) * k).sum(axis=1) + k @ problem.f + problem.constant
    return (P + P.swapaxes(1, 2)) / 2, q, r
