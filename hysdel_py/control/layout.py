"""Where each signal of each stage sits in the vector of decision variables."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.affine import Affine
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import Variable

__all__ = ["Layout", "Plan"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Values of all signals over the horizon.

    Attributes
    ----------
    x : array of shape (N+1, nx)
    u, d, z : arrays of shape (N, n)
    slack : array, one entry per softened signal
    """

    x: Matrix
    u: Matrix
    d: Matrix
    z: Matrix
    slack: Matrix


@dataclass(frozen=True, slots=True)
class Layout:
    """Order of the decision variables: ``[u_k, d_k, z_k, x_{k+1}]`` for each stage k = 0..N-1, the slacks, the terms.

    What a plan starts from are the parameters ``(x_0, u_{-1})``: the measured state and the input applied last.

    Attributes
    ----------
    mld : Mld
    horizon : int
    slacks : tuple of str
    terms : tuple of str
        Terms of a cost with absolute values, each a variable not below its term.
    """

    mld: Mld
    horizon: int
    slacks: tuple[str, ...]
    terms: tuple[str, ...] = ()

    @property
    def stage_size(self) -> int:
        """Number of variables of one stage."""
        return self.mld.nu + self.mld.nd + self.mld.nz + self.mld.nx

    @property
    def n(self) -> int:
        """Number of decision variables."""
        return self.horizon * self.stage_size + len(self.slacks) + len(self.terms)

    @property
    def parameters(self) -> int:
        """Number of parameters."""
        return self.mld.nx + self.mld.nu

    @property
    def stage_variables(self) -> tuple[Variable, ...]:
        """What the variables of one stage stand for."""
        return (*self.mld.u, *self.mld.d, *self.mld.z, *self.mld.x)

    def start(self, group: str, k: int) -> int:
        """Index of the first entry of ``u_k``, ``d_k``, ``z_k`` or, for k >= 1, ``x_k``."""
        m = self.mld
        before = {"u": 0, "d": m.nu, "z": m.nu + m.nd, "x": m.nu + m.nd + m.nz}[group]
        return (k - 1 if group == "x" else k) * self.stage_size + before

    def slack(self, index: int) -> int:
        """Index of a slack variable."""
        return self.horizon * self.stage_size + index

    def term(self, index: int) -> int:
        """Index of the variable of a term."""
        return self.horizon * self.stage_size + len(self.slacks) + index

    def signal(self, group: str, k: int) -> Affine:
        """Return ``x_k``, ``u_k``, ``u_k - u_{k-1}`` (du), ``d_k``, ``z_k`` or ``y_k`` in terms of the variables.

        ``u_{-1}`` is a parameter, as is ``x_0``.
        """
        match group:
            case "y":
                return self._combination(k, "C", "D1", "D2", "D3").shifted(self.mld.D5)
            case "x" if k == 0:
                return self._parameter(0, self.mld.nx)
            case "u" if k < 0:
                return self._parameter(self.mld.nx, self.mld.nu)
            case "du":
                return self.signal("u", k) - self.signal("u", k - 1)
            case _:
                size = len(getattr(self.mld, group))
                return self._selection(np.arange(size) + self.start(group, k), np.ones(size))

    def successor(self, k: int) -> Affine:
        """Return ``A x_k + B1 u_k + B2 d_k + B3 z_k + B5``."""
        return self._combination(k, "A", "B1", "B2", "B3").shifted(self.mld.B5)

    def final_output(self) -> Affine:
        """Return ``C x_N + D5``, the output of the last state as far as no input or auxiliary enters it."""
        return self.signal("x", self.horizon).times(self.mld.C).shifted(self.mld.D5)

    def inequalities(self, k: int) -> Affine:
        """Return ``E2 d_k + E3 z_k - E1 u_k - E4 x_k - E5``, which must not be positive."""
        m = self.mld
        left = self.signal("d", k).times(m.E2) + self.signal("z", k).times(m.E3)
        return (left - self.signal("u", k).times(m.E1) - self.signal("x", k).times(m.E4)).shifted(-m.E5)

    def single(self, index: int, value: float) -> Affine:
        """Return one decision variable times a number, as a vector of length 1."""
        return self._selection(np.array([index]), np.array([value]))

    def split(self, v: Matrix, x0: Matrix) -> Plan:
        """Sort the decision variables back into signals."""
        m, N = self.mld, self.horizon
        stages = v[: N * self.stage_size].reshape(N, self.stage_size)
        d, z, after = m.nu, m.nu + m.nd, m.nu + m.nd + m.nz
        x = np.empty((N + 1, m.nx))
        x[0], x[1:] = x0, stages[:, after:]
        return Plan(x, stages[:, :d].copy(), stages[:, d:z].copy(), stages[:, z:after].copy(), self._slack_part(v))

    def join(self, plan: Plan) -> Matrix:
        """Inverse of :meth:`split`, with zeros for the terms."""
        stages = np.hstack([plan.u, plan.d, plan.z, plan.x[1:]])
        return np.concatenate([stages.ravel(), plan.slack, np.zeros(len(self.terms))])

    def describe(self, index: int) -> str:
        """Say in words what a decision variable is, for example ``z[3] Tcl (line 23)``."""
        beyond = index - self.horizon * self.stage_size
        if beyond >= len(self.slacks):
            return f"cost of {self.terms[beyond - len(self.slacks)]}"
        if beyond >= 0:
            return f"slack of {self.slacks[beyond]}"
        k, column = divmod(index, self.stage_size)
        variable = self.stage_variables[column]
        letter = variable.kind.value
        time = k + 1 if letter == "x" else k
        return f"{letter}[{time}] {variable.name}" + (f" (line {variable.line})" if variable.line else "")

    def _combination(self, k: int, X: str, U: str, D: str, Z: str) -> Affine:
        m = self.mld
        return (
            self.signal("x", k).times(getattr(m, X))
            + self.signal("u", k).times(getattr(m, U))
            + self.signal("d", k).times(getattr(m, D))
            + self.signal("z", k).times(getattr(m, Z))
        )

    def _selection(self, indices: NDArray[np.intp], values: Matrix) -> Affine:
        from scipy.sparse import csr_array

        size = len(indices)
        V = csr_array((values, (np.arange(size), indices)), shape=(size, self.n))
        return Affine(V, np.zeros((size, self.parameters)), np.zeros(size))

    def _parameter(self, start: int, size: int) -> Affine:
        from scipy.sparse import csr_array

        X = np.eye(self.parameters)[start : start + size]
        return Affine(csr_array((size, self.n)), X, np.zeros(size))

    def _slack_part(self, v: Matrix) -> Matrix:
        start = self.slack(0)
        return v[start : start + len(self.slacks)].copy()
