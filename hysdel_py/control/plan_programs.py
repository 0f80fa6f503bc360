"""The programs of a controller for states that nobody measures.

They tell whether there is a plan, and what one with given Booleans costs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.construction import make_solver
from hysdel_py.control.formulation import Formulation
from hysdel_py.control.settings import ControlTolerances

if TYPE_CHECKING:
    from hysdel_py.optimize.milp import MilpSolver
    from hysdel_py.optimize.miqp import MiqpSettings, MiqpSolver

__all__ = ["PlanPrograms"]

Vector = NDArray[np.float64]

_GAP, _NODES = 1e-2, 5000  # the word of a plan need not be that of the best one


@dataclass(eq=False, slots=True)
class PlanPrograms:
    """The programs of a controller, one for each state.

    Attributes
    ----------
    formulation : Formulation
    table : mapping of name to array of shape (N + 1,)
        References.
    tolerances : ControlTolerances
    settings : MiqpSettings
    """

    formulation: Formulation
    table: Mapping[str, Vector]
    tolerances: ControlTolerances
    settings: MiqpSettings
    _solver: MiqpSolver | MilpSolver = field(init=False)

    def __post_init__(self) -> None:
        self._solver = make_solver(self.formulation, replace(self.settings, gap_rel=_GAP, node_limit=_NODES))

    def word(self, x: Vector) -> Vector | None:
        """Booleans of a plan; None where it is proven that there is none."""
        plan = self.plan(x)
        return None if plan is None else np.round(plan[self.formulation.binaries])

    def first_input(self, x: Vector) -> Vector | None:
        """First input of a plan; None where it is proven that there is none."""
        plan, begin = self.plan(x), self.formulation.layout.start("u", 0)
        return None if plan is None else plan[begin : begin + self.formulation.layout.mld.nu]

    def plan(self, x: Vector) -> Vector | None:
        """A plan, which need not be the best one; None where it is proven that there is none."""
        from hysdel_py.optimize.miqp import MiqpStatus

        if self.formulation.failed_conditions(x, self.tolerances.measured):
            return None
        result = self._solver.solve(**self.formulation.vectors(x, self.table).as_keywords(), floor=0.0)
        if result.x is not None:
            return np.asarray(result.x)
        if result.status is MiqpStatus.INFEASIBLE:
            return None
        raise TimeoutError(result.message)

    def cost(self, x: Vector, word: Vector) -> float:
        """What the best plan with these Booleans costs, infinite where none is found."""
        vectors = self.formulation.vectors(x, self.table)
        lb, ub = vectors.lb.copy(), vectors.ub.copy()
        lb[self.formulation.binaries] = ub[self.formulation.binaries] = word
        if self.formulation.failed_conditions(x, self.tolerances.measured):
            return np.inf
        result = self._solver.solve(**(vectors.as_keywords() | {"lb": lb, "ub": ub}), floor=0.0)
        if result.x is None or self.formulation.residual(result.x, vectors) > self.tolerances.residual:
            return np.inf
        return float(result.objective)
