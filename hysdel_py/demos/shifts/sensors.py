"""What a controller of a shift gets to see of the state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.transmission import STATES
from hysdel_py.errors import ArgumentError

__all__ = ["NOISE", "Sensors"]

Vector = NDArray[np.float64]

NOISE: Mapping[str, float] = {"we": 0.2, "ws": 0.2, "wv": 0.02, "Te": 0.5, "Fnb": 0.5, "Fnc": 0.5}
"""Standard deviations of the studies with noise: speeds [rad/s], torque [Nm], forces [N]."""


@dataclass(eq=False)
class Sensors:
    """Measurements of the state with normal noise, the same for the same seed.

    Parameters
    ----------
    noise : mapping of state to float
        Standard deviations.
    seed : int

    Raises
    ------
    ArgumentError
        There is no such state, or a negative deviation.
    """

    noise: Mapping[str, float] = field(default_factory=dict)
    seed: int = 0

    def __post_init__(self) -> None:
        for name, size in self.noise.items():
            if name not in STATES:
                raise ArgumentError(f"noise of {name!r}: one of {', '.join(STATES)} was expected")
            if not size >= 0.0:
                raise ArgumentError(f"noise of {name} is {size!r}: a number from 0 up was expected")
        self._sizes = np.array([self.noise.get(name, 0.0) for name in STATES])
        self._rng = np.random.default_rng(self.seed)
        self._state, self._seen = np.full(len(STATES), np.nan), np.full(len(STATES), np.nan)

    def read(self, x: Vector) -> Vector:
        """The measurement of a state; who asks again before the state moves gets the same one."""
        if not np.array_equal(x, self._state):
            self._state = np.array(x, dtype=float)
            self._seen = self._state + self._sizes * self._rng.standard_normal(len(self._sizes))
        return self._seen.copy()
