"""The simulation methods as frozen objects that carry their options.

Steps `dt` are largest steps: a scheme with fixed steps divides the time span, or the interval between two samples, into
equal ones.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

from hysdel_py.drivetrain.schemes.option_checks import (
    DECOMPOSITIONS,
    INTEGRATORS,
    LCP_SOLVERS,
    VARIABLE_INTEGRATORS,
    check_options,
    check_theta,
)
from hysdel_py.drivetrain.schemes.rule_options import FixedStepLcp, Karnopp, Smoothing, SwitchModel, WaitState
from hysdel_py.errors import ArgumentError

__all__ = [
    "AugmentedLagrangian", "EventDriven", "Exact", "FixedStepLcp", "Karnopp", "Moreau", "Scheme", "Smoothing",
    "SwitchModel", "VariableStepMoreau", "WaitState", "describe",
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Moreau:
    """Time-stepping on velocity level, one contact problem per step.

    Parameters
    ----------
    dt : float
        Step [s].
    theta : float, optional
        None: Moreau's explicit midpoint scheme of the document. 0.5 to 1: the theta scheme; 0.5 is of second order,
        also through events, and keeps the energy balance exactly.
    inputs : str
        When signals are read: in the ``"middle"`` of a step or, as the document's code does, at its ``"start"``.
    solver : str
        ``"active-set"`` is the compiled solver of the friction law as it stands; the others are those of `optimize.lcp`
        on an explicit LCP.
    decomposition : str
        Of the friction law, for an explicit LCP: ``"leine-nijmeijer"`` has 2 unknowns per contact,
        ``"pfeiffer-glocker"`` has 4, ``"boxed"`` 1 with two bounds.
    """

    dt: float = 1e-3
    theta: float | None = 0.5
    inputs: str = "middle"
    solver: str = "active-set"
    decomposition: str = "leine-nijmeijer"

    def __post_init__(self) -> None:
        check_options(
            self, dt=0.0, inputs=("middle", "start"), solver=("active-set", *LCP_SOLVERS), decomposition=DECOMPOSITIONS
        )  # fmt: skip
        check_theta(self)


@dataclass(frozen=True, slots=True)
class AugmentedLagrangian:
    """Time-stepping on velocity level with prox iterations for the contacts.

    Parameters
    ----------
    dt : float
        Step [s].
    steepness : float, optional
        Of the regularised law [Nm s/rad], the same for all contacts, as in the document; iterations converge while
        ``steepness * dt * lambda_max(G) < 2``. None: one steepness per contact, ``1 / G_ii``, contact after contact,
        which always converges.
    tolerance : float
        With a steepness: change of the torques [Nm] at which iterations stop. Without: slip that is left, relative to
        its terms.
    iterations : int
        Limit per step; steps that reach it are counted in ``info["failures"]``.
    theta, inputs
        As for :class:`Moreau`.
    """

    dt: float = 1e-3
    steepness: float | None = None
    tolerance: float = 1e-12
    iterations: int = 100_000
    theta: float | None = 0.5
    inputs: str = "middle"

    def __post_init__(self) -> None:
        check_options(self, dt=0.0, steepness=0.0, tolerance=0.0, iterations=0, inputs=("middle", "start"))
        check_theta(self)


@dataclass(frozen=True, slots=True)
class VariableStepMoreau:
    """Time-stepping with error control: each step is done once whole and once in two halves.

    Where all three have the same modes, and only there, the two results are extrapolated to fourth order.

    Parameters
    ----------
    tolerance : float
        Error per step in speeds [rad/s].
    dt : float
        First step [s].
    min_step, max_step : float
        [s]; steps of the least size are accepted whatever their error: that is how events are passed.
    extrapolate : bool
    """

    tolerance: float = 1e-4
    dt: float = 1e-3
    min_step: float = 1e-7
    max_step: float = 0.05
    extrapolate: bool = True

    def __post_init__(self) -> None:
        check_options(self, tolerance=0.0, dt=0.0, min_step=0.0, max_step=0.0)
        if self.min_step > self.max_step:
            raise ArgumentError(
                f"VariableStepMoreau: min_step {self.min_step:g} exceeds max_step {self.max_step:g}: at most that was "
                "expected"
            )


@dataclass(frozen=True, slots=True)
class EventDriven:
    """Integration between events, which are located by root finding; an LCP chooses the modes at each of them.

    Parameters
    ----------
    integrator : str
        ``"dop853"`` (order 8), ``"rk45"`` or ``"radau"`` with variable steps; ``"euler"``, ``"rk3"`` or ``"rk4"`` with
        fixed ones.
    rtol, atol : float
        Of variable steps.
    max_step : float
        [s]; between two steps at most one root per indicator is seen.
    dt : float
        Fixed step [s].
    decomposition, solver
        As for :class:`Moreau`.
    """

    integrator: str = "dop853"
    rtol: float = 1e-9
    atol: float = 1e-9
    max_step: float = 0.02
    dt: float = 1e-3
    decomposition: str = "leine-nijmeijer"
    solver: str = "auto"

    def __post_init__(self) -> None:
        check_options(
            self, integrator=(*VARIABLE_INTEGRATORS, *INTEGRATORS), rtol=0.0, atol=0.0, max_step=0.0, dt=0.0,
            decomposition=DECOMPOSITIONS, solver=("active-set", *LCP_SOLVERS),
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Exact:
    """Matrix exponentials between events: for linear equations, constant coefficients and piecewise linear inputs.

    Parameters
    ----------
    look : float
        Interval [s] at which indicators are looked at for a change of sign.
    """

    look: float = 2e-3

    def __post_init__(self) -> None:
        check_options(self, look=0.0)


Scheme = (
    Moreau | AugmentedLagrangian | VariableStepMoreau | Smoothing | Karnopp | SwitchModel | FixedStepLcp | WaitState
    | EventDriven | Exact
)  # fmt: skip


def describe(scheme: Scheme) -> str:
    """A scheme with the options that differ from its defaults."""
    changed = [f"{f.name}={getattr(scheme, f.name)!r}" for f in fields(scheme) if getattr(scheme, f.name) != f.default]
    return f"{type(scheme).__name__}({', '.join(changed)})"
