"""Why a plan is as it is: active limits, binaries that had no choice, and what the requirements cost.

The binaries are held as planned. What remains is a convex program, whose multipliers say by how much the cost would
fall per unit by which a row is loosened; where several sets of multipliers solve it, this is one of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.formulation import Formulation
from hysdel_py.control.move import Move
from hysdel_py.control.rows import Row
from hysdel_py.errors import ArgumentError

if TYPE_CHECKING:
    from hysdel_py.optimize.miqp import Miqp
    from hysdel_py.optimize.qp import Qp

__all__ = ["Forced", "PlanExplanation", "Price", "explain"]

Matrix = NDArray[np.float64]
TOUCHES = 1e-6
"""A row or bound is active when it is this close to its end, relative to the size of the end and at least absolute."""
COUNTS = 1e-6
"""A multiplier below this part of the largest one is left out."""


@dataclass(frozen=True, slots=True)
class Price:
    """A row or bound that the plan touches.

    Attributes
    ----------
    text : str
        What it demands, with its time and the line of the source.
    side : str
        ``"low"`` or ``"high"``.
    price : float
        By how much the cost would fall per unit by which it is loosened, the binaries held; 0 where it touches
        without pressing.
    stage : int
    """

    text: str
    side: str
    price: float
    stage: int


@dataclass(frozen=True, slots=True)
class Forced:
    """A binary that the measured state and the rows fix before anything is searched."""

    text: str
    value: int


@dataclass(frozen=True, slots=True)
class PlanExplanation:
    """What holds a plan.

    Attributes
    ----------
    limits : tuple of Price
        Active limits of the controller and active ranges of inputs and states.
    requirements : tuple of Price
        Active MUST items.
    forced : tuple of Forced
        Binaries fixed by propagation.
    searched : tuple of Forced
        The other binaries, with their planned values.
    """

    limits: tuple[Price, ...]
    requirements: tuple[Price, ...]
    forced: tuple[Forced, ...]
    searched: tuple[Forced, ...]

    def describe(self) -> str:
        """Text of one line per fact."""
        lines = ["active limits and ranges"]
        lines += [f"  {_priced(entry)}" for entry in self.limits]
        lines += ["active requirements", *(f"  {_priced(entry)}" for entry in self.requirements)]
        lines += ["binaries without a choice", *(f"  {entry.text} = {entry.value}" for entry in self.forced)]
        lines += ["binaries that were searched", *(f"  {entry.text} = {entry.value}" for entry in self.searched)]
        return "\n".join(lines)


def explain(formulation: Formulation, miqp: Miqp, move: Move) -> PlanExplanation:
    """Explain the plan of a move.

    Raises
    ------
    ArgumentError
        If the move has no plan, or one of another controller.
    """
    if move.case is None or move.case.v is None:
        raise ArgumentError(f"the move has no plan to explain: {move.message}")
    v, vectors = move.case.v, move.case.vectors
    if len(v) != formulation.layout.n or len(vectors.l) != len(formulation.rows):
        raise ArgumentError("the move is of another controller: one of this controller was expected")
    formulation = formulation if move.case.formulation is None else move.case.formulation
    qp = miqp.qp.with_vectors(**vectors.as_keywords())
    y, z = _multipliers(qp, miqp, v)
    priced = list(_active_rows(formulation, qp, v, y))
    forced = _forced(miqp, qp)
    return PlanExplanation(
        limits=(
            *(price for row, price in priced if row.kind == "limit"),
            *_active_bounds(formulation, qp, v, z),
        ),
        requirements=tuple(price for row, price in priced if _is_requirement(row)),
        forced=_binaries(formulation, v, forced),
        searched=_binaries(formulation, v, ~forced),
    )


def _multipliers(qp: Qp, miqp: Miqp, v: Matrix) -> tuple[Matrix, Matrix]:
    """Multipliers of rows and bounds with the binaries held."""
    from hysdel_py.optimize.verified import solve_qp

    lb, ub = qp.lb.copy(), qp.ub.copy()
    lb[miqp.binaries] = ub[miqp.binaries] = v[miqp.binaries]
    answer = solve_qp(qp.with_vectors(lb=lb, ub=ub))
    return answer.y, answer.z


def _active_rows(formulation: Formulation, qp: Qp, v: Matrix, y: Matrix) -> Iterator[tuple[Row, Price]]:
    value = qp.A @ v
    for i, row in enumerate(formulation.rows):
        if row.kind == "limit" or _is_requirement(row):
            side = _side(value[i], qp.l[i], qp.u[i])
            if side:
                yield row, Price(str(row), side, _size(y, i), row.stage)


def _active_bounds(formulation: Formulation, qp: Qp, v: Matrix, z: Matrix) -> Iterator[Price]:
    """Inputs and states at an end of their range or limit that presses."""
    layout = formulation.layout
    for i in range(layout.slack(0)):
        k, column = divmod(i, layout.stage_size)
        variable = layout.stage_variables[column]
        side = _side(v[i], qp.lb[i], qp.ub[i])
        if side and variable.kind.value in "ux" and not variable.is_bool and _size(z, i) > 0:
            end = qp.ub[i] if side == "high" else qp.lb[i]
            yield Price(f"{layout.describe(i)} at {end:g}", side, _size(z, i), k)


def _size(multipliers: Matrix, i: int) -> float:
    size = float(abs(multipliers[i]))
    return size if size > COUNTS * max(1.0, float(np.abs(multipliers).max())) else 0.0


def _side(value: float, low: float, high: float) -> str:
    for end, name in ((high, "high"), (low, "low")):
        if np.isfinite(end) and abs(value - end) <= TOUCHES * max(1.0, abs(end)):
            return name
    return ""


def _is_requirement(row: Row) -> bool:
    return row.origin is not None and row.origin.section == "MUST"


def _forced(miqp: Miqp, qp: Qp) -> NDArray[np.bool_]:
    from hysdel_py.optimize.propagation import PropagationSettings, Propagator

    box = Propagator(qp.A, miqp.binaries, PropagationSettings()).propagate(qp.lb, qp.ub, qp.l, qp.u, None)
    fixed: NDArray[np.bool_] = box.lb[miqp.binaries] == box.ub[miqp.binaries]
    return fixed


def _binaries(formulation: Formulation, v: Matrix, mask: NDArray[np.bool_]) -> tuple[Forced, ...]:
    return tuple(Forced(formulation.describe_variable(int(i)), round(v[i])) for i in formulation.binaries[mask])


def _priced(entry: Price) -> str:
    return f"{entry.text}, {entry.side} side" + (f", price {entry.price:.6g}" if entry.price else "")
