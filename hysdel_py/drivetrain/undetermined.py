"""Torques that the friction law leaves open: of sticking contacts whose slips depend on each other.

Two clutches beside each other between the same shafts, or two brakes and a clutch between them, carry a torque
together. While they stick the motion says what their torques add up to, and their limits how far each may go, but
nothing says how they share it. Speeds are unique all the same; a scheme picks one of many torques.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["sharing_message", "undetermined_torques"]

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]
Codes = NDArray[np.int64]

INSIDE, AT_LOWER, AT_UPPER, NOWHERE = 0, 1, 2, 3
_POSITIVE, _STICK, _NEGATIVE = 1, 0, -1

ZERO_SLIP = 1e-9
"""A sliding contact whose slip is below this share of the speeds it is the difference of stands at its limit only."""

ZERO_SHARE = 1e-7
"""A torque that can change by less than this share of the greatest change is fixed."""


def undetermined_torques(W: Matrix, speeds: Matrix, slips: Matrix, modes: Codes) -> Mask:
    """Which torques at which samples are one choice of many.

    Parameters
    ----------
    W : array of shape (n, nc)
        Directions of the contacts.
    speeds, slips, modes : arrays of shape (N, n), (N, nc), (N, nc)

    Returns
    -------
    bool array of shape (N, nc)
    """
    found = np.zeros(slips.shape, dtype=bool)
    index = np.flatnonzero(_in_loops(W))
    if len(index) < 2 or np.linalg.matrix_rank(W[:, index]) == len(index):
        return found
    patterns, which = np.unique(
        _codes(W[:, index], speeds, slips[:, index], modes[:, index]), axis=0, return_inverse=True
    )
    free = np.array([_free(W[:, index], pattern) for pattern in patterns])
    found[:, index] = free[which.ravel()]
    return found


def sharing_message(t: Matrix, undetermined: Mask, contacts: Sequence[str]) -> tuple[str, ...]:
    """One sentence about such torques, or none."""
    when = np.flatnonzero(undetermined.any(axis=1))
    if not len(when):
        return ()
    names = [contacts[int(i)] for i in np.flatnonzero(undetermined.any(axis=0))]
    return (
        f"the torques of {', '.join(names)} are not unique in {len(when)} of {len(t)} samples, first at "
        f"t = {t[when[0]]:.6g} s: these contacts stick together and the friction law does not say how they "
        "share what they carry",
    )


def _in_loops(W: Matrix) -> Mask:
    """Contacts that may depend on others: what no shaft has for itself alone, taken off again and again."""
    from scipy.sparse import csr_array

    entries = csr_array((W != 0).astype(float))
    left = np.ones(W.shape[1])
    while True:
        alone = (entries @ left == 1).astype(float)
        removed = (entries.T @ alone > 0) & (left > 0)
        if not removed.any():
            return left > 0
        left[removed] = 0.0


def _codes(W: Matrix, speeds: Matrix, slips: Matrix, modes: Codes) -> Codes:
    """Where each torque lies between its limits, of the contacts at zero slip."""
    scale = ZERO_SLIP * np.maximum(1.0, np.abs(speeds) @ np.abs(W))
    still = np.abs(slips) <= scale
    codes = np.full(modes.shape, NOWHERE, dtype=np.int64)
    codes[modes == _STICK] = INSIDE
    codes[still & (modes == _POSITIVE)] = AT_LOWER
    codes[still & (modes == _NEGATIVE)] = AT_UPPER
    return codes


def _free(W: Matrix, codes: Codes) -> Mask:
    """Contacts whose torque can change without a change of any slip: ``W z = 0``, and into its limits."""
    free = np.zeros(len(codes), dtype=bool)
    index = np.flatnonzero(codes != NOWHERE)
    if not np.any(codes[index] == INSIDE):
        return free
    null = _null_space(W[:, index])
    moves = np.abs(null).max(axis=1, initial=0.0) > ZERO_SHARE
    if np.any(codes[index][moves] != INSIDE):
        moves = _reachable(W[:, index], codes[index], moves)
    free[index] = moves
    return free if np.any(free & (codes == INSIDE)) else np.zeros(len(codes), dtype=bool)


def _null_space(W: Matrix) -> Matrix:
    _, values, vectors = np.linalg.svd(W)
    rank = int(np.sum(values > ZERO_SHARE * values.max(initial=0.0)))
    null: Matrix = vectors[rank:].T
    return null


def _reachable(W: Matrix, codes: Codes, candidates: Mask) -> Mask:
    """The same where some are at a limit, by one linear program for each contact and direction."""
    from scipy.optimize import linprog

    bounds = [{AT_LOWER: (0.0, 1.0), AT_UPPER: (-1.0, 0.0)}.get(int(code), (-1.0, 1.0)) for code in codes]
    found = np.zeros(len(codes), dtype=bool)
    for i in np.flatnonzero(candidates):
        for sign in (1.0, -1.0):
            cost = np.zeros(len(codes))
            cost[i] = sign
            answer = linprog(cost, A_eq=W, b_eq=np.zeros(len(W)), bounds=bounds)
            found[i] |= answer.status == 0 and answer.fun < -ZERO_SHARE
    return found
