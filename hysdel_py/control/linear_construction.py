"""Models, weights and sets of a linear controller, as its program needs them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.admissible_set import maximal_admissible_set
from hysdel_py.control.bands import Polytope
from hysdel_py.control.linear_cost import LinearWeights
from hysdel_py.control.linear_horizons import Horizons
from hysdel_py.control.linear_limits import DEFAULT_PRICE, ResolvedLinearLimits
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.systems.lti import Lti

__all__ = ["models_of", "softened", "terminal_set", "with_cached_gain"]

Matrix = NDArray[np.float64]


def models_of(model: Any, stages: int) -> tuple[Lti, ...]:
    """Return one model per stage.

    Raises
    ------
    ArgumentError
        Something else than a model, or models whose number or sizes do not fit.
    """
    if isinstance(model, Iterable) and not isinstance(model, str):
        models = tuple(Lti.of(entry) for entry in model)
        if len(models) != stages:
            raise ArgumentError(
                f"model has {len(models)} entries: {stages} were expected, one per stage of the horizon"
            )
        shapes = {(m.nx, m.nu, m.ny, m.ts) for m in models}
        if len(shapes) > 1:
            raise ArgumentError("the models of the stages differ in size or sample time: equal ones were expected")
        return models
    return (Lti.of(model),) * stages


def with_cached_gain(weights: LinearWeights) -> LinearWeights:
    """Return weights whose gain is worked out once."""
    return replace(weights, gain=cache(weights.gain))


def softened(limits: ResolvedLinearLimits) -> ResolvedLinearLimits:
    """Return limits whose outputs and states may be exceeded, at the usual price where they were hard."""
    return limits if limits.rho < inf else replace(limits, rho=DEFAULT_PRICE)


def terminal_set(
    lti: Lti, weights: LinearWeights, limits: ResolvedLinearLimits, horizons: Horizons, tracks: bool
) -> Polytope | None:
    """Return the set of the last state, None where there is none.

    Raises
    ------
    ArgumentError
        A terminal set of a tracking controller, or an invariant set that does not exist.
    """
    if not limits.invariant and limits.terminal is None:
        return None
    if tracks:
        raise ArgumentError(
            "limits terminal: a terminal set belongs to a regulator; limit outputs up to the horizon instead"
        )
    if not limits.invariant:
        return limits.terminal
    found = maximal_admissible_set(*_held_limits(lti, weights.gain(), limits, horizons))
    return Polytope(found.A, found.b)


def _held_limits(lti: Lti, K: Matrix, limits: ResolvedLinearLimits, horizons: Horizons) -> tuple[Matrix, Polyhedron]:
    """The closed loop under u = K x, and its limits as rows over the state."""
    closed = lti.A + lti.B @ K
    forms = {"u": K, "du": K @ (closed - np.eye(lti.nx)), "y": lti.C + lti.D @ K, "x": np.eye(lti.nx)}
    rows, sides = [np.zeros((0, lti.nx))], []
    for band in limits.bands:
        low, high = band.at(horizons.steps)
        shift = lti.g[band.column] if band.group == "y" else 0.0
        row = forms[band.group][band.column]
        rows += [row, -row]
        sides += [high - shift, shift - low]
    A, b = np.vstack(rows), np.array(sides)
    return closed, Polyhedron(A[np.isfinite(b)], b[np.isfinite(b)])
