"""Derivatives of the smooth equations of motion, for the Newton iterations of an implicit method.

Springs, damping and the steep part of friction are what makes the equations stiff; they are exact here. Drag, engine
maps and the fall of Stribeck friction are left out, which such iterations bear, and so are the rates of the works, on
which nothing depends.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.kernels.arrays import Plant
from hysdel_py.drivetrain.schemes.segments import Segment
from hysdel_py.drivetrain.structure import SMALLEST_BAND

__all__ = ["jacobian_of", "limits_at"]

Matrix = NDArray[np.float64]

_WORKS = 3


def jacobian_of(plant: Plant, segment: Segment, steepness: float) -> Callable[[float, Matrix], Any]:
    """Derivative of the rates of (u, e, works) by the state, as a function of time and state.

    A dense array, or a sparse one in compressed columns for large plants.
    """
    n, m = len(plant.M), len(plant.k)
    size = n + m + _WORKS
    constant = np.zeros((size, size))
    constant[:n, :n] = -plant.Minv @ plant.D
    constant[:n, n : n + m] = -plant.Minv @ (plant.B * plant.k)
    constant[n : n + m, :n] = plant.B.T
    gain, slips = np.zeros((size, len(plant.laws))), np.zeros((len(plant.laws), size))
    gain[:n], slips[:, :n] = plant.Minv @ plant.W, plant.W.T
    if size >= SMALLEST_BAND:
        constant, gain, slips = (_compressed(block) for block in (constant, gain, slips))

    def jacobian(t: float, state: Matrix) -> Any:
        slope = _slopes(plant, segment, steepness, t, state[:n])
        return constant + (gain * slope) @ slips if isinstance(gain, np.ndarray) else _sum(constant, gain, slope, slips)

    return jacobian


def _slopes(plant: Plant, segment: Segment, steepness: float, t: float, u: Matrix) -> Matrix:
    """Derivatives of the torques lambda by the slips."""
    inputs = segment.at(t)
    slip = u @ plant.W + inputs.slip
    lower, upper = limits_at(plant, inputs.pressure, slip)
    slope: Matrix = -(upper - lower) / np.pi * steepness / (1.0 + (steepness * slip) ** 2)
    return slope


def limits_at(plant: Plant, pressure: Matrix, slip: Matrix) -> tuple[Matrix, Matrix]:
    """Lower and upper limits of lambda for sliding contacts, arrays of shape (..., nc)."""
    static, dynamic, speed, exponent = plant.laws.T
    decay = np.exp(-((np.abs(slip) / np.where(speed > 0, speed, 1.0)) ** exponent))
    capacity = np.where(speed > 0, dynamic + (static - dynamic) * decay, dynamic) * pressure
    return plant.side[:, 0] * capacity, plant.side[:, 1] * capacity


def _compressed(block: Matrix) -> Any:
    from scipy.sparse import csc_array

    return csc_array(block)


def _sum(constant: Any, gain: Any, slope: Matrix, slips: Any) -> Any:
    from scipy.sparse import csc_matrix, diags_array

    return csc_matrix(constant + gain @ diags_array(slope) @ slips)  # solve_ivp takes the older class
