"""Plans that follow the model: simulated binaries, shifted plans, and plans as trajectories."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.formulation import Formulation
from hysdel_py.control.layout import Plan
from hysdel_py.errors import HysdelError
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from hysdel_py.optimize.mixed_integer import Cover

__all__ = [
    "Step",
    "as_trajectory",
    "choose_step",
    "shifted",
    "shifted_cover",
    "shifted_experience",
    "shifted_sides",
    "shifted_variables",
    "simulated_binaries",
]

Matrix = NDArray[np.float64]
Indices = NDArray[np.int64]
REMEMBERED = 4.0
"""An old pseudo-cost counts as this many observations at most."""
Step = Callable[[Matrix, Matrix], tuple[Matrix, Matrix, Matrix, Matrix]]


def choose_step(model: Any, mld: Mld) -> Step | None:
    """Return the fastest simulation of a model whose auxiliaries are those of its MLD form, None if there is none.

    It does not check ranges: inputs that lead slightly out of them may still have the binaries of a good plan.
    """
    dha = getattr(model, "dha", None)
    if dha is not None and _same_auxiliaries(dha, mld):
        return partial(dha.step, check=False)
    return getattr(mld, "step", None)


def _same_auxiliaries(dha: Any, mld: Mld) -> bool:
    return all(
        tuple(v.name for v in getattr(dha, group, ())) == tuple(v.name for v in getattr(mld, group))
        for group in ("d", "z")
    )


def simulated_binaries(formulation: Formulation, step: Step | None, x0: Matrix, plan: Plan) -> Matrix:
    """Return the binaries that the model itself gives to the inputs of a plan.

    The inputs are moved into their limits, Boolean ones to 0 or 1, held within blocks, and simulated from `x0`. From
    the first step that the model does not have, or without a simulation, the rounded values of `plan` stand in.

    Parameters
    ----------
    formulation : Formulation
    step : Step or None
    x0 : array of shape (nx,)
    plan : Plan
        Any values; only the inputs count as far as the simulation gets.

    Returns
    -------
    array of 0 and 1, one entry per binary of the formulation
    """
    layout = formulation.layout
    u = _admissible_inputs(formulation, plan.u)
    x, d, z = plan.x.copy(), plan.d.copy(), plan.z.copy()
    x[0] = x0
    for k in range(layout.horizon if step is not None else 0):
        try:
            x[k + 1], _, d[k], z[k] = step(x[k], u[k])  # type: ignore[misc]
        except HysdelError:
            break
    v = layout.join(replace(plan, x=x, u=u, d=d, z=z))
    return np.clip(np.round(v[formulation.binaries]), 0.0, 1.0)


def _admissible_inputs(formulation: Formulation, u: Matrix) -> Matrix:
    layout = formulation.layout
    nu = layout.mld.nu
    starts = [layout.start("u", k) for k in range(layout.horizon)]
    low, high = (np.array([end[i : i + nu] for i in starts]) for end in (formulation.lb, formulation.ub))
    booleans = np.array([v.is_bool for v in layout.mld.u], dtype=bool)
    clipped: Matrix = np.clip(np.where(booleans, np.round(u), u), low, high)
    return clipped[list(formulation.shape.starts)]


def shifted(plan: Plan) -> Plan:
    """Return the plan one step later, with its last stage repeated."""

    def later(values: Matrix) -> Matrix:
        return np.vstack([values[1:], values[-1:]])

    return Plan(later(plan.x), later(plan.u), later(plan.d), later(plan.z), plan.slack)


def shifted_variables(formulation: Formulation, v: Matrix) -> Matrix:
    """Return the decision variables of a plan one step later, with its last stage repeated."""
    layout = formulation.layout
    size = layout.stage_size
    stages = layout.horizon * size
    later = v.copy()
    later[: stages - size] = v[size:stages]
    return later


def shifted_cover(formulation: Formulation, cover: Cover, v: Matrix, before: Indices) -> Cover | None:
    """Return the ends of a tree one step later, None if one end is left, which says nothing.

    Parameters
    ----------
    formulation : Formulation
    cover : Cover
    v : array of shape (n,)
        The plan, whose first stage is taken as decided.
    before : integer array
        See :func:`shifted_sides`.
    """
    from hysdel_py.optimize.kernels.cover import later
    from hysdel_py.optimize.mixed_integer import Cover

    layout = formulation.layout
    size, count = layout.stage_size, len(cover.lengths)
    moved = Cover(*later(cover.arrays(), count, v, size, layout.horizon * size, before[: len(formulation.rows)]))
    return moved if len(moved.lengths) > 1 else None


def shifted_experience(formulation: Formulation, pseudo_costs: Matrix) -> Matrix:
    """Return pseudo-costs one step later, as means of a few observations; the last stage begins without any.

    What was seen long ago must not outweigh what is seen now.
    """
    layout = formulation.layout
    size = layout.stage_size
    stages = layout.horizon * size
    later = np.zeros_like(pseudo_costs)
    later[: stages - size] = pseudo_costs[size:stages]
    for at in (0, 2):
        number = later[:, at + 1]
        kept = np.minimum(number, REMEMBERED)
        later[:, at] *= kept / np.maximum(number, 1.0)
        later[:, at + 1] = kept
    return later


def shifted_sides(formulation: Formulation) -> Indices:
    """Return for each row, then for each variable, the one of the stage before that says the same; -1 for none."""
    m, size = len(formulation.rows), formulation.layout.stage_size
    stages = formulation.layout.horizon * size
    variables = np.arange(formulation.layout.n)
    of_stages = variables < stages
    variables = np.where(of_stages, np.where(variables >= size, variables - size + m, -1), variables + m)
    place: dict[tuple[str, int, str, int], int] = {}
    keys = []
    for index, row in enumerate(formulation.rows):
        number = 0
        while (key := (row.kind, row.stage, row.text, number)) in place:
            number += 1
        place[key] = index
        keys.append(key)
    rows = [place.get((kind, stage - 1, text, number), -1) for kind, stage, text, number in keys]
    return np.concatenate([np.array(rows, dtype=np.int64), variables.astype(np.int64)])


def as_trajectory(mld: Mld, plan: Plan, sample_time: float = 1.0, exact: int | None = None) -> Trajectory:
    """Return a plan as a trajectory, with the outputs of the MLD form and Boolean values exactly 0 or 1.

    With `exact`, Boolean values of later stages are left as they are: they were relaxed.
    """
    stages = len(plan.u) if exact is None else exact
    x = _rounded(plan.x, [v.is_bool for v in mld.x], stages + 1)
    u = _rounded(plan.u, [v.is_bool for v in mld.u], stages)
    d = _rounded(plan.d, [True] * mld.nd, stages)
    y = x[:-1] @ mld.C.T + u @ mld.D1.T + d @ mld.D2.T + plan.z @ mld.D3.T + mld.D5
    groups = {"x": mld.x, "u": mld.u, "y": mld.y, "d": mld.d, "z": mld.z}
    return Trajectory(np.arange(len(x), dtype=np.float64) * float(sample_time), x, u, y, d, plan.z.copy(), groups)


def _rounded(values: Matrix, booleans: list[bool], rows: int) -> Matrix:
    """Boolean columns rounded in the first rows."""
    rounded = values.copy()
    columns = np.flatnonzero(booleans)
    rounded[:rows, columns] = np.round(rounded[:rows, columns])
    return rounded
