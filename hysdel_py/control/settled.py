"""Limits that no input of a plan can move any more: what they allow for, and which of them the measured state misses.

A plan that rides on a limit keeps it up to the accuracy of the solver. In the next step the measured state may settle
that very value, and a limit without an allowance would end the closed loop for the sake of the last digits.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.bands import Band, ResolvedLimits
from hysdel_py.control.formulation import Formulation
from hysdel_py.control.influence import settled_signals
from hysdel_py.control.prediction import Step
from hysdel_py.errors import HysdelError
from hysdel_py.systems.mld import Mld

__all__ = ["allowing_for_rounding", "missed_limits"]

Matrix = NDArray[np.float64]


def allowing_for_rounding(limits: ResolvedLimits, mld: Mld, horizon: int, allowance: float) -> ResolvedLimits:
    """The same limits with an allowance where the measured state settles a signal.

    Parameters
    ----------
    limits : ResolvedLimits
    mld : Mld
    horizon : int
    allowance : float
        Relative to the size of the ends of a limit, and at least absolute.
    """
    return replace(limits, settled=settled_signals(mld, horizon), allowance=allowance)


def missed_limits(formulation: Formulation, step: Step | None, x0: Matrix) -> list[str]:
    """Hard limits that the measured state breaks at a later time whatever the inputs are, in words.

    Parameters
    ----------
    formulation : Formulation
    step : Step or None
        Simulation of the model.
    x0 : array of shape (nx,)
    """
    limits = formulation.limits
    found = []
    for time, signals in _settled_values(formulation, step, x0):
        for band in limits.bands:
            at = ("y", time) if band.group == "y" else ("x", time + 1)
            if band.group in ("x", "y") and limits.is_settled(band, at[1]) and at != ("y", 0):
                found += _missed(band, at[1], float(signals[at[0]][band.column]), limits)
    return found


def _missed(band: Band, time: int, value: float, limits: ResolvedLimits) -> list[str]:
    low, high = limits.ends(band, time)
    if low <= value <= high:
        return []
    least, most = band.at(time)
    miss = max(least - value, value - most)
    return [
        f"{band.group} {band.name} will be {value:.6g} at k = {time}, {miss:.2g} outside its limit {band.text(time)}: "
        "the measured state settles that, and no input can change it"
    ]


def _settled_values(formulation: Formulation, step: Step | None, x0: Matrix) -> Iterator[tuple[int, dict[str, Matrix]]]:
    """Outputs and next states of a simulation as far as something in it is settled; the inputs do not matter."""
    last = max((time for _, _, time in formulation.limits.settled), default=0)
    x, layout = x0, formulation.layout
    for time in range(min(last + 1, layout.horizon) if step is not None else 0):
        start = layout.start("u", time)
        low, high = (end[start : start + layout.mld.nu] for end in (formulation.lb, formulation.ub))
        try:
            x, y, _, _ = step(x, np.clip(0.0, low, high))  # type: ignore[misc]
        except HysdelError:
            return
        yield time, {"x": x, "y": y}
