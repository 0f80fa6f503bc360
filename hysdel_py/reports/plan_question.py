"""A predictive controller as the question that a certificate answers: its limits, its end, its costs, its programs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.analysis.encoding import OUTWARDS, Interval, ranges_by_definition
from hysdel_py.analysis.hybrid_set import HybridSet, hybrid_set
from hysdel_py.analysis.least_cost import Squares
from hysdel_py.analysis.terminal_step import LastLaw, Limited, cut_by_rows
from hysdel_py.control.bands import Band
from hysdel_py.control.formulation import Formulation
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.errors import ArgumentError
from hysdel_py.model import Model
from hysdel_py.reports.safety import check_model
from hysdel_py.systems.dha import Dha

__all__ = ["PlanQuestion", "checked_controller", "checked_law", "plan_question"]

Vector = NDArray[np.float64]
Table = Mapping[str, Vector]


@dataclass(frozen=True, eq=False, slots=True)
class PlanQuestion:
    """What a certificate needs to know of a controller.

    Attributes
    ----------
    controller : HybridMpc
    model : Model
    table : mapping of name to array of shape (N + 1,)
        References.
    limits : Limited
        Hard limits of states, inputs and outputs.
    ends : HybridSet
        In which plans end, within the limits of states.
    has_end : bool
        Whether there are hard limits of the last state beside those of all states.
    obstacles : tuple of str
        Why a plan without its first step, with one more, need not be a plan.
    law : LastLaw or None
        The input of that step.
    """

    controller: HybridMpc
    model: Model
    table: Table
    limits: Limited
    ends: HybridSet
    has_end: bool
    obstacles: tuple[str, ...]
    law: LastLaw | None = None

    @property
    def formulation(self) -> Formulation:
        """The program of the controller."""
        return self.controller.formulation

    @property
    def stage(self) -> Squares:
        """Cost of a step; states count after the step."""
        return self._squares(1 if self.controller.horizon > 1 else 0, terminal=False)

    @property
    def terminal(self) -> Squares:
        """Cost of the last state."""
        return self._squares(self.controller.horizon, terminal=True)

    def _squares(self, time: int, *, terminal: bool) -> Squares:
        objective = self.formulation.objective
        last = self.controller.horizon
        chosen = [
            i
            for i, signal in enumerate(objective.tracked)
            if signal.time == time and (signal.group == "x" and signal.time == last) == terminal
        ]
        targets = self.formulation.prepared.targets(self.table, len(objective.tracked))
        signals = tuple((objective.tracked[i].group, objective.tracked[i].name) for i in chosen)
        return Squares(signals, objective.Q.toarray()[np.ix_(chosen, chosen)], targets[chosen])

    def hard_bands(self) -> tuple[Band, ...]:
        """Limits of states and outputs that are not softened."""
        resolved = self.formulation.limits
        return tuple(b for b in resolved.bands if b.group in {"x", "y"} and resolved.slack_of(b) is None)

    def left_out(self) -> tuple[str, ...]:
        """Outputs whose limits no plan holds at the next state: no input moves them at once, and there is one step."""
        one = self.controller.horizon == 1
        return tuple(b.name for b in self.formulation.unmovable if one and b in self.hard_bands())

    def softened(self) -> tuple[str, ...]:
        """Names of the limits that a plan may exceed at a price."""
        return self.formulation.limits.slacks


def checked_controller(controller: object, seconds: float) -> Model:
    """The model of a controller.

    Raises
    ------
    ArgumentError
        It is no controller, or one of a form without its source.
    """
    if not isinstance(controller, HybridMpc):
        raise ArgumentError(f"a {type(controller).__name__} was given: a HybridMpc was expected")
    model = controller.model
    if not isinstance(model, Model):
        raise ArgumentError(f"the controller was built from a {type(model).__name__}: one of a Model was expected")
    check_model(model, seconds)
    return model


def checked_law(law: tuple[ArrayLike, ArrayLike], model: Model) -> LastLaw:
    """A law of states as it is given.

    Raises
    ------
    ArgumentError
        Wrong shapes, what is no number, or gains of a Boolean input.
    """
    nu, nx = len(model.dha.u), len(model.dha.x)
    try:
        K, k = (np.array(part, dtype=float) for part in law)
    except (TypeError, ValueError):
        raise ArgumentError(f"last_law is {law!r}: a pair (K, k) of arrays was expected") from None
    if K.shape != (nu, nx) or k.shape != (nu,) or not (np.isfinite(K).all() and np.isfinite(k).all()):
        raise ArgumentError(
            f"last_law: K has shape {K.shape} and k {k.shape}: finite arrays of ({nu}, {nx}) and ({nu},) were expected"
        )
    for v, gains, constant in zip(model.dha.u, K, k, strict=True):
        if v.is_bool and (gains.any() or constant not in {0.0, 1.0}):
            raise ArgumentError(f"last_law: {v.name} is Boolean: no gains, and 0 or 1, were expected")
    if K[:, [v.is_bool for v in model.dha.x]].any():
        raise ArgumentError("last_law: gains of real states only were expected")
    return LastLaw(K, k)


def plan_question(controller: HybridMpc, model: Model, table: Table) -> PlanQuestion:
    """Read a controller of a model."""
    resolved = controller.formulation.limits
    hard = [band for band in resolved.bands if resolved.slack_of(band) is None]
    limits = Limited(*({b.name: (b.low, b.high) for b in hard if b.group == group} for group in ("x", "u", "y")))
    within = hybrid_set(limits.states, model.dha.x, "limits") & hybrid_set({}, model.dha.x, "limits")
    rows = list(_end_rows(controller, hard))
    ends = within
    if rows:
        ends = cut_by_rows(within, np.array([row for row, _ in rows]), np.array([side for _, side in rows]))
    return PlanQuestion(controller, model, table, limits, ends, bool(rows), tuple(_obstacles(controller, model, table)))


def _end_rows(controller: HybridMpc, hard: list[Band]) -> Iterator[tuple[Vector, float]]:
    """Rows ``a x_N <= b`` of the hard limits of the last state."""
    mld, resolved = controller.mld, controller.formulation.limits
    for band in hard:
        if band.group not in {"terminal", "final"}:
            continue
        row = np.eye(mld.nx)[band.column] if band.group == "terminal" else mld.C[band.column]
        offset = 0.0 if band.group == "terminal" else float(mld.D5[band.column])
        low, high = band.at(controller.horizon)
        yield from ((s * row, s * (end - offset)) for s, end in ((1.0, high), (-1.0, low)) if np.isfinite(end))
    if resolved.polytope is not None and resolved.polytope_slack is None:
        yield from ((a, float(b)) for a, b in zip(resolved.polytope.S, resolved.polytope.T, strict=True))


def _obstacles(controller: HybridMpc, model: Model, table: Table) -> Iterator[str]:
    f = controller.formulation
    if any(len(band.lows) > 1 or len(band.highs) > 1 for band in f.limits.bands):
        yield "limits change over the horizon"
    if f.shape.starts != tuple(range(controller.horizon)):
        yield "inputs are held in blocks"
    if not f.shape.is_exact:
        yield "switches of later steps are relaxed"
    if f.uses_last_input:
        yield "increments of inputs are weighed or limited"
    if any(np.ptp(values) > 0 for values in table.values()):
        yield "references change over the horizon"
    narrow = _narrow_auxiliaries(model.dha)
    if narrow:
        yield f"the declared ranges of {', '.join(narrow)} restrict the model"


def _narrow_auxiliaries(dha: Dha) -> tuple[str, ...]:
    """Auxiliaries whose declared range is narrower than what their definition gives."""
    follows = ranges_by_definition(dha)
    return tuple(v.name for v in dha.z if not v.generated and _is_narrower((v.low, v.high), follows[v.name]))


def _is_narrower(declared: Interval, follows: Interval) -> bool:
    room = OUTWARDS * max(1.0, *(abs(end) for end in follows))
    return declared[0] > follows[0] + room or declared[1] < follows[1] - room
