"""The drivetrain: components put together, and the one place where a simulation begins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.drivetrain.assembly import assemble
from hysdel_py.drivetrain.checks import is_number
from hysdel_py.drivetrain.components import Component
from hysdel_py.drivetrain.equations import Equations, equations_from_matrices
from hysdel_py.drivetrain.hysdel_text import hysdel_text
from hysdel_py.drivetrain.laws import FrictionLaw
from hysdel_py.drivetrain.schemes.option_checks import VARIABLE_INTEGRATORS
from hysdel_py.drivetrain.schemes.options import (
    AugmentedLagrangian,
    EventDriven,
    Exact,
    FixedStepLcp,
    Karnopp,
    Moreau,
    Scheme,
    Smoothing,
    SwitchModel,
    VariableStepMoreau,
    WaitState,
)
from hysdel_py.drivetrain.signals import SignalLike
from hysdel_py.drivetrain.start import start_state
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory
from hysdel_py.errors import ArgumentError

__all__ = ["Drivetrain"]

Matrix = NDArray[np.float64]

_MODULE: dict[type, str] = {
    Moreau: "time_stepping",
    AugmentedLagrangian: "time_stepping",
    VariableStepMoreau: "variable_step",
    Karnopp: "fixed_step",
    SwitchModel: "fixed_step",
    WaitState: "fixed_step",
    FixedStepLcp: "fixed_step_lcp",
    EventDriven: "event_driven",
    Exact: "exact",
}

_LARGEST_RUN = 50_000_000


class Drivetrain:
    """Shafts with inertias, gears, springs, sources, loads and dry contacts.

    Parameters
    ----------
    *components : Component
        In any order, connected by the names of their shafts.

    Attributes
    ----------
    components : tuple of Component
    equations : Equations
        Mass matrix, directions of springs and contacts, inputs.

    Raises
    ------
    ArgumentError
        The components do not fit together; the message names the one that does not.

    Examples
    --------
    >>> import hysdel_py as hys
    >>> line = hys.Drivetrain(
    ...     hys.Inertia("engine", 0.2),
    ...     hys.Inertia("vehicle", 0.8),
    ...     hys.Clutch("clutch", "engine", "vehicle", force=50),
    ... )
    >>> run = line.simulate({"engine": 120, "vehicle": 20}, until=0.5)
    >>> round(float(run["engine"][-1]), 6)
    40.0
    """

    def __init__(self, *components: Component) -> None:
        self.components = components
        self.equations = assemble(components)

    @classmethod
    def from_equations(cls, equations: Equations) -> Drivetrain:
        """A drivetrain of which only the equations are known."""
        drivetrain = cls.__new__(cls)
        drivetrain.components = ()
        drivetrain.equations = equations
        return drivetrain

    @classmethod
    def from_matrices(
        cls,
        M: ArrayLike,
        W: ArrayLike,
        capacity: Sequence[SignalLike],
        *,
        force: Sequence[SignalLike] | None = None,
        D: ArrayLike | None = None,
        B: ArrayLike | None = None,
        k: ArrayLike | None = None,
        friction: Sequence[FrictionLaw | float] | None = None,
        coordinates: Sequence[str] | None = None,
        contacts: Sequence[str] | None = None,
        springs: Sequence[str] | None = None,
    ) -> Drivetrain:
        """A drivetrain from ``M u' = force - D u - B k e + W lambda``, ``e' = B'u``, with dry contacts of slip ``W'u``.

        Parameters
        ----------
        M : array of shape (n, n)
            Mass matrix, symmetric and positive definite.
        W : array of shape (n, nc)
            Directions of the contacts.
        capacity : sequence of nc signals
            Torque per unit of friction coefficient.
        force : sequence of n signals, optional
        D : array of shape (n, n), optional
            Damping. One that is not symmetric is refused by schemes with theta, which most time-stepping schemes are.
        B : array of shape (n, m), optional
            Directions of the springs.
        k : array of shape (m,), optional
            Stiffness.
        friction : sequence of nc laws or coefficients, optional
            All 1 by default.
        coordinates, contacts, springs : sequences of str, optional
            Names.

        Raises
        ------
        ArgumentError
            Wrong shapes, names or signs, or a mass matrix that is not positive definite.
        """
        return cls.from_equations(
            equations_from_matrices(
                M,
                W,
                capacity,
                force=force,
                D=D,
                B=B,
                k=k,
                friction=friction,
                coordinates=coordinates,
                contacts=contacts,
                springs=springs,
            )
        )

    def simulate(
        self,
        start: Mapping[str, float] | ArrayLike,
        until: float,
        scheme: Scheme | None = None,
        *,
        sample: float | None = None,
    ) -> DrivetrainTrajectory:
        """Simulate from t = 0.

        Parameters
        ----------
        start : mapping of name to number, or array
            Speeds of the independent shafts [rad/s], and twists of springs [rad], which are zero by default. Speeds of
            other shafts may be given too and have to agree. An array holds the speeds in the order of
            ``equations.names.coordinates``, then the twists.
        until : float
            End [s], above zero.
        scheme : Scheme, optional
            Method with its options, ``hys.Moreau()`` by default.
        sample : float, optional
            Interval between samples [s] that divides `until`; by default one sample per step.

        Raises
        ------
        ArgumentError
            A speed is missing or contradicts another, or the scheme cannot work on these equations.
        """
        scheme = Moreau() if scheme is None else scheme
        module = import_module(f"hysdel_py.drivetrain.schemes.{_module_of(scheme)}")
        _check_times(until, sample)
        _check_length(scheme, until, sample)
        u, e = start_state(self.equations, start)
        found: DrivetrainTrajectory = module.integrate(self.equations, u, e, float(until), scheme, sample)
        return found

    def to_hysdel(
        self,
        ranges: Mapping[str, tuple[float, float]],
        scheme: Moreau | Karnopp | None = None,
        name: str = "drivetrain",
    ) -> str:
        """The sampled drivetrain as a ``.hys`` text, whose steps are those of the scheme.

        The states are the independent speeds and the twists, the inputs the signals that have a range, named with
        ``_u`` behind; ``hys.load(text)`` makes a model of it. See docs/drivetrain.md.

        Parameters
        ----------
        ranges : mapping of name to (low, high)
            Of every state, and of the signals that become inputs; the others have to be constant.
        scheme : Moreau or Karnopp, optional
            ``hys.Moreau(dt=0.01)`` by default.
        name : str
            Of the system.

        Raises
        ------
        ArgumentError
            A range is missing, or there is no such piecewise affine step.
        """
        return hysdel_text(self.equations, ranges, Moreau(dt=0.01) if scheme is None else scheme, name)

    def describe(self) -> str:
        """Independent shafts, mass matrix and directions, as text."""
        q = self.equations
        lines = [f"shafts: {', '.join(q.names.shafts)}", f"independent: {', '.join(q.names.coordinates)}"]
        blocks = (("M", q.M), ("D", q.D), ("B (springs)", q.B), ("W (contacts)", q.W), ("G = W'M^-1 W", q.G))
        lines += [f"{name} =\n{np.array2string(block, precision=6)}" for name, block in blocks if block.size]
        return "\n".join([*lines, f"inputs: {', '.join(q.signal_names)}"])


def _module_of(scheme: Any) -> str:
    if isinstance(scheme, Smoothing):
        return "smoothing" if scheme.dt is None else "fixed_step"
    if type(scheme) not in _MODULE:
        names = ", ".join(sorted([*(kind.__name__ for kind in _MODULE), "Smoothing"]))
        raise ArgumentError(f"scheme is {scheme!r}: one of {names} was expected, as in scheme=hys.Moreau(dt=1e-3)")
    return _MODULE[type(scheme)]


def _check_times(until: float, sample: float | None) -> None:
    if not (is_number(until) and until > 0):
        raise ArgumentError(f"until is {until!r}: a time above zero was expected")
    if sample is not None:
        if not (is_number(sample) and 0 < sample <= until):
            raise ArgumentError(f"sample is {sample!r}: a time above zero and up to {until:g} was expected")
        if abs(until / sample - round(until / sample)) > 1e-6:
            raise ArgumentError(f"sample {sample:g} does not divide the time span of {until:g}")


def _check_length(scheme: Any, until: float, sample: float | None) -> None:
    """Samples, and steps of a scheme that has equal ones, have to fit into memory."""
    chosen = isinstance(scheme, VariableStepMoreau) or getattr(scheme, "integrator", "") in VARIABLE_INTEGRATORS
    dt = None if chosen else getattr(scheme, "dt", None)
    for interval, what in ((dt, "steps"), (sample, "samples")):
        if interval is not None and until / interval > _LARGEST_RUN:
            count = until / interval
            raise ArgumentError(f"{count:.3g} {what} of {interval:g} s: at most {_LARGEST_RUN:.3g} are done in one run")
