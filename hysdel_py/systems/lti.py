"""Sampled linear systems, with constant terms where a model has them.

::

    x+ = A x + B u + f
    y  = C x + D u + g
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import SimulationError
from hysdel_py.systems.lti_checks import checked_sample_time, matrix, named_variables, numbers, outputs_named
from hysdel_py.systems.signals import Kind, Variable, as_vector, range_violations
from hysdel_py.tolerances import DEFAULT_TOLERANCES, Tolerances

if TYPE_CHECKING:
    from hysdel_py.systems.trajectory import Trajectory

__all__ = ["Lti"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Names: TypeAlias = Sequence[str | Variable]


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Lti:
    """A sampled linear (or affine) time-invariant system; every array is read-only.

    Parameters
    ----------
    A : array_like of shape (nx, nx)
    B : array_like of shape (nx, nu)
    C : array_like of shape (ny, nx), optional
        The outputs are the states, under their names, where it is left out.
    D : array_like of shape (ny, nu), optional
        Zero where it is left out.
    ts : float
        Sample time, in seconds unless time has another unit.
    x, u, y : sequences of names or of Variable, optional
        Names of the signals, with a unit in brackets after a space if there is one: ``"we [rad/s]"``. By default
        ``x1, x2, ...``, ``u1, ...``, ``y1, ...``.
    f, g : array_like of shapes (nx,), (ny,), optional
        Constant terms of the update and of the output; zero where they are left out.
    name : str
    tolerances : Tolerances

    Raises
    ------
    ArgumentError
        Shapes that do not fit together, entries that are not finite, a name given twice, a sample time that is not
        positive.

    Examples
    --------
    >>> tank = Lti([[0.9]], [[0.1]], x=("level [m]",), u=("flow",), ts=2.0)
    >>> tank.step([1.0], [0.5])[0]
    array([0.95])
    """

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    ts: float
    x: tuple[Variable, ...]
    u: tuple[Variable, ...]
    y: tuple[Variable, ...]
    f: Vector
    g: Vector
    name: str
    tolerances: Tolerances

    def __init__(
        self,
        A: ArrayLike,
        B: ArrayLike,
        C: ArrayLike | None = None,
        D: ArrayLike | None = None,
        *,
        ts: float = 1.0,
        x: Names = (),
        u: Names = (),
        y: Names = (),
        f: ArrayLike | None = None,
        g: ArrayLike | None = None,
        name: str = "lti",
        tolerances: Tolerances = DEFAULT_TOLERANCES,
    ) -> None:
        a = matrix(A, "A")
        nx = len(a)
        a = numbers(a, "A", (nx, nx))
        b = matrix(B, "B", rows=nx)
        c = np.eye(nx) if C is None else matrix(C, "C", columns=nx)
        nu, ny = b.shape[1], len(c)
        states = named_variables(x, Kind.STATE, nx)
        outputs = outputs_named(states) if C is None and not y else y
        values: dict[str, Any] = {
            "A": a,
            "B": numbers(b, "B", (nx, nu)),
            "C": numbers(c, "C", (ny, nx)),
            "D": numbers(D, "D", (ny, nu)),
            "ts": checked_sample_time(ts),
            "x": states,
            "u": named_variables(u, Kind.INPUT, nu),
            "y": named_variables(outputs, Kind.OUTPUT, ny),
            "f": numbers(f, "f", (nx,)),
            "g": numbers(g, "g", (ny,)),
            "name": name,
            "tolerances": tolerances,
        }
        for key, value in values.items():
            object.__setattr__(self, key, value)

    @classmethod
    def sampled(
        cls,
        A: ArrayLike,
        B: ArrayLike,
        C: ArrayLike | None = None,
        D: ArrayLike | None = None,
        *,
        ts: float,
        **named: Any,
    ) -> Lti:
        """Sample ``dx/dt = A x + B u (+ f)``, with the input held constant over each sample time.

        Parameters
        ----------
        A, B, C, D : array_like
            Matrices of the continuous system.
        ts : float
            Sample time.
        **named
            ``x, u, y, f, g, name`` as for :class:`Lti`; `f` is the constant term of the derivative.
        """
        from hysdel_py.systems.sampling import sample

        return sample(cls(A, B, C, D, ts=ts, **named))

    @classmethod
    def of(cls, system: Any, ts: float | None = None) -> Lti:
        """Take a system over from elsewhere.

        Parameters
        ----------
        system : Lti, Model, Dha, scipy.signal or python-control system
            A model without logic; of scipy ``StateSpace``, ``TransferFunction`` and ``ZerosPolesGain``, continuous or
            discrete; of python-control ``StateSpace`` and ``TransferFunction`` with one input and one output.
        ts : float, optional
            Sample time: needed for a continuous system, which is sampled with the input held, and must be that of a
            discrete system if it is given.

        Raises
        ------
        ArgumentError
            Something else, a model with logic, or a missing or contradicting sample time.
        """
        from hysdel_py.systems.lti_sources import lti_of

        return lti_of(system, ts)

    @property
    def nx(self) -> int:
        """Number of states."""
        return len(self.x)

    @property
    def nu(self) -> int:
        """Number of inputs."""
        return len(self.u)

    @property
    def ny(self) -> int:
        """Number of outputs."""
        return len(self.y)

    @property
    def d(self) -> tuple[Variable, ...]:
        """Boolean auxiliaries: none."""
        return ()

    @property
    def z(self) -> tuple[Variable, ...]:
        """Real auxiliaries: none."""
        return ()

    @property
    def sample_time(self) -> float:
        """The sample time, under the name that plants and controllers share."""
        return self.ts

    @property
    def is_homogeneous(self) -> bool:
        """Whether there are no constant terms, so that the origin is a rest point."""
        return not (self.f.any() or self.g.any())

    @property
    def is_stable(self) -> bool:
        """Whether all eigenvalues of A lie inside the unit circle."""
        return bool(np.abs(np.linalg.eigvals(self.A)).max(initial=0.0) < 1.0)

    def step(
        self, x: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] = (), *, check: bool = True
    ) -> tuple[Vector, Vector, Vector, Vector]:
        """One step.

        Parameters
        ----------
        x : array_like of shape (nx,) or mapping
        u : array_like of shape (nu,) or mapping
        check : bool
            Whether a state or input outside a declared range is an error.

        Returns
        -------
        x1, y, d, z : arrays
            Next state and output; d and z are empty, so that all forms of a system step alike.

        Raises
        ------
        ArgumentError
            Wrong dimension, name or a value that is not finite.
        SimulationError
            Out of range.
        """
        state, control = as_vector(x, self.x, "state"), as_vector(u, self.u, "input")
        if check:
            tolerance = self.tolerances.range
            problems = (
                *range_violations(state, self.x, "state", tolerance),
                *range_violations(control, self.u, "input", tolerance),
            )
            if problems:
                raise SimulationError(problems)
        x1 = self.A @ state + self.B @ control + self.f
        return x1, self.C @ state + self.D @ control + self.g, np.zeros(0), np.zeros(0)

    def simulate(
        self, x0: ArrayLike | Mapping[str, float], inputs: ArrayLike, *, ts: float | None = None, check: bool = True
    ) -> Trajectory:
        """Run from a state under a sequence of inputs; see :func:`hysdel_py.systems.simulation.simulate`."""
        from hysdel_py.systems.simulation import simulate

        return simulate(self, x0, inputs, ts=self.ts if ts is None else ts, check=check)

    def describe(self) -> str:
        """The equations with names."""
        from hysdel_py.systems.describe_lti import describe_lti

        return describe_lti(self)

    def __repr__(self) -> str:
        return f"<Lti {self.name}: {self.nx} states, {self.nu} inputs, {self.ny} outputs, ts={self.ts:g}>"
