"""An explicit law in the place of its controller."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.explicit_law import OUTSIDE, ExplicitLaw
from hysdel_py.control.law_signals import LawSignals, last_input_name, reference_name
from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import as_vector

__all__ = ["answer", "signals_of"]

Vector = NDArray[np.float64]
Values = ArrayLike | Mapping[str, float] | None


def signals_of(law: ExplicitLaw) -> LawSignals:
    """What the parameters of a law stand for.

    Raises
    ------
    ArgumentError
        The law is that of a multi-parametric program without a controller.
    """
    if law.signals is None:
        raise ArgumentError("the law does not know what its parameters stand for: call law(zeta) instead of solve")
    return law.signals


def answer(law: ExplicitLaw, x: Values, ref: Values, last_input: Values) -> Move:
    """The move of a law, as its controller would give it.

    Parameters
    ----------
    law : ExplicitLaw
    x, ref, last_input
        As for the controller; references are numbers that hold over the horizon.

    Returns
    -------
    Move
        Without a predicted trajectory; ``move.u`` is None where no region holds the point, and the message says why.

    Raises
    ------
    ArgumentError
        Wrong arguments, or a law that does not come from a controller.
    """
    begin = time.perf_counter()
    signals = signals_of(law)
    values = _values(signals, x, ref, last_input)
    strayed = [name for name, value in signals.fixed if not np.isclose(values[name], value)]
    zeta = np.array([values[name] for name in law.names])
    region = OUTSIDE if strayed else law.locate(zeta)
    move = _outside(law, zeta, strayed) if region == OUTSIDE else _inside(law, region, zeta, values)
    return replace(move, seconds=time.perf_counter() - begin)


def _inside(law: ExplicitLaw, region: int, zeta: Vector, values: Mapping[str, float]) -> Move:
    signals = signals_of(law)
    u = law.K[region, : law.moves] @ zeta + law.k[region, : law.moves]
    if signals.increment:
        u = u + np.array([values[last_input_name(v.name)] for v in signals.u])
    cost = law.value(zeta) if law.has_value else inf
    message = f"optimal: region {region} of the explicit law"
    return Move(MoveStatus.OPTIMAL, message, u=u, cost=cost, bound=cost if law.has_value else -inf, gap=0.0)


def _outside(law: ExplicitLaw, zeta: Vector, strayed: list[str]) -> Move:
    """Why no region holds a point."""
    if strayed:
        fixed = ", ".join(f"{name} = {value:g}" for name, value in signals_of(law).fixed if name in strayed)
        return Move(MoveStatus.NO_PLAN, f"no plan found: the law holds for {fixed} only")
    beyond = np.min(law.domain.slack(zeta), initial=inf) < -law.tolerance
    point = ", ".join(f"{name} = {value:.6g}" for name, value in zip(law.names, zeta, strict=True))
    if beyond:
        return Move(
            MoveStatus.NO_PLAN, f"no plan found: {point} lies outside the box of the explicit law; widen the box"
        )
    if not law.complete:
        message = f"no plan found: {point} lies in no region of an explicit law that is not complete"
        return Move(MoveStatus.NO_PLAN, message)
    return Move(MoveStatus.INFEASIBLE, f"infeasible: no plan keeps the hard limits at {point}", bound=inf)


def _values(signals: LawSignals, x: Values, ref: Values, last_input: Values) -> dict[str, float]:
    """All parameters by name."""
    fixed = dict(signals.fixed)
    state = as_vector({} if x is None else x, signals.x, "state")
    values = {v.name: value for v, value in zip(signals.x, state.tolist(), strict=True)}
    if signals.previous:
        values |= _last_input(signals, fixed, last_input)
    return values | _references(signals, fixed, ref)


def _last_input(signals: LawSignals, fixed: Mapping[str, float], last_input: Values) -> dict[str, float]:
    names = [last_input_name(v.name) for v in signals.u]
    if last_input is None:
        missing = [name for name in names if name not in fixed]
        if missing:
            raise ArgumentError(f"last_input is missing: the law depends on {', '.join(missing)}")
        return {name: fixed[name] for name in names}
    return dict(zip(names, as_vector(last_input, signals.u, "last input").tolist(), strict=True))


def _references(signals: LawSignals, fixed: Mapping[str, float], ref: Values) -> dict[str, float]:
    """References by parameter; those left out are what they were fixed to, else 0."""
    given = _by_name(signals, ref)
    names = {name: reference_name(name) for name in signals.references}
    missing = [name for name, key in names.items() if name not in given and key not in fixed]
    if missing and signals.required:
        raise ArgumentError(f"no reference for {', '.join(missing)}: the law depends on it")
    return {key: given.get(name, fixed.get(key, 0.0)) for name, key in names.items()}


def _by_name(signals: LawSignals, ref: Values) -> dict[str, float]:
    known = ", ".join(signals.references) or "(none)"
    if ref is None:
        return {}
    if not isinstance(ref, Mapping):
        vector = np.atleast_1d(np.asarray(ref, dtype=float))
        if vector.shape != (len(signals.references),):
            raise ArgumentError(f"the reference has shape {vector.shape}: numbers for {known} were expected")
        ref = dict(zip(signals.references, vector.tolist(), strict=True))
    unknown = [str(name) for name in ref if name not in signals.references]
    if unknown:
        raise ArgumentError(f"reference {', '.join(unknown)} is not known: expected {known}")
    wrong = [name for name, value in ref.items() if np.ndim(value) or not np.isfinite(value)]
    if wrong:
        raise ArgumentError(
            f"reference {wrong[0]} is {ref[wrong[0]]!r}: one finite number, as the law takes no preview"
        )
    return {name: float(value) for name, value in ref.items()}
