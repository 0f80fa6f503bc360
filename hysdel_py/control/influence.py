"""Which outputs can an input influence within the same step?"""

from __future__ import annotations

import numpy as np

from hysdel_py.systems.mld import Mld

__all__ = ["influenced_outputs"]


def influenced_outputs(mld: Mld) -> tuple[bool, ...]:
    """Say for each output whether ``y_k`` may depend on ``u_k``.

    The answer follows the definitions of the auxiliaries in the source, not the numbers: an auxiliary depends on the
    inputs when a row that defines it mentions an input or another such auxiliary. One that no row defines is free, and
    so is whatever depends on it.
    """
    moving = _influenced_auxiliaries(mld)
    d = np.array([v.name in moving for v in mld.d], dtype=bool)
    z = np.array([v.name in moving for v in mld.z], dtype=bool)
    return tuple(bool(mld.D1[i].any() or mld.D2[i, d].any() or mld.D3[i, z].any()) for i in range(mld.ny))


def _influenced_auxiliaries(mld: Mld) -> set[str]:
    auxiliaries = {v.name for v in (*mld.d, *mld.z)}
    depends: dict[str, set[str]] = {}
    for row in mld.rows:
        if row.defines in auxiliaries:
            depends.setdefault(row.defines, set()).update(row.depends)
    moving = {v.name for v in mld.u} | (auxiliaries - set(depends))
    while True:
        more = {name for name, on in depends.items() if name not in moving and on & moving}
        if not more:
            return moving & auxiliaries
        moving |= more
