"""All signals of a linear plan as affine forms of the free moves and the parameters.

The states are eliminated: x_{k+1} = A x_k + B u_k + f is put in from stage to stage.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.linear_columns import Columns
from hysdel_py.systems.lti import Lti

__all__ = ["LinearPrediction", "predict"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class LinearPrediction:
    """Forms of the signals, each of shape (rows, width).

    Attributes
    ----------
    columns : Columns
    x : tuple of N+1 arrays
    u, du : tuples of N arrays, or N+1 where the input of time N matters
        After the last free move it is what the rule for inputs gives: held, or K x.
    y : tuple of arrays
        As many as there are inputs, and one at time N as well where no input acts on it.
    """

    columns: Columns
    x: tuple[Matrix, ...]
    u: tuple[Matrix, ...]
    du: tuple[Matrix, ...]
    y: tuple[Matrix, ...]


def predict(
    models: Sequence[Lti], columns: Columns, inputs: int, tracks: bool, gain: Callable[[], Matrix]
) -> LinearPrediction:
    """Forms of all signals.

    Parameters
    ----------
    models : sequence of Lti
        One per stage; the last one also gives the output at the end.
    columns : Columns
    inputs : int
        Number of times whose inputs are asked for, N or N+1.
    tracks : bool
        Whether the moves are increments, and zero after the last one; otherwise they are inputs, and K x follows.
    gain : callable
        K, asked for only where the plan uses it.
    """
    x, u, du, y = [columns.state], [], [], []
    last = columns.last_input if columns.previous else columns.zeros(columns.nu)
    for k in range(len(models) + 1):
        lti = models[min(k, len(models) - 1)]
        output = lti.C @ x[k] + columns.constant(lti.g)
        if k < inputs:
            u.append(_free_input(columns, k, last, tracks) if k < columns.moves else last if tracks else gain() @ x[k])
            du.append(u[k] - last)
            last = u[k]
            y.append(output + lti.D @ last)
        elif not lti.D.any():
            y.append(output)
        if k < len(models):
            x.append(lti.A @ x[k] + lti.B @ last + columns.constant(lti.f))
    return LinearPrediction(columns, tuple(x), tuple(u), tuple(du), tuple(y))


def _free_input(columns: Columns, k: int, last: Matrix, tracks: bool) -> Matrix:
    return last + columns.move(k) if tracks else columns.move(k)
