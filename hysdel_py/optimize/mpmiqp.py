"""Multi-parametric mixed-integer programs: one multi-parametric program for each sequence of the binaries.

The sequences are enumerated stage by stage, and those that no parameter can have are given up early. What remains may
overlap: the optimum at a parameter is the least value among the sequences whose maps hold it (V. Dua, N. Bozinis and
E. Pistikopoulos, "A multiparametric programming approach for mixed-integer quadratic engineering problems", Computers
and Chemical Engineering 26, 2002; F. Borrelli, M. Baotić, A. Bemporad and M. Morari, "Dynamic programming for
constrained optimal control of discrete-time linear hybrid systems", Automatica 41, 2005).
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from time import perf_counter

from hysdel_py.optimize.mixed_parametric.exploration import Progress, Search
from hysdel_py.optimize.mixed_parametric.piece import Piece
from hysdel_py.optimize.mixed_parametric.problem import MpMiqp
from hysdel_py.optimize.mixed_parametric.settings import MpMiqpSettings
from hysdel_py.optimize.parametric.exploration import Stop

__all__ = ["MixedParametricSolution", "MpMiqp", "MpMiqpSettings", "Piece", "solve_mpmiqp"]


@dataclass(frozen=True, eq=False, slots=True)
class MixedParametricSolution:
    """Maps of all sequences.

    Attributes
    ----------
    problem : MpMiqp
    pieces : tuple of Piece
        By their sequences, in rising order; the same for every executor.
    complete : bool
        Whether every sequence was given up with a reason or solved completely. Sequences whose parameters fill no
        volume have no map.
    stop : Stop
    tried, propagated, infeasible, flat, solved : int
        Sequences looked at, partial ones included; those cut off by propagation, by their rows, because their
        parameters fill no volume; and sequences of full length whose program was solved.
    seconds : float
    """

    problem: MpMiqp
    pieces: tuple[Piece, ...]
    complete: bool
    stop: Stop
    tried: int
    propagated: int
    infeasible: int
    flat: int
    solved: int
    seconds: float


def solve_mpmiqp(
    problem: MpMiqp,
    settings: MpMiqpSettings | None = None,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> MixedParametricSolution:
    """Find the maps of all sequences of binaries.

    Parameters
    ----------
    problem : MpMiqp
    settings : MpMiqpSettings, optional
    executor : Executor, optional
        Anything with the ``submit`` of ``concurrent.futures``; the answer does not depend on it.
    progress : callable, optional
        Called with the numbers of sequences solved, of their regions, and of sequences waiting.

    Returns
    -------
    MixedParametricSolution
        Incomplete after a limit or an interrupt, with the maps of the sequences solved until then.
    """
    started = perf_counter()
    search = Search(problem, settings or MpMiqpSettings(), executor, progress)
    stop = search.run()
    pieces = tuple(search.pieces[word] for word in sorted(search.pieces))
    complete = stop is Stop.DONE and all(piece.solution.complete for piece in pieces)
    return MixedParametricSolution(
        problem,
        tuple(piece for piece in pieces if piece.regions),
        complete,
        stop,
        search.tried,
        search.propagated,
        search.infeasible,
        search.flat,
        search.complete,
        perf_counter() - started,
    )
