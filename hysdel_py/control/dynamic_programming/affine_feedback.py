"""The answer of analytical dynamic programming: an affine feedback for every stage."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.dynamic_programming.plan import checked_vector
from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Kind, Type, Variable
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from hysdel_py.control.dynamic_programming.analytical import AnalyticalDp

__all__ = ["AffineFeedback", "FeedbackController", "ReachableSet"]

Matrix = NDArray[np.float64]

ON_SET = 1e-7
"""How far a state may be from the set of states that can meet the terminal equality, relative to the terms of a row."""


@dataclass(frozen=True, eq=False, slots=True)
class ReachableSet:
    """States ``C x + c = 0`` from which the terminal equality can be met; no rows where all can."""

    C: Matrix
    c: Matrix

    def reduced(self) -> ReachableSet:
        """The same set without zero rows; rows of length one."""
        lengths = np.linalg.norm(self.C, axis=1)
        kept = (lengths > 1e-10) | (np.abs(self.c) > 1e-9)
        scale = np.where(lengths > 1e-10, lengths, 1.0)[kept]
        C = np.where(lengths[:, None] > 1e-10, self.C, 0.0)[kept]
        return ReachableSet(C / scale[:, None], self.c[kept] / scale)

    def distance(self, x: Matrix) -> float:
        """Largest violation, relative to the terms of its row."""
        if not len(self.c):
            return 0.0
        size = np.maximum(1.0, np.abs(self.C) @ np.abs(x) + np.abs(self.c))
        return float((np.abs(self.C @ x + self.c) / size).max())


@dataclass(frozen=True, eq=False)
class AffineFeedback:
    """``u_k = K_k x_k + k_k``: K_k is the feedback, k_k the feedforward.

    Attributes
    ----------
    K, k : arrays of shapes (N, nu, nx), (N, nu)
    values : tuple of (P, p, number), N+1 of them
        Cost to go ``1/2 x'P x + p'x + number`` of each stage.
    reachable : tuple of ReachableSet, N+1 of them
    problem : AnalyticalDp
    """

    K: Matrix
    k: Matrix
    values: tuple[tuple[Matrix, Matrix, float], ...]
    reachable: tuple[ReachableSet, ...]
    problem: AnalyticalDp

    @property
    def stages(self) -> int:
        """Number of steps."""
        return len(self.K)

    def __call__(self, x: ArrayLike, stage: int = 0) -> Matrix:
        """Input at a state."""
        if not 0 <= stage < self.stages:
            raise ArgumentError(f"stage is {stage}: one from 0 to {self.stages - 1} was expected")
        return np.asarray(self.K[stage] @ self._state(x) + self.k[stage])

    def value(self, x: ArrayLike, stage: int = 0) -> float:
        """Cost to go, infinite where the terminal equality cannot be met any more."""
        state = self._state(x)
        P, p, number = self.values[stage]
        met = self.reachable[stage].distance(state) <= ON_SET
        return float(0.5 * state @ P @ state + p @ state + number) if met else float("inf")

    def simulate(self, x0: ArrayLike, disturbance: ArrayLike | None = None) -> Trajectory:
        """The run of the system under the feedback.

        Parameters
        ----------
        x0 : array_like of shape (nx,)
        disturbance : array_like of shape (N, nx), optional
            Added to each next state.

        Raises
        ------
        ArgumentError
            The terminal equality cannot be met from this state.
        """
        x = [self._state(x0)]
        if not self.reachable[0].distance(x[0]) <= ON_SET:
            raise ArgumentError(
                f"from x0 the terminal equality cannot be met in {self.stages} steps: the inputs do not reach it; "
                "allow more stages"
            )
        noise = np.zeros((self.stages, len(x[0]))) if disturbance is None else np.asarray(disturbance, dtype=float)
        u, system = [], self.problem
        for k in range(self.stages):
            u.append(self(x[-1], k))
            x.append(np.asarray(system.A) @ x[-1] + np.asarray(system.B) @ u[-1] + np.asarray(system.d) + noise[k])
        nothing = np.zeros((self.stages, 0))
        variables = {"x": self._variables("x"), "u": self._variables("u"), "y": (), "d": (), "z": ()}
        return Trajectory(
            np.arange(self.stages + 1.0), np.array(x), np.array(u), nothing, nothing, nothing, variables=variables
        )  # fmt: skip

    def controller(self) -> FeedbackController:
        """A controller for :func:`closed_loop`, which counts the stages."""
        return FeedbackController(self)

    def _variables(self, key: str) -> tuple[Variable, ...]:
        size = self.K.shape[2] if key == "x" else self.K.shape[1]
        names = (self.problem.names or {}).get(key) or tuple(f"{key}{i + 1}" for i in range(size))
        return tuple(Variable(name, Type.REAL, Kind(key)) for name in names)

    def _state(self, x: ArrayLike) -> Matrix:
        state = checked_vector(x, self._variables("x"), "state")
        assert state is not None
        return state


class FeedbackController:
    """Applies one stage of a feedback after the other; :meth:`reset` starts again."""

    def __init__(self, feedback: AffineFeedback) -> None:
        self.feedback, self.stage = feedback, 0

    def reset(self) -> None:
        """Start again at the first stage."""
        self.stage = 0

    def solve(self, x: ArrayLike, ref: object = None) -> Move:  # noqa: ARG002 - the protocol of controllers
        """The next move; ``ref`` is not used, since references are part of the cost."""
        if self.stage >= self.feedback.stages:
            return Move(MoveStatus.INFEASIBLE, f"the feedback ends after {self.feedback.stages} stages")
        begin = perf_counter()
        u = self.feedback(x, self.stage)
        cost = self.feedback.value(x, self.stage)
        self.stage += 1
        return Move(MoveStatus.OPTIMAL, "optimal, in closed form", u=u, cost=cost, seconds=perf_counter() - begin)
