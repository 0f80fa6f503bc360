"""What a signal of a linear plan is made of: free moves, slacks, parameters and a constant, each a range of columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Columns"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Columns:
    """Columns of an affine form ``E (v, theta, 1)`` with v = (moves, slacks) and theta = (x, u(-1), r).

    Attributes
    ----------
    nx, nu : int
    moves : int
        Number Nu of free moves, each of nu entries: inputs of a regulator, increments of a tracking controller.
    slacks : int
    previous : bool
        Whether the input applied last is a parameter.
    references : int
        Number of outputs that have a reference.
    stages : int
        Number of times at which references may differ.
    """

    nx: int
    nu: int
    moves: int
    slacks: int
    previous: bool
    references: int
    stages: int

    @property
    def n(self) -> int:
        """Number of decision variables."""
        return self.moves * self.nu + self.slacks

    @property
    def p(self) -> int:
        """Number of parameters."""
        return self.nx + self.nu * self.previous + self.references * self.stages

    @property
    def width(self) -> int:
        """Number of columns."""
        return self.n + self.p + 1

    def zeros(self, rows: int) -> Matrix:
        """Forms that vanish."""
        return np.zeros((rows, self.width))

    def constant(self, values: Matrix) -> Matrix:
        """Forms with the given values, whatever v and theta are."""
        form = self.zeros(len(values))
        form[:, -1] = values
        return form

    def move(self, k: int) -> Matrix:
        """A free move."""
        return self._identity(k * self.nu, self.nu)

    def slack(self, i: int) -> Matrix:
        """A slack, one row."""
        return self._identity(self.moves * self.nu + i, 1)

    @property
    def state(self) -> Matrix:
        """The measured state."""
        return self._identity(self.n, self.nx)

    @property
    def last_input(self) -> Matrix:
        """The input applied last."""
        return self._identity(self.n + self.nx, self.nu)

    def reference(self, k: int) -> Matrix:
        """The references of a stage."""
        start = self.n + self.nx + self.nu * self.previous
        return self._identity(start + k * self.references, self.references)

    def _identity(self, start: int, count: int) -> Matrix:
        form = self.zeros(count)
        form[np.arange(count), start + np.arange(count)] = 1.0
        return form
