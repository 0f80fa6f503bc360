"""Model predictive control of mixed logical dynamical systems by mixed-integer quadratic programming.

After Bemporad and Morari, "Control of systems integrating logic, dynamics, and constraints", Automatica 35, 1999; cost
and limits as in the HYBCON controllers of the Hybrid Toolbox.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from operator import index
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control import outcome
from hysdel_py.control.costs import Cost
from hysdel_py.control.formulation import Formulation, Vectors, formulate
from hysdel_py.control.layout import Plan
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.control.prediction import choose_step, shifted, simulated_binaries
from hysdel_py.control.references import Reference, choose_references
from hysdel_py.control.settings import DEFAULT_CONTROL_TOLERANCES, ControlTolerances
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import as_vector

if TYPE_CHECKING:
    from hysdel_py.optimize.miqp import Miqp, MiqpResult, MiqpSettings, MiqpSolver

__all__ = ["HybridMpc", "Move", "MoveStatus"]

Matrix = NDArray[np.float64]
T = TypeVar("T")

MAX_VARIABLES = 20_000
"""Largest program that is assembled; the search would not finish long before this size."""


class HybridMpc:
    """Hybrid model predictive controller.

    The program is assembled once; :meth:`solve` only moves it to the measured state and the references. The controller
    remembers its last plan as the start of the next search, which changes the time of an answer and, among plans of
    equal cost, the plan; never its cost beyond the gap.

    Parameters
    ----------
    model : Model or Mld
        A compiled model, or its MLD form.
    horizon : int
        Number N >= 1 of steps that are planned.
    cost : Cost
    limits : Limits, optional
        None beside the declared ranges by default.
    references : sequence of str, optional
        Signals that must be given a reference in every call, in the order of references given as vectors. By default
        every signal with a weight may have one and follows 0 otherwise.
    backend : str
        Solver of the quadratic programs, ``"piqp"`` or ``"osqp"``.
    time_limit : float, optional
        Seconds per answer.
    node_limit : int, optional
        Nodes of the branch and bound per answer.
    gap_rel, gap_abs : float
        A plan is optimal when its cost exceeds the bound by no more than the larger of `gap_abs` and `gap_rel` times
        the cost.
    progress : callable, optional
        Passed on to the branch and bound.
    tolerances : ControlTolerances, optional

    Attributes
    ----------
    model : Model or Mld
        What it was built from.
    mld : Mld
    horizon : int
    formulation : Formulation
        The program, with the meaning of each variable and row.

    Raises
    ------
    ArgumentError
        If an argument does not fit the model; the message says which and what was expected.
    """

    def __init__(
        self,
        model: Any,
        horizon: int,
        cost: Cost,
        limits: Limits | None = None,
        references: Sequence[str] | None = None,
        *,
        backend: str = "piqp",
        time_limit: float | None = None,
        node_limit: int | None = None,
        gap_rel: float = 1e-4,
        gap_abs: float = 1e-5,
        progress: Callable[..., Any] | None = None,
        tolerances: ControlTolerances = DEFAULT_CONTROL_TOLERANCES,
    ) -> None:
        self.model = model
        self.mld = _mld_of(model)
        self.horizon = _checked_horizon(horizon, self.mld)
        if progress is not None and not callable(progress):
            raise ArgumentError(f"progress is a {type(progress).__name__}: a callable was expected")
        _checked(tolerances, ControlTolerances, "tolerances")
        weights = _checked(cost, Cost, "cost").resolve(self.mld, tolerances)
        bands = _checked(Limits() if limits is None else limits, Limits, "limits").resolve(self.mld)
        self.references = choose_references(references, weights.names, self.horizon)
        self.formulation: Formulation = formulate(self.mld, self.horizon, weights, bands)
        self.tolerances = tolerances
        self.sample_time: float = getattr(model, "sample_time", 1.0)
        self._progress = progress
        self._step = choose_step(model, self.mld)
        limits_of_search = {"time_limit": time_limit, "node_limit": node_limit}
        settings = _settings(backend, limits_of_search, gap_rel, gap_abs, tolerances.feasibility)
        self._solver = _solver(self.formulation, settings)
        self._plan: Plan | None = None

    def reset(self) -> None:
        """Forget the last plan."""
        self._plan = None

    def solve(self, x: ArrayLike | Mapping[str, float], ref: Reference = None, *, warm: bool = True) -> Move:
        """Plan from a measured state and return the first input.

        Parameters
        ----------
        x : array_like of shape (nx,), or mapping of name to number
            Measured state.
        ref : mapping of name to number or array, or array_like, optional
            References: a number holds over the horizon, an array of length N or N+1 has one value for each time
            0, 1, ...; a vector has one number per name in `references`.
        warm : bool
            Start from the last plan, shifted by one step.

        Returns
        -------
        Move
            ``move.u`` is None when there is no input; ``move.status`` and ``move.message`` say why. Trouble in the
            solver never raises.

        Raises
        ------
        ArgumentError
            Wrong dimension, unknown name, NaN, infinite values or missing references.
        """
        begin = time.perf_counter()
        measured = as_vector(x, self.mld.x, "state")
        table = self.references.table(ref)
        x0, reasons = outcome.admissible_state(self.formulation, measured, self.tolerances)
        if reasons:
            return outcome.refused(reasons, time.perf_counter() - begin)
        vectors = self.formulation.vectors(x0, table)
        result = self._search(vectors, x0, warm)
        move, plan = outcome.judged(
            self.formulation, vectors, x0, result, self.tolerances, sample_time=self.sample_time
        )
        self._plan = plan
        message = move.message if plan is None else move.message + self._remark_on_thresholds(plan, x0)
        return replace(move, message=message, seconds=time.perf_counter() - begin)

    def _remark_on_thresholds(self, plan: Plan, x0: Matrix) -> str:
        """Say where the plan counts on a threshold that the model, without epsilon and rounding, sees differently."""
        f = self.formulation
        planned = np.round(f.layout.join(plan)[f.binaries])
        differing = np.flatnonzero(planned != simulated_binaries(f, self._step, x0, plan))
        if not differing.size:
            return ""
        first = f.describe_variable(int(f.binaries[differing[0]]))
        return (
            f"; the plan stands on a threshold, which the simulated model may see from the other side first at {first}"
        )

    def problem(self, x: ArrayLike | Mapping[str, float], ref: Reference = None) -> Miqp:
        """Return the mixed-integer program of one call, to study it or to hand it to another solver.

        Parameters and errors are those of :meth:`solve`. The cost includes the constant, so that its value is that of
        ``Move.cost``; the state is not moved onto its range.
        """
        from hysdel_py.optimize.miqp import Miqp

        vectors = self.formulation.vectors(as_vector(x, self.mld.x, "state"), self.references.table(ref))
        program = self._solver.miqp
        qp = program.qp.with_vectors(vectors.q, l=vectors.l, u=vectors.u, constant=vectors.constant)
        return Miqp(qp, program.binaries, priorities=program.priorities, drivers=program.drivers)

    def _search(self, vectors: Vectors, x0: Matrix, warm: bool) -> MiqpResult:
        return self._solver.solve(
            q=vectors.q,
            l=vectors.l,
            u=vectors.u,
            constant=vectors.constant,
            floor=0.0,  # the cost is a sum of squares
            incumbent=self._guess(x0) if warm else None,
            heuristic=self._heuristic(x0),
            progress=self._progress,
        )

    def _guess(self, x0: Matrix) -> Matrix | None:
        """Binaries of the last plan, one step later and as the model moves from the measured state."""
        if self._plan is None:
            return None
        return simulated_binaries(self.formulation, self._step, x0, shifted(self._plan))

    def _heuristic(self, x0: Matrix) -> Callable[[Matrix, Matrix, Matrix], Matrix]:
        def simulate_relaxation(v: Matrix, _lb: Matrix, _ub: Matrix) -> Matrix:
            relaxed = self.formulation.layout.split(v, x0)
            return simulated_binaries(self.formulation, self._step, x0, relaxed)

        return simulate_relaxation


def _mld_of(model: Any) -> Mld:
    mld = getattr(model, "mld", model)
    if not isinstance(mld, Mld):
        raise ArgumentError(f"model is a {type(model).__name__}: a Model or an Mld was expected")
    return mld


def _checked_horizon(horizon: int, mld: Mld) -> int:
    try:
        steps = 0 if isinstance(horizon, bool) else index(horizon)
    except TypeError:
        steps = 0
    if steps < 1:
        raise ArgumentError(f"horizon is {horizon!r}: a whole number of at least 1 was expected")
    size = steps * (mld.nx + mld.nu + mld.nd + mld.nz)
    if size > MAX_VARIABLES:
        raise ArgumentError(
            f"horizon is {steps}: the program would have {size} variables, at most {MAX_VARIABLES} are accepted"
        )
    return steps


def _checked(value: Any, kind: type[T], what: str) -> T:
    if not isinstance(value, kind):
        raise ArgumentError(f"{what} is a {type(value).__name__}: a {kind.__name__} was expected")
    return value


def _settings(
    backend: str, limits: Mapping[str, float | None], gap_rel: float, gap_abs: float, feasibility: float
) -> MiqpSettings:
    from hysdel_py.optimize.miqp import MiqpSettings

    given: dict[str, Any] = {name: value for name, value in limits.items() if value is not None}
    return MiqpSettings(backend=backend, gap_rel=gap_rel, gap_abs=gap_abs, feasibility=feasibility, **given)


def _solver(formulation: Formulation, settings: MiqpSettings) -> MiqpSolver:
    from hysdel_py.optimize.miqp import Miqp, MiqpSolver
    from hysdel_py.optimize.qp import Qp

    f = formulation
    rows = f.low - f.shift.c, f.high - f.shift.c
    qp = Qp(P=f.objective.P, q=np.zeros(f.layout.n), A=f.A, l=rows[0], u=rows[1], lb=f.lb, ub=f.ub)
    return MiqpSolver(Miqp(qp, f.binaries, priorities=f.stages, drivers=f.drivers), settings)
