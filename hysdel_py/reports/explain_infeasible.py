"""Why is there no sequence of inputs that keeps the ranges, MUST and the limits of a controller?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from operator import index
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from hysdel_py.analysis.clock import Watch
from hysdel_py.analysis.contradiction import Finding, find_contradiction
from hysdel_py.analysis.horizon import Demand, Horizon, build_horizon
from hysdel_py.control.bands import Band, ResolvedLimits
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.influence import influenced_outputs
from hysdel_py.control.limits import Limits
from hysdel_py.control.ranges import onto_range
from hysdel_py.errors import ArgumentError, SimulationError
from hysdel_py.model import Model
from hysdel_py.reports.demands import demands_of
from hysdel_py.reports.explanation import Explanation
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import Variable, as_vector

__all__ = ["explain_infeasible"]

MAX_ROWS = 200_000
"""Largest problem that is tried."""

Inputs = ArrayLike | Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class _Question:
    """What is asked, from a model or a controller."""

    model: Model
    horizon: int
    start: dict[str, float]
    inputs: dict[str, tuple[float, ...]]
    demands: tuple[Demand, ...]
    keep_auxiliaries: bool


def explain_infeasible(
    subject: Model | HybridMpc,
    x0: ArrayLike | Mapping[str, float],
    horizon: int | None = None,
    *,
    limits: Limits | None = None,
    inputs: Inputs | None = None,
    seconds: float = 60.0,
    progress: Watch | None = None,
) -> Explanation:
    """Find what contradicts each other over some steps, or a sequence of inputs that works.

    Parameters
    ----------
    subject : Model or HybridMpc
        A controller brings its limits as far as they are hard, and the declared ranges of auxiliaries, which it keeps.
    x0 : array_like of shape (nx,), or mapping of name to number
        First state.
    horizon : int, optional
        Number N >= 1 of steps; that of the controller by default.
    limits : Limits, optional
        Limits beside the model, for a model only; the softened ones are left out.
    inputs : mapping of name to number or N numbers, or array_like of shape (nu,) or (N, nu), optional
        Inputs that are given; a number holds at all steps. By default all inputs are free within their ranges.
    seconds : float
        Time limit. What is known by then is returned with the verdict that it deserves.
    progress : callable, optional
        Told the number of searches begun; a true answer ends the work as if its time were over.

    Returns
    -------
    Explanation
        ``print`` shows it.

    Raises
    ------
    ArgumentError
        Wrong arguments, or a variable without the finite range that a definition needs.
    SimulationError
        An auxiliary variable is used but never defined: the model has no step.

    Examples
    --------
    >>> from hysdel_py import load
    >>> model = load("SYSTEM drain { INTERFACE { STATE { REAL level [0, 1]; } }"
    ...              " IMPLEMENTATION { CONTINUOUS { level = level - 0.3; } } }")
    >>> explain_infeasible(model, [0.5], 4).verdict
    'smallest'
    """
    question = _question(subject, x0, horizon, limits, inputs)
    dha = question.model.dha
    if dha.undefined_but_used:
        names = ", ".join(dha.undefined_but_used)
        raise SimulationError((f"the auxiliary variable {names} is used but never defined: the model has no step",))
    _check_size(dha, question.horizon)
    if not seconds > 0:
        raise ArgumentError(f"seconds is {seconds!r}: a positive number was expected")
    build = partial(_horizon, question)
    finding: Finding = find_contradiction(
        dha, build(0.0), question.demands, seconds=seconds, kept_apart=build, progress=progress
    )
    return Explanation(question.model, question.horizon, question.demands, finding)


def _horizon(question: _Question, apart: float) -> Horizon:
    return build_horizon(
        question.model.dha,
        question.horizon,
        question.start,
        question.inputs,
        question.demands,
        keep_auxiliaries=question.keep_auxiliaries,
        apart=apart,
    )


def _check_size(dha: Dha, horizon: int) -> None:
    rows = horizon * 4 * len(dha.items)
    if rows > MAX_ROWS:
        raise ArgumentError(f"horizon is {horizon}: about {rows} rows would be needed, at most {MAX_ROWS} are tried")


def _question(subject: object, x0: Any, horizon: int | None, limits: Limits | None, inputs: Inputs | None) -> _Question:
    if isinstance(subject, HybridMpc):
        if limits is not None:
            raise ArgumentError("limits are given beside a controller, which has its own: leave them out")
        model = _model_of(subject)
        _check_free(subject)
        x, _ = onto_range(as_vector(x0, model.dha.x, "state"), model.dha.x, subject.tolerances.measured)
        steps = _checked_horizon(subject.horizon if horizon is None else horizon)
        demands = demands_of(subject.formulation.limits, subject.formulation.unmovable, steps, model.dha.x)
        return _Question(model, steps, _named(x, model.dha.x), _inputs(inputs, model.dha.u, steps), demands, True)
    if not isinstance(subject, Model):
        raise ArgumentError(
            f"a {type(subject).__name__} was given: a Model, as load() returns it, or a HybridMpc was expected"
        )
    x = as_vector(x0, subject.dha.x, "state")
    if horizon is None:
        raise ArgumentError("horizon is missing: a number of steps was expected")
    steps = _checked_horizon(horizon)
    demands = _demands(subject, limits, steps)
    return _Question(subject, steps, _named(x, subject.dha.x), _inputs(inputs, subject.dha.u, steps), demands, False)


def _check_free(controller: HybridMpc) -> None:
    shape = controller.formulation.shape
    if any(shape.is_held(k) for k in range(shape.horizon)):
        raise ArgumentError(
            "the controller holds its inputs in blocks, which cannot be explained yet: build one without blocking to "
            "see whether its limits contradict each other"
        )


def _model_of(controller: HybridMpc) -> Model:
    if not isinstance(controller.model, Model):
        raise ArgumentError(
            "the controller was built from matrices, which have no source to speak of: build it from a Model"
        )
    return controller.model


def _demands(model: Model, limits: Limits | None, steps: int) -> tuple[Demand, ...]:
    if limits is None:
        return ()
    if not isinstance(limits, Limits):
        raise ArgumentError(f"limits is a {type(limits).__name__}: Limits was expected")
    mld: Mld = model.mld
    resolved: ResolvedLimits = limits.resolve(mld, steps)
    influenced = influenced_outputs(mld)
    unmovable: tuple[Band, ...] = tuple(b for b in resolved.bands if b.group == "y" and not influenced[b.column])
    return demands_of(resolved, unmovable, steps, model.dha.x)


def _checked_horizon(horizon: int) -> int:
    try:
        steps = 0 if isinstance(horizon, bool) else index(horizon)
    except TypeError:
        steps = 0
    if steps < 1:
        raise ArgumentError(f"horizon is {horizon!r}: a whole number of at least 1 was expected")
    return steps


def _named(values: Any, variables: Sequence[Variable]) -> dict[str, float]:
    return {v.name: float(value) for v, value in zip(variables, values, strict=True)}


def _inputs(inputs: Inputs | None, variables: tuple[Variable, ...], steps: int) -> dict[str, tuple[float, ...]]:
    """N numbers for each input that is given."""
    if inputs is None:
        return {}
    if isinstance(inputs, Mapping):
        unknown = [str(name) for name in inputs if name not in {v.name for v in variables}]
        if unknown:
            known = ", ".join(v.name for v in variables) or "(none)"
            raise ArgumentError(f"there is no input named {', '.join(unknown)}: the inputs are {known}")
        return {v.name: _column(inputs[v.name], v, steps) for v in variables if v.name in inputs}
    table = _array(inputs, "inputs")
    table = np.tile(table, (steps, 1)) if table.ndim == 1 else table
    if table.shape != (steps, len(variables)):
        raise ArgumentError(
            f"inputs has shape {table.shape}: {len(variables)} numbers, or one row of them for each of {steps} steps, "
            "were expected"
        )
    return {v.name: _column(table[:, i], v, steps) for i, v in enumerate(variables)}


def _column(values: Any, variable: Variable, steps: int) -> tuple[float, ...]:
    column = _array(values, f"input {variable.name}")
    column = np.full(steps, float(column)) if column.ndim == 0 else column
    if column.shape != (steps,):
        raise ArgumentError(f"input {variable.name} has shape {column.shape}: a number or {steps} were expected")
    for value in column:
        as_vector([value], (variable,), "input")
    return tuple(column.tolist())


def _array(values: Any, what: str) -> Any:
    try:
        return np.array(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{what} must be numbers: {error}") from None
