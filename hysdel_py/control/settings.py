"""Tolerances of the controllers in one frozen object that is passed down."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["DEFAULT_CONTROL_TOLERANCES", "ControlTolerances"]


@dataclass(frozen=True, slots=True)
class ControlTolerances:
    """Numerical tolerances of the predictive controllers.

    Attributes
    ----------
    measured : float
        A measured state may lie outside its declared range by this much, relative to the size of the range's ends and
        at least absolute; it is then moved onto the end. It covers the residual of the solver that steered the plant
        there, so it must not be smaller than the solver's own tolerance.
    residual : float
        Largest violation of a row of the prediction, relative to the size of its terms and at least absolute, with
        which a plan is still accepted.
    feasibility : float
        A plan may violate a row or bound by this much. Less than half of 1e-6, the usual gap between the two sides of a
        threshold, so that no plan passes for both; looser than the solver's own default, because an interior-point
        solution of a program whose cost is in the hundred thousands is no better.
    settled : float
        A hard limit of a state or output is wider by this much at the times at which the measured state settles the
        signal and no input can move it, relative to the size of its ends and at least absolute. It covers what a plan
        may miss the limit by, so it must not be smaller than `feasibility`.
    definite : float
        A weight matrix counts as positive semidefinite, and as symmetric, up to this much of its largest entry.
    """

    measured: float = 1e-6
    residual: float = 1e-5
    feasibility: float = 4e-7
    settled: float = 1e-6
    definite: float = 1e-9


DEFAULT_CONTROL_TOLERANCES = ControlTolerances()
