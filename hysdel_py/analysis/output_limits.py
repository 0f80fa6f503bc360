"""Limits on outputs as rows of the regions of a piecewise affine system."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.hybrid_set import Span, box_of
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mode import Condition, Mode, RowKind
from hysdel_py.systems.pwa import Pwa

__all__ = ["with_output_limits"]

Vector = NDArray[np.float64]


def with_output_limits(pwa: Pwa, outputs: Mapping[str, Span]) -> Pwa:
    """The system without the states and inputs whose outputs leave given intervals.

    Parameters
    ----------
    pwa : Pwa
    outputs : mapping of name to value or (low, high)
        Those that are not named are free.

    Raises
    ------
    ArgumentError
        An unknown name, or an interval upside down.
    """
    if not isinstance(outputs, Mapping):
        raise ArgumentError(f"outputs: expected names with values or (low, high), found {type(outputs).__name__}")
    low, high = box_of({v.name: (-np.inf, np.inf) for v in pwa.y} | dict(outputs), pwa.y, "outputs")
    chosen = [i for i, v in enumerate(pwa.y) if v.name in outputs]
    return replace(pwa, modes=tuple(_limited(mode, pwa, chosen, low, high) for mode in pwa.modes)) if chosen else pwa


def _limited(mode: Mode, pwa: Pwa, chosen: list[int], low: Vector, high: Vector) -> Mode:
    """The mode with two rows for each limited output before the rows of Booleans, which come last."""
    seen, constant = _over_reals(mode, pwa, chosen)
    rows = np.vstack([seen, -seen])
    sides = np.concatenate([high[chosen] - constant, constant - low[chosen]])
    sources = tuple(Condition(RowKind.RANGE, pwa.y[i].name) for i in (*chosen, *chosen))
    real = np.isfinite(sides)
    split = sum(source.kind is not RowKind.BOOLEAN for source in mode.sources)
    A = np.vstack([mode.region.A[:split], rows[real], mode.region.A[split:]])
    b = np.concatenate([mode.region.b[:split], sides[real], mode.region.b[split:]])
    kept = tuple(source for source, finite in zip(sources, real, strict=True) if finite)
    region = replace(mode.region, A=A, b=b)
    return replace(mode, region=region, sources=(*mode.sources[:split], *kept, *mode.sources[split:]))


def _over_reals(mode: Mode, pwa: Pwa, chosen: list[int]) -> tuple[NDArray[np.float64], Vector]:
    """Outputs over states and inputs, with what the Booleans of the mode add to them in the constant part."""
    seen, constant, values = np.hstack([mode.C, mode.D])[chosen], mode.g[chosen].copy(), mode.values
    for column, variable in enumerate((*pwa.x, *pwa.u)):
        if not variable.is_bool or not np.any(seen[:, column]):
            continue
        value = values[variable.name]
        if value is None:
            raise ArgumentError(
                f"outputs: one depends on {variable.name}, which a mode leaves open: use "
                "to_pwa(model, split_booleans=True)"
            )
        constant += seen[:, column] * value
        seen[:, column] = 0.0
    return seen, constant
