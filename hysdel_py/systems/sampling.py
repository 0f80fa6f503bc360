"""Sampling of continuous linear systems whose input is held constant over each sample time.

With u constant, ``(x, u, 1)`` obeys a linear differential equation, whose solution over one sample time is the
exponential of its matrix (C. Van Loan, "Computing integrals involving the matrix exponential", IEEE Trans. Automatic
Control 23, 1978).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.lti import Lti

__all__ = ["sample"]


def sample(continuous: Lti) -> Lti:
    """The sampled form of a system whose A, B and f are those of a derivative.

    Parameters
    ----------
    continuous : Lti
        With the sample time in ``ts``.

    Raises
    ------
    ArgumentError
        The exponential overflows: the sample time is far too long for the dynamics.
    """
    from scipy.linalg import expm

    nx, nu = continuous.B.shape
    generator = np.zeros((nx + nu + 1, nx + nu + 1))
    generator[:nx] = np.column_stack([continuous.A, continuous.B, continuous.f])
    with np.errstate(over="ignore", invalid="ignore"):
        flow = expm(generator * continuous.ts)[:nx]
    if not np.isfinite(flow).all():
        raise ArgumentError(f"the system grows without bound within ts = {continuous.ts:g}: a shorter one was expected")
    return replace(continuous, A=flow[:, :nx], B=flow[:, nx : nx + nu], f=flow[:, -1])
