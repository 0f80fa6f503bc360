"""A feedback table in a closed loop."""

from __future__ import annotations

from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.dynamic_programming.plan import checked_vector
from hysdel_py.control.dynamic_programming.table import FeedbackTable, TableLaw
from hysdel_py.control.move import Move, MoveStatus

__all__ = ["TableController"]

Matrix = NDArray[np.float64]


class TableController:
    """Asks a table for one input after the other.

    The controller counts the stages; :meth:`reset` starts again. With ``receding`` it stays at the first stage, so that
    the horizon moves along as in predictive control.

    Attributes
    ----------
    table : FeedbackTable
    law : str or None
        As for :meth:`FeedbackTable.__call__`.
    stage : int
        Stage of the next move.
    """

    def __init__(self, table: FeedbackTable, law: TableLaw | None = None, *, receding: bool = False) -> None:
        self.table, self.law, self.receding, self.stage = table, law, receding, table.first
        self.sample_time = table.sample_time
        self.uses_last_input = table.schedule[0].before is not None

    def reset(self) -> None:
        """Start again at the first stage."""
        self.stage = self.table.first

    def solve(self, x: ArrayLike, ref: object = None, last_input: ArrayLike | None = None) -> Move:  # noqa: ARG002
        """The next move.

        Parameters
        ----------
        x : array_like of shape (nx,)
        ref : None
            A table knows no references: they are part of its costs.
        last_input : array_like of shape (nu,), optional

        Returns
        -------
        Move
            OPTIMAL on the grid, with the cost to go as its cost; INFEASIBLE where the table has no input, and after its
            last stage.
        """
        begin = perf_counter()
        if self.stage >= self.table.stages:
            return Move(MoveStatus.INFEASIBLE, f"the table ends after {self.table.stages} stages")
        u, cost = self._asked(x, last_input)
        seconds = perf_counter() - begin
        if u is None:
            return Move(MoveStatus.INFEASIBLE, f"the table has no input at stage {self.stage} here", seconds=seconds)
        if not self.receding:
            self.stage += 1
        return Move(MoveStatus.OPTIMAL, "optimal on the grid of the table", u=u, cost=cost, seconds=seconds)

    def _asked(self, x: ArrayLike, last_input: ArrayLike | None) -> tuple[Matrix | None, float]:
        table = self.table
        if table.functions is not None and self.law in (None, "lookahead"):
            state = checked_vector(x, table.variables["x"], "state")
            assert state is not None
            return table.ahead(self.stage, state, checked_vector(last_input, table.variables["u"], "last input"))
        return table(x, self.stage, last_input, self.law), np.nan
