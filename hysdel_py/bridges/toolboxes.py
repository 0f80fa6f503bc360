"""Linear systems for scipy.signal, and systems of python-control as plants; the other direction of Lti.of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.lti import Lti
from hysdel_py.systems.signals import Kind, Type, Variable, as_vector

if TYPE_CHECKING:
    from collections.abc import Mapping

    from scipy.signal import StateSpace

    from hysdel_py.systems.trajectory import Trajectory

__all__ = ["IoPlant", "from_iosystem", "to_scipy"]

Vector = NDArray[np.float64]


def to_scipy(system: Any) -> StateSpace:
    """A linear system as a discrete ``scipy.signal.StateSpace``.

    Parameters
    ----------
    system : Lti, or whatever Lti.of takes

    Raises
    ------
    ArgumentError
        The system has constant terms, which the other form does not have, or is not linear.
    """
    from scipy.signal import StateSpace

    lti = Lti.of(system)
    if not lti.is_homogeneous:
        raise ArgumentError(
            "the system has constant terms, which scipy.signal.StateSpace does not have: shift its origin"
        )
    return StateSpace(lti.A, lti.B, lti.C, lti.D, dt=lti.ts)


@dataclass(frozen=True, eq=False, slots=True)
class IoPlant:
    """A discrete system of python-control that steps like our own forms, for :func:`hysdel_py.closed_loop`.

    Attributes
    ----------
    system : control.InputOutputSystem
    x, u, y : tuple of Variable
        Its signals by their labels, without ranges.
    sample_time : float
    """

    system: Any
    x: tuple[Variable, ...]
    u: tuple[Variable, ...]
    y: tuple[Variable, ...]
    sample_time: float

    @property
    def d(self) -> tuple[Variable, ...]:
        """Boolean auxiliaries: none."""
        return ()

    @property
    def z(self) -> tuple[Variable, ...]:
        """Real auxiliaries: none."""
        return ()

    def step(
        self, x: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] = (), *, check: bool = True
    ) -> tuple[Vector, Vector, Vector, Vector]:
        """Next state and output; there is nothing to check.

        Raises
        ------
        ArgumentError
            Wrong dimension, name or a value that is not finite.
        """
        del check
        state, control = as_vector(x, self.x, "state"), as_vector(u, self.u, "input")
        x1 = np.atleast_1d(np.asarray(self.system.dynamics(0.0, state, control), dtype=float))
        y = np.atleast_1d(np.asarray(self.system.output(0.0, state, control), dtype=float))
        return x1, y, np.zeros(0), np.zeros(0)

    def simulate(
        self, x0: ArrayLike | Mapping[str, float], inputs: ArrayLike, *, ts: float | None = None, check: bool = True
    ) -> Trajectory:
        """Run from a state under a sequence of inputs; see :func:`hysdel_py.systems.simulation.simulate`."""
        from hysdel_py.systems.simulation import simulate

        return simulate(self, x0, inputs, ts=self.sample_time if ts is None else ts, check=check)


def from_iosystem(system: Any, ts: float | None = None) -> IoPlant:
    """A discrete system of python-control as a plant; it must not depend on the time.

    Parameters
    ----------
    system : control.InputOutputSystem
        Also a nonlinear or an interconnected one.
    ts : float, optional
        Sample time, where the system does not say it (``dt=True``).

    Raises
    ------
    ArgumentError
        Something else, a continuous system, or a wrong sample time.
    """
    labels = [getattr(system, f"{word}_labels", None) for word in ("state", "input", "output")]
    if None in labels or not hasattr(system, "dynamics"):
        raise ArgumentError(
            f"system is a {type(system).__name__}: a system of python-control with states was expected, "
            "as control.ss makes it of a transfer function"
        )
    names, kinds = [tuple(group or ()) for group in labels], (Kind.STATE, Kind.INPUT, Kind.OUTPUT)
    x, u, y = (_variables(group, kind) for group, kind in zip(names, kinds, strict=True))
    return IoPlant(system, x, u, y, _sample_time(system, ts))


def _variables(names: Sequence[str], kind: Kind) -> tuple[Variable, ...]:
    return tuple(Variable(name, Type.REAL, kind) for name in names)


def _sample_time(system: Any, ts: float | None) -> float:
    dt = getattr(system, "dt", None)
    if ts is not None and not (isinstance(ts, Real) and 0.0 < ts < float("inf")):
        raise ArgumentError(f"ts is {ts!r}: a positive number was expected")
    if dt is None or (dt is not True and dt == 0):
        raise ArgumentError("the system is continuous: a discrete one was expected, as control.sample_system gives it")
    if dt is True:
        return 1.0 if ts is None else float(ts)
    if ts is not None and not np.isclose(ts, float(dt)):
        raise ArgumentError(f"ts is {ts:g}, but the system is sampled with {float(dt):g}: leave ts out")
    return float(dt)
