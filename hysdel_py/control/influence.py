"""Which signals can the inputs of a plan influence?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import Variable

__all__ = ["influenced_outputs", "settled_signals"]

Flags = NDArray[np.bool_]


def influenced_outputs(mld: Mld) -> tuple[bool, ...]:
    """Say for each output whether ``y_k`` may depend on ``u_k``.

    The answer follows the definitions of the auxiliaries in the source, not the numbers: an auxiliary depends on the
    inputs when a row that defines it mentions an input or another such auxiliary. One that no row defines is free, and
    so is whatever depends on it.
    """
    return tuple(_moved_outputs(mld, np.zeros(mld.nx, dtype=bool)).tolist())


def settled_signals(mld: Mld, horizon: int) -> frozenset[tuple[str, int, int]]:
    """States and outputs of a plan that the measured state settles, whatever the inputs are.

    Returns
    -------
    set of (group, column, time)
        ``"x"`` for the times 1 to N, ``"y"`` for 0 to N-1.
    """
    found: list[tuple[str, int, int]] = []
    moved = np.zeros(mld.nx, dtype=bool)
    for time in range(horizon):
        outputs = _moved_outputs(mld, moved)
        moved = _moved_states(mld, moved)
        found += [("y", int(i), time) for i in np.flatnonzero(~outputs)]
        found += [("x", int(i), time + 1) for i in np.flatnonzero(~moved)]
        if moved.all():
            break
    return frozenset(found)


def _moved_outputs(mld: Mld, states: Flags) -> Flags:
    """Outputs that an input of the same time, or a state that inputs have moved, may change."""
    d, z = _moved_auxiliaries(mld, states)
    moved: Flags = _touches(mld.C, states) | mld.D1.any(axis=1) | _touches(mld.D2, d) | _touches(mld.D3, z)
    return moved


def _moved_states(mld: Mld, states: Flags) -> Flags:
    """States of the next time that an input of this time, or a state that inputs have moved, may change."""
    d, z = _moved_auxiliaries(mld, states)
    moved: Flags = _touches(mld.A, states) | mld.B1.any(axis=1) | _touches(mld.B2, d) | _touches(mld.B3, z)
    return moved


def _touches(matrix: NDArray[np.float64], columns: Flags) -> Flags:
    return np.asarray(matrix[:, columns].any(axis=1), dtype=bool)


def _moved_auxiliaries(mld: Mld, states: Flags) -> tuple[Flags, Flags]:
    auxiliaries = {v.name for v in (*mld.d, *mld.z)}
    depends: dict[str, set[str]] = {}
    for row in mld.rows:
        if row.defines in auxiliaries:
            depends.setdefault(row.defines, set()).update(row.depends)
    moving = {v.name for v in mld.u} | (auxiliaries - set(depends))
    moving |= {v.name for v, moved in zip(mld.x, states, strict=True) if moved}
    while True:
        more = {name for name, on in depends.items() if name not in moving and on & moving}
        if not more:
            return _named(mld.d, moving), _named(mld.z, moving)
        moving |= more


def _named(variables: tuple[Variable, ...], names: set[str]) -> Flags:
    return np.array([v.name in names for v in variables], dtype=bool)
