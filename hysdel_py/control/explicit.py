"""Explicit laws of controllers by multi-parametric programming."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from math import isfinite
from typing import TYPE_CHECKING, Any, Literal, cast

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.law_domain import Box, Fixed, domain_of, fixed_values, substitution
from hysdel_py.control.law_signals import LawSignals, check_distinct, last_input_name, reference_name
from hysdel_py.control.linear_mpc import LinearMpc
from hysdel_py.errors import ArgumentError

if TYPE_CHECKING:
    from hysdel_py.control.hybrid_law import HybridLaw
    from hysdel_py.optimize.mpqp import MpQp

__all__ = ["MoveKind", "ParametricController", "explicit", "parametric_controller"]

MoveKind = Literal["increment", "input"]


@dataclass(frozen=True, slots=True, eq=False)
class ParametricController:
    """The program of a controller with its state, last input and references as parameters.

    Attributes
    ----------
    problem : MpQp
        Its first variables are the first move.
    signals : LawSignals
        What the parameters and the move stand for.
    """

    problem: MpQp
    signals: LawSignals


def explicit(
    controller: Any,
    box: Box = None,
    *,
    fixed: Fixed = None,
    move: MoveKind | None = None,
    settings: Any = None,
    executor: Executor | None = None,
    progress: Callable[..., None] | None = None,
) -> ExplicitLaw | HybridLaw:
    """Work out a controller's first move as a piecewise affine function of what it is told.

    Parameters
    ----------
    controller : LinearMpc or HybridMpc
        See :func:`~hysdel_py.control.explicit_hybrid.explicit_hybrid` for what is particular to a hybrid controller.
    box : mapping of parameter to (low, high), pair of vectors, or Polyhedron, optional
        The parameters of interest: states, under their names; the input applied last, ``u(-1)`` for an input u; and
        references, ``r(y)`` for an output y, constant over the horizon. The keys ``"x"``, ``"u"`` and ``"r"`` stand for
        all parameters of a group, with vectors as ends. What is left out takes the range that the model declares, the
        last input also that of its limits.
    fixed : mapping of parameter to number, optional
        Parameters that have one value; the law does not depend on them.
    move : "increment" or "input", optional
        What the law of a tracking controller gives: the change of the input, as by default, or the input.
    settings : MpQpSettings, or MpMiqpSettings for a HybridMpc, optional
        Tolerances and limits of the exploration. One that a limit or Ctrl-C ends gives a law of what had been found,
        which says that it is not complete.
    executor : Executor, optional
        Anything with the ``submit`` of ``concurrent.futures``; the law does not depend on it.
    progress : callable, optional
        Called with the numbers of regions found and of active sets waiting; for a HybridMpc with those of sequences
        solved, regions found and sequences waiting.

    Returns
    -------
    ExplicitLaw, or HybridLaw of a HybridMpc
        ``law(zeta)`` with the parameters in the order of ``law.names``; ``law.solve(x, ref, last_input)`` answers like
        the controller, so that :func:`closed_loop` takes the law.

    Raises
    ------
    ArgumentError
        Another kind of controller, or a box or fixed values that do not fit it.

    Examples
    --------
    >>> from hysdel_py.control.linear_limits import LinearLimits
    >>> from hysdel_py.systems.lti import Lti
    >>> plant = Lti([[0.9]], [[1.0]])
    >>> law = explicit(LinearMpc(plant, "regulator", 2, limits=LinearLimits(u=(-1, 1))), {"x1": (-5, 5)})
    >>> law.names, law.count
    (('x1',), 3)
    """
    from hysdel_py.optimize.mpqp import solve_mpqp

    if isinstance(controller, HybridMpc):
        return _of_hybrid(controller, box, fixed, move, settings=settings, executor=executor, progress=progress)
    found = parametric_controller(controller, box, fixed=fixed, move=move)
    solution = solve_mpqp(found.problem, settings, executor=executor, progress=progress)
    law = ExplicitLaw.of(solution, moves=len(found.signals.u), names=found.signals.free)
    return replace(law, signals=found.signals)


def _of_hybrid(controller: HybridMpc, box: Box, fixed: Fixed, move: MoveKind | None, **options: Any) -> HybridLaw:
    from hysdel_py.control.explicit_hybrid import explicit_hybrid

    if move not in (None, "input"):
        raise ArgumentError(f"move is {move!r}: a hybrid controller plans inputs, leave it out")
    if not (box is None or isinstance(box, Mapping)):
        raise ArgumentError("box is no mapping: ranges by the names of the parameters were expected")
    return explicit_hybrid(controller, box, fixed=cast("Mapping[str, float] | None", fixed), **options)


def parametric_controller(
    controller: Any, box: Box = None, *, fixed: Fixed = None, move: MoveKind | None = None
) -> ParametricController:
    """State the multi-parametric program behind :func:`explicit`, whose parameters these are."""
    if isinstance(controller, LinearMpc):
        return _of_linear(controller, box, fixed, move)
    raise ArgumentError(f"controller is a {type(controller).__name__}: a LinearMpc or HybridMpc was expected")


def _of_linear(controller: LinearMpc, box: Box, fixed: Fixed, move: MoveKind | None) -> ParametricController:
    signals = _signals(controller, move)
    check_distinct(signals.names)
    signals = replace(signals, fixed=tuple(fixed_values(fixed, signals).items()))
    domain = domain_of(box, signals, _known_ranges(controller))
    chosen, offset = substitution(signals)
    program = controller.program.with_constant_references()
    as_input = controller.tracks and not signals.increment
    return ParametricController(program.parametric(domain, chosen, offset, move_is_input=as_input), signals)


def _signals(controller: LinearMpc, move: MoveKind | None) -> LawSignals:
    if move not in (None, "increment", "input"):
        raise ArgumentError(f"move is {move!r}: 'increment' or 'input' was expected")
    if move == "increment" and not controller.tracks:
        raise ArgumentError("move is 'increment', but a regulator plans inputs: leave it out")
    lti = controller.lti
    return LawSignals(
        x=lti.x,
        u=lti.u,
        previous=controller.uses_last_input,
        references=tuple(lti.y[i].name for i in controller.weights.tracked),
        increment=controller.tracks and move != "input",
        sample_time=controller.sample_time,
        required=controller.references.required,
    )


def _known_ranges(controller: LinearMpc) -> Mapping[str, tuple[float, float]]:
    """Intervals of the parameters that follow from declared ranges and from limits of the inputs."""
    lti = controller.lti
    ranges = {v.name: (v.low, v.high) for v in lti.x}
    ranges |= {last_input_name(band.name): (band.low, band.high) for band in controller.limits.of("u")}
    ranges |= {reference_name(band.name): (band.low, band.high) for band in controller.limits.of("y")}
    return {name: ends for name, ends in ranges.items() if isfinite(ends[0]) and isfinite(ends[1])}
