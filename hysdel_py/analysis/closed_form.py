"""The closed loop of a piecewise affine system with an explicit law as a piecewise affine system of its own.

Input form: a Pwa and a law over its states. Output form: a Pwa without inputs whose modes are the parts of the law's
regions on which one mode holds. Preserved: states, outputs, and every step that starts in a region of the law; a part
without inner points is left out unless its mode has none.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hysdel_py.analysis.cells import AffineLaw, Cell, cells_of
from hysdel_py.analysis.reach import HasPwa, pwa_of
from hysdel_py.systems.mode import Condition, Mode, RowKind
from hysdel_py.systems.pwa import Pwa

__all__ = ["closed_loop_pwa"]


def closed_loop_pwa(system: Pwa | HasPwa, law: AffineLaw) -> Pwa:
    """Close the loop of a system with a law.

    Parameters
    ----------
    system : Pwa or Model
        With real states and inputs.
    law : ExplicitLaw
        Its parameters are the states, in their order.

    Returns
    -------
    Pwa
        Without inputs; reachable sets, invariant sets, Lyapunov functions and limit cycles of it are those of the
        closed loop. Where the law has no region, the run ends.

    Raises
    ------
    ArgumentError
        For Boolean states or inputs, and a law over other parameters than the states.
    """
    pwa = pwa_of(system)
    cells = cells_of(pwa, law, flat=True)
    modes = tuple(_mode(k, cell, pwa, law) for k, cell in enumerate(cells))
    return replace(
        pwa, name=f"closed loop of {pwa.name}", u=(), d=(), z=(), modes=modes, tree=None, tests=(), leaves=(),
        owner=tuple(range(len(modes))), dead_ends=(),
    )  # fmt: skip


def _mode(index: int, cell: Cell, pwa: Pwa, law: AffineLaw) -> Mode:
    own = pwa.modes[cell.mode]
    assert cell.law is not None  # the cells were made with a law
    K, k = (np.asarray(part[cell.law])[: len(pwa.u)] for part in (law.K, law.k))
    sources = tuple(Condition(RowKind.EVENT, f"region {cell.law}") for _ in range(cell.region.m))
    n, ny = len(pwa.x), len(pwa.y)
    return Mode(
        index, cell.A, np.zeros((n, 0)), cell.f, own.C + own.D @ K, np.zeros((ny, 0)), own.g + own.D @ k, cell.region,
        sources, (), False, tuple(v.name for v in pwa.x),
    )  # fmt: skip
