"""The arrays that the kernels work on, as named tuples: numba takes them as they are."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.kernels.delassus import Delassus
from hysdel_py.drivetrain.kernels.rows import Rows

__all__ = ["Inputs", "Plant", "Record", "empty_record"]

Array = NDArray[np.float64]


class Plant(NamedTuple):
    """Constant arrays of the equations of motion; see `drivetrain.equations` for the symbols.

    ``laws`` holds static and dynamic coefficient, decay speed and exponent of each contact; ``side`` the lower and
    upper limit of lambda as a share of the capacity. ``damping`` holds the rows of D, ``springs`` those of B', and
    ``mass`` is ``W'M^-1 W``; the kernels take these, whose products cost what there are entries.
    """

    M: Array
    Minv: Array
    D: Array
    B: Array
    k: Array
    W: Array
    G: Array
    laws: Array
    side: Array
    drag_directions: Array
    drag: Array
    map_directions: Array
    map_speed: Array
    map_throttle: Array
    map_torque: Array
    map_sizes: NDArray[np.int64]
    damping: Rows
    springs: Rows
    mass: Delassus


class Inputs(NamedTuple):
    """What the signals contribute, one row for each time.

    ``force`` is the generalised force, ``pressure`` the capacity per unit of friction coefficient, ``twist`` and
    ``slip`` the parts of prescribed speeds, ``slip_rate`` the derivative of the latter.
    """

    force: Array
    pressure: Array
    twist: Array
    slip: Array
    slip_rate: Array
    throttle: Array


class Record(NamedTuple):
    """What a run of N steps writes down, N + 1 rows; `effort` has N: iterations of each step, -1 for a failure.

    ``torques`` are the values of lambda, ``lower`` and ``upper`` their limits, ``works`` the work of sources,
    losses and friction since the start.
    """

    speeds: Array
    twists: Array
    torques: Array
    lower: Array
    upper: Array
    modes: NDArray[np.int64]
    works: Array
    effort: NDArray[np.int64]


def empty_record(steps: int, plant: Plant) -> Record:
    """A record of zeros."""
    n, m, count = len(plant.M), len(plant.k), len(plant.laws)
    torques, lower, upper = (np.zeros((steps + 1, count)) for _ in range(3))
    return Record(
        np.zeros((steps + 1, n)), np.zeros((steps + 1, m)), torques, lower, upper,
        np.zeros((steps + 1, count), np.int64),
        np.zeros((steps + 1, 3)), np.zeros(steps, np.int64),
    )  # fmt: skip
