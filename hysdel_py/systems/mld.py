"""The mixed logical dynamical form: linear dynamics with mixed-integer inequalities.

::

    x+ = A x + B1 u + B2 d + B3 z + B5
    y  = C x + D1 u + D2 d + D3 z + D5
    E2 d + E3 z <= E1 u + E4 x + E5

(Bemporad and Morari, "Control of systems integrating logic, dynamics, and constraints", Automatica 35, 1999,
with the constant columns B5, D5 of the HYSDEL compiler.)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import SimulationError
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Variable, as_vector, range_violations
from hysdel_py.systems.summary import counted, one_line
from hysdel_py.tolerances import DEFAULT_TOLERANCES, Tolerances

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from hysdel_py.systems.auxiliaries import AuxiliarySolver
    from hysdel_py.systems.trajectory import Trajectory

__all__ = ["Mld"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Mld:
    """A mixed logical dynamical system; every array is read-only.

    Vectors hold the real variables first, then the Boolean ones, each in the order of declaration; d holds the
    declared Boolean auxiliaries, then the generated ones, and z likewise.

    Attributes
    ----------
    name : str
    x, u, y, d, z : tuple of Variable
    A, B1, B2, B3, B5 : arrays of nx rows (B5 a vector)
    C, D1, D2, D3, D5 : arrays of ny rows (D5 a vector)
    E1, E2, E3, E4 : sparse arrays of ne rows
    E5 : vector of length ne
    rows, updates, outputs : tuples of RowOrigin
        Origin of each inequality, each row of A and each row of C.
    """

    name: str
    x: tuple[Variable, ...]
    u: tuple[Variable, ...]
    y: tuple[Variable, ...]
    d: tuple[Variable, ...]
    z: tuple[Variable, ...]
    A: Matrix
    B1: Matrix
    B2: Matrix
    B3: Matrix
    B5: Matrix
    C: Matrix
    D1: Matrix
    D2: Matrix
    D3: Matrix
    D5: Matrix
    E1: csr_array
    E2: csr_array
    E3: csr_array
    E4: csr_array
    E5: Matrix
    rows: tuple[RowOrigin, ...]
    updates: tuple[RowOrigin, ...]
    outputs: tuple[RowOrigin, ...]
    source: str = ""
    tolerances: Tolerances = field(default=DEFAULT_TOLERANCES)

    def __repr__(self) -> str:
        return one_line(self, f"{self.nd} d", f"{self.nz} z", counted(len(self.E5), "row"))

    def _repr_html_(self) -> str:
        from hysdel_py.markup.cards import mld_card

        return mld_card(self)

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
    def nd(self) -> int:
        """Number of Boolean auxiliaries."""
        return len(self.d)

    @property
    def nz(self) -> int:
        """Number of real auxiliaries."""
        return len(self.z)

    @property
    def ne(self) -> int:
        """Number of inequality rows."""
        return len(self.E5)

    @cached_property
    def _auxiliaries(self) -> AuxiliarySolver:
        from hysdel_py.systems.auxiliaries import AuxiliarySolver

        return AuxiliarySolver(self)

    def step(
        self, x: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] = (), *, check: bool = True
    ) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """One step: find the auxiliaries that the rows allow, then evaluate the equations.

        Parameters
        ----------
        x : array_like of shape (nx,) or mapping
            State; Booleans are 0 or 1.
        u : array_like of shape (nu,) or mapping
            Input.
        check : bool
            Whether a state or input outside its range is an error at once. Without the check the rows decide, and
            big-M constants may make them wrong there.

        Returns
        -------
        x1, y, d, z : arrays
            Next state, output and auxiliaries. An auxiliary that appears in no row and no equation is 0.

        Raises
        ------
        ArgumentError
            Wrong dimension, name, type or a value that is not finite.
        SimulationError
            Out of range, no auxiliaries satisfy the rows, or more than one choice does.
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
        d, z = self._auxiliaries.solve(state, control)
        x1 = self.A @ state + self.B1 @ control + self.B2 @ d + self.B3 @ z + self.B5
        y = self.C @ state + self.D1 @ control + self.D2 @ d + self.D3 @ z + self.D5
        return x1, y, d, z

    def describe(self) -> str:
        """Text with names instead of matrices: variables, equations, and the rows under the item each came from."""
        from hysdel_py.systems.describe import describe_mld

        return describe_mld(self)

    def simulate(
        self, x0: ArrayLike | Mapping[str, float], inputs: ArrayLike, *, ts: float = 1.0, check: bool = True
    ) -> Trajectory:
        """Run from a state under a sequence of inputs; see :func:`hysdel_py.systems.simulation.simulate`."""
        from hysdel_py.systems.simulation import simulate

        return simulate(self, x0, inputs, ts=ts, check=check)
