"""Options of the schemes that put a rule for the contact torques under an integration method."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Real

from hysdel_py.drivetrain.schemes.option_checks import DECOMPOSITIONS, INTEGRATORS, LCP_SOLVERS, check_options
from hysdel_py.errors import ArgumentError

__all__ = ["FixedStepLcp", "Karnopp", "Smoothing", "SwitchModel", "WaitState"]


@dataclass(frozen=True, slots=True)
class Smoothing:
    """The sign of the slip replaced by ``2/pi atan(steepness * slip)``: an ordinary, stiff differential equation.

    Parameters
    ----------
    steepness : float
        [s/rad]
    dt : float, optional
        Fixed step; None: variable steps by the implicit Radau method.
    integrator : str
        With fixed steps: ``"euler"``, ``"rk3"`` or ``"rk4"``.
    rtol, atol : float
        Of variable steps.
    max_step : float
        Longest variable step [s] where an input is a function of time, whose changes no step may jump over.
    """

    steepness: float = 1e3
    dt: float | None = None
    integrator: str = "rk4"
    rtol: float = 1e-7
    atol: float = 1e-9
    max_step: float = 0.02

    def __post_init__(self) -> None:
        check_options(self, steepness=0.0, dt=0.0, integrator=INTEGRATORS, rtol=0.0, atol=0.0, max_step=0.0)


@dataclass(frozen=True, slots=True)
class Karnopp:
    """Contacts inside a band around zero slip get the torque that keeps their slip, cut to what they can hold.

    Parameters
    ----------
    dt : float
        Step [s].
    band : float, optional
        Half-width [rad/s]; None: half of what a slip can move in one step.
    integrator : str
    """

    dt: float = 1e-3
    band: float | None = None
    integrator: str = "rk3"

    def __post_init__(self) -> None:
        check_options(self, dt=0.0, band=0.0, integrator=INTEGRATORS)


@dataclass(frozen=True, slots=True)
class SwitchModel:
    """The Switch Model: in the band the vector fields on both sides decide between transition and attractive sliding.

    Parameters
    ----------
    dt : float
        Step [s].
    band : float, optional
        Half-width [rad/s]; None: what a slip can move in one step.
    tau : float, optional
        Time constant [s] with which a sticking contact is driven to zero slip; None: two steps; infinite: not driven.
    integrator : str
    """

    dt: float = 1e-3
    band: float | None = None
    tau: float | None = None
    integrator: str = "rk3"

    def __post_init__(self) -> None:
        check_options(self, dt=0.0, band=0.0, integrator=INTEGRATORS)
        if self.tau is not None and not (isinstance(self.tau, Real) and self.tau > 0):
            raise ArgumentError(f"SwitchModel: tau is {self.tau!r}, a number above zero was expected")


@dataclass(frozen=True, slots=True)
class FixedStepLcp:
    """The document's event-driven method in fixed steps: in a band around zero slip an LCP chooses modes and torques.

    No event is located and nothing drives the slip to zero.

    Parameters
    ----------
    dt : float
        Step [s].
    band : float, optional
        Half-width [rad/s]; None: half of what a slip can move in one step.
    integrator : str
    decomposition, solver
        As for :class:`Moreau`.
    """

    dt: float = 1e-3
    band: float | None = None
    integrator: str = "euler"
    decomposition: str = "leine-nijmeijer"
    solver: str = "auto"

    def __post_init__(self) -> None:
        check_options(
            self, dt=0.0, band=0.0, integrator=INTEGRATORS, decomposition=DECOMPOSITIONS,
            solver=("active-set", *LCP_SOLVERS),
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class WaitState:
    """Controllable clutches: unengaged, engaged, locked, and the wait state with mode iteration after each step.

    Parameters
    ----------
    dt : float
        Step [s].
    band : float
        Slip [rad/s] below which a clutch locks and above which a waiting one is engaged.
    integrator : str
    """

    dt: float = 1e-3
    band: float = 1e-3
    integrator: str = "rk3"

    def __post_init__(self) -> None:
        check_options(self, dt=0.0, band=0.0, integrator=INTEGRATORS)
