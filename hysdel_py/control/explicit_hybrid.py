"""From a hybrid controller to its explicit law."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.construction import checked, checked_callable
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.explicit_parameters import Parameters, choose_parameters
from hysdel_py.control.explicit_program import columns_of_plan, parametric_program
from hysdel_py.control.formulation import Formulation
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.hybrid_sequences import SearchReport, SequenceLaw
from hysdel_py.control.weights import Norm
from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.mixed_parametric.exploration import Progress
from hysdel_py.optimize.mpmiqp import MixedParametricSolution, MpMiqpSettings, Piece, solve_mpmiqp
from hysdel_py.optimize.parametric.exploration import Stop

__all__ = ["explicit_hybrid"]

_NORMS = {Norm.SQUARES: "2", Norm.SUM: "1"}


def explicit_hybrid(
    mpc: HybridMpc,
    box: Mapping[str, Any] | None = None,
    *,
    fixed: Mapping[str, float] | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
    settings: MpMiqpSettings | None = None,
    reduce: bool = True,
) -> HybridLaw:
    """Solve a hybrid controller for all its parameters at once.

    The sequences of its switches are enumerated stage by stage, those that no parameter of the box can have are given
    up, and each remaining one is solved as a multi-parametric quadratic (norm 2) or linear program.

    Parameters
    ----------
    mpc : HybridMpc
    box : mapping of name to (low, high)
        Ranges of the parameters: the states by their names, ``u(-1)`` for an input u applied last where increments are
        weighed or limited, and ``r(y)`` for the reference of y. Where only one parameter goes with a signal, the
        signal's name will do. States and last inputs have their declared ranges by default. References are constant
        over the horizon.
    fixed : mapping of name to number
        Parameters that are put in as numbers.
    executor : Executor, optional
        Anything with the ``submit`` of ``concurrent.futures``; the law does not depend on it.
    progress : callable, optional
        Called with the numbers of sequences solved, of their regions, and of sequences waiting.
    settings : MpMiqpSettings, optional
        Among others the limits ``seconds`` and ``sequences``.
    reduce : bool
        Whether to remove what is never best: for the norms 1 and infinity regions of different sequences then do not
        overlap.

    Returns
    -------
    HybridLaw
        After a limit or Ctrl-C with the sequences solved until then, and ``complete`` false.

    Raises
    ------
    ArgumentError
        An unknown parameter, one without a bounded box, nothing left to solve for.
    """
    checked(mpc, HybridMpc, "controller")
    checked_callable(progress, "progress")
    checked(MpMiqpSettings() if settings is None else settings, MpMiqpSettings, "settings")
    if not mpc.mld.nu:
        raise ArgumentError("the model has no inputs: there is nothing that a law could give")
    parameters = choose_parameters(mpc, box, fixed)
    program = parametric_program(mpc.formulation, parameters)
    solution = solve_mpmiqp(program, settings, executor=executor, progress=progress)
    law = _law(mpc, parameters, solution)
    if not reduce:
        return law
    try:
        return law.reduced()
    except KeyboardInterrupt:  # what was found stands as it is; only its overlaps stay
        return replace(law, report=replace(law.report, stop=Stop.INTERRUPTED.value))


def _law(mpc: HybridMpc, parameters: Parameters, solution: MixedParametricSolution) -> HybridLaw:
    f = mpc.formulation
    inputs = _inputs(f) + columns_of_plan(parameters)
    names = tuple(parameter.name for parameter in parameters.real)
    laws = tuple(_sequence_law(piece, inputs, f.layout.mld.nu, names) for piece in solution.pieces)
    return HybridLaw(
        sequences=laws,
        parameters=parameters,
        switches=_switches(f, parameters),
        x=f.layout.mld.x,
        u=f.layout.mld.u,
        references=mpc.references,
        horizon=mpc.horizon,
        norm=_NORMS.get(f.norm, "inf"),
        exact=f.shape.exact,
        complete=solution.complete,
        partition=len(laws) < 2,
        report=SearchReport(
            solution.tried,
            solution.propagated,
            solution.infeasible,
            solution.flat,
            solution.solved,
            sum(law.law.count for law in laws),
            solution.stop.value,
            solution.seconds,
        ),
        sample_time=mpc.sample_time,
    )


def _inputs(f: Formulation) -> NDArray[np.intp]:
    """Decision variables that are inputs, stage after stage."""
    layout = f.layout
    return np.concatenate([layout.start("u", k) + np.arange(layout.mld.nu) for k in range(layout.horizon)])


def _sequence_law(piece: Piece, inputs: NDArray[np.intp], moves: int, names: tuple[str, ...]) -> SequenceLaw:
    """The law of a sequence, with the inputs of the plan as its variables."""
    regions, problem = piece.regions, piece.solution.problem
    K, k = piece.laws(inputs)
    law = ExplicitLaw(
        A=np.vstack([region.A for region in regions]),
        b=np.concatenate([region.b for region in regions]),
        starts=np.cumsum([0, *(len(region.b) for region in regions)]),
        K=K,
        k=k,
        P=np.array([region.P for region in regions]),
        q=np.array([region.q for region in regions]),
        r=np.array([region.r for region in regions], dtype=float),
        active=tuple(region.active for region in regions),
        domain=problem.theta,
        moves=moves,
        names=names,
        complete=piece.solution.complete,
    )
    return SequenceLaw(piece.word, law)


def _switches(f: Formulation, parameters: Parameters) -> tuple[str, ...]:
    """Names of the entries of a word; a state is counted at the time that it has after the stage."""
    own = tuple(parameter.name for parameter in parameters.boolean)
    return (*own, *(_switch(f, int(at)) for at in f.binaries))


def _switch(f: Formulation, at: int) -> str:
    layout = f.layout
    stage, column = divmod(at, layout.stage_size)
    variable = layout.stage_variables[column]
    return f"{variable.name}[{stage + (variable.kind.value == 'x')}]"
