"""Squares of binaries as linear terms: from a mixed-integer program to one with the same values at 0 and 1.

A binary is its own square, so that ``c/2 d^2`` may be written ``c/2 d``. Between 0 and 1 the latter is greater: a
relaxation that switches something on by a third then pays a third of its price and not a ninth. As much of the
diagonal of the Hessian is moved as leaves it positive semidefinite.

Source: P. L. Hammer and A. A. Rubin, "Some remarks on quadratic programming with 0-1 variables", RAIRO 4, 1970.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hysdel_py.optimize.certificate import diagonal_curvature
from hysdel_py.optimize.mixed_integer import Miqp
from hysdel_py.optimize.qp import Qp

__all__ = ["without_binary_squares"]

Vector = NDArray[np.float64]


def without_binary_squares(miqp: Miqp) -> tuple[Miqp, Vector]:
    """Move the squares of binaries into the linear cost.

    Parameters
    ----------
    miqp : Miqp

    Returns
    -------
    program : Miqp
        With the same rows, variables and values at all points whose binaries are 0 or 1; `miqp` itself if it has no
        such squares.
    shift : array of shape (n,)
        What was added to the linear cost.
    """
    curvature = np.zeros(miqp.qp.n)
    curvature[miqp.binaries] = diagonal_curvature(miqp.qp.P)[miqp.binaries]
    if not curvature.any():
        return miqp, curvature
    return replace(miqp, qp=_moved(miqp.qp, curvature)), curvature / 2


def _moved(qp: Qp, curvature: Vector) -> Qp:
    from scipy.sparse import csc_array, diags_array

    P = csc_array(qp.P - diags_array(curvature))
    P.eliminate_zeros()
    return replace(qp, P=P, q=qp.q + curvature / 2)
