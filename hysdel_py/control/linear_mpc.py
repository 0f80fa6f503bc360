"""Model predictive control of sampled linear systems by quadratic programming.

After A. Bemporad, M. Morari, V. Dua and E. Pistikopoulos, "The explicit linear quadratic regulator for constrained
systems", Automatica 38, 2002; horizons, limits and defaults as in the LINCON controllers of the Hybrid Toolbox.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control import fallback as fallbacks
from hysdel_py.control.construction import checked
from hysdel_py.control.fallback import Fallback, Reserve, check_fallback
from hysdel_py.control.linear_columns import Columns
from hysdel_py.control.linear_construction import models_of, softened, terminal_set, with_cached_gain
from hysdel_py.control.linear_cost import LinearCost
from hysdel_py.control.linear_horizons import choose_horizons
from hysdel_py.control.linear_limits import LinearLimits, ResolvedLinearLimits
from hysdel_py.control.linear_planner import LinearPlan, LinearPlanner
from hysdel_py.control.linear_prediction import predict
from hysdel_py.control.linear_program import LinearProgram, assemble
from hysdel_py.control.linear_rows import limit_rows, plan_slacks
from hysdel_py.control.move import Move
from hysdel_py.control.references import Reference, choose_references
from hysdel_py.control.settings import DEFAULT_CONTROL_TOLERANCES, ControlTolerances
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.lti import Lti
from hysdel_py.systems.signals import as_vector

__all__ = ["LinearMpc"]

Vector = NDArray[np.float64]
LastInput = ArrayLike | Mapping[str, float] | None

KINDS = ("regulator", "track")
BACKENDS = ("auto", "dense", "piqp", "osqp")


class LinearMpc:
    """Linear model predictive controller.

    The program is assembled once; :meth:`solve` only moves it to the measured state, the references and the input
    applied last.

    Parameters
    ----------
    model : Lti, sequence of Lti, or whatever :meth:`Lti.of` takes
        The model; with a sequence, one for each stage of the plan.
    kind : "regulator" or "track"
        Steer the state to the origin, or outputs to references by increments of the inputs.
    horizon : int
        N: stages that the cost counts.
    cost : LinearCost, optional
    limits : LinearLimits, optional
        None beside the ranges that the model declares for its inputs by default.
    references : sequence of str, optional
        Tracking: outputs that must be given a reference in every call, in the order of references given as vectors.
        By default every output with a weight may have one and follows 0 otherwise.
    control_horizon : int, optional
        Nu: inputs that are free; after them u = K x, or the input is held. All by default.
    output_constraint_horizon : int, optional
        Ncy: last time at which limits of outputs and states count, N - 1 by default.
    input_constraint_horizon : int, optional
        Ncu: last time at which limits of inputs and increments count, Nu - 1 by default. With the terminal set
        ``"invariant"`` N - 1, and N where increments are limited.
    constrain_first_output : bool
        Whether limits of outputs and states count at time 0 too. The measured state, which no input changes, decides
        those that hold no input of the same time.
    backend : str
        Solver of the quadratic programs: ``"dense"`` (compiled kernels of our own), ``"piqp"`` or ``"osqp"``;
        ``"auto"`` takes the kernels where numba is installed and PIQP elsewhere.
    fallback : "soft", "last_plan", callable or None
        What gives the input when there is no plan: the same controller with its limits of outputs and states and its
        terminal set softened, the next input of the last plan, or ``fallback(x, move) -> u``.
    tolerances : ControlTolerances, optional

    Attributes
    ----------
    lti : Lti
        The model (of the first stage).
    models : tuple of Lti
        One per stage.
    kind : str
    horizons : Horizons
    weights : LinearWeights
        The weights as matrices, with P and, where it is asked for, K.
    limits : ResolvedLinearLimits
    terminal_set : Polytope or None
        The set in which the plan ends.
    program : LinearProgram
        The quadratic program as a function of state, last input and references.
    references : References

    Raises
    ------
    ArgumentError
        If an argument does not fit the model; the message says which and what was expected.

    Examples
    --------
    >>> from hysdel_py.control.linear_limits import LinearLimits
    >>> plant = Lti([[1, 1], [0, 1]], [[1], [0.5]])
    >>> mpc = LinearMpc(plant, "regulator", 5, limits=LinearLimits(u=(-1, 1)))
    >>> float(round(mpc.solve([-4, 0]).u[0], 6))
    1.0
    """

    def __init__(
        self,
        model: Any,
        kind: Literal["regulator", "track"],
        horizon: int = 2,
        cost: LinearCost | None = None,
        limits: LinearLimits | None = None,
        *,
        references: Sequence[str] | None = None,
        control_horizon: int | None = None,
        output_constraint_horizon: int | None = None,
        input_constraint_horizon: int | None = None,
        constrain_first_output: bool = False,
        backend: str = "auto",
        fallback: Fallback = None,
        tolerances: ControlTolerances = DEFAULT_CONTROL_TOLERANCES,
    ) -> None:
        if kind not in KINDS:
            raise ArgumentError(f"kind is {kind!r}: 'regulator' or 'track' was expected")
        if backend not in BACKENDS:
            raise ArgumentError(f"backend is {backend!r}: one of {', '.join(map(repr, BACKENDS))} was expected")
        self.kind: str = kind
        self.horizons = choose_horizons(
            horizon,
            control_horizon,
            output_constraint_horizon,
            input_constraint_horizon,
            constrain_now=constrain_first_output,
        )
        self.models = models_of(model, self.horizons.steps)
        self.tolerances = checked(tolerances, ControlTolerances, "tolerances")
        chosen = checked(LinearLimits() if limits is None else limits, LinearLimits, "limits")
        weights = checked(LinearCost() if cost is None else cost, LinearCost, "cost")
        self.weights = with_cached_gain(weights.resolve(self.models, self.tracks, tolerances))
        self.limits = chosen.resolve(self.lti, self.horizons.steps)
        if self.limits.invariant and input_constraint_horizon is None:
            self.horizons = self.horizons.until_the_end(increments=self.limits.limits_increments)
        names = [self.lti.y[i].name for i in self.weights.tracked]
        self.references = choose_references(references, names, self.horizons.steps)
        self.terminal_set = terminal_set(self.models[-1], self.weights, self.limits, self.horizons, self.tracks)
        self._backend = backend
        self._fallback = check_fallback(fallback, chosen)
        self._planner = self._planner_of(self.limits)
        self._softened = self._planner_of(softened(self.limits), soften_terminal=True) if fallback == "soft" else None
        self._reserve: Reserve | None = None

    @property
    def lti(self) -> Lti:
        """The model of the first stage."""
        return self.models[0]

    @property
    def tracks(self) -> bool:
        """Whether outputs follow references."""
        return self.kind == "track"

    @property
    def sample_time(self) -> float:
        """Sample time of the model."""
        return self.lti.ts

    @property
    def uses_last_input(self) -> bool:
        """Whether :meth:`solve` needs the input applied last: in tracking, or where increments are limited."""
        return self.tracks or self.limits.limits_increments

    @property
    def program(self) -> LinearProgram:
        """The quadratic program as a function of state, last input and references."""
        return self._planner.built.program

    def reset(self) -> None:
        """Forget the last plan."""
        self._reserve = None

    def solve(self, x: ArrayLike | Mapping[str, float], ref: Reference = None, last_input: LastInput = None) -> Move:
        """Plan from a measured state and return the first input.

        Parameters
        ----------
        x : array_like of shape (nx,), or mapping of name to number
            Measured state.
        ref : mapping of name to number or array, or array_like, optional
            References of a tracking controller: a number holds over the horizon, an array of length N or N+1 has one
            value for each time 0, 1, ...; a vector has one number per name in `references`.
        last_input : array_like of shape (nu,), or mapping of name to number
            The input applied in the step before; see :attr:`uses_last_input`.

        Returns
        -------
        Move
            ``move.u`` is None when there is no input; ``move.status`` and ``move.message`` say why. Trouble in the
            solver never raises.

        Raises
        ------
        ArgumentError
            Wrong dimension, unknown name, NaN, infinite values, missing references or a missing last input.
        """
        begin = time.perf_counter()
        theta = self.parameters(x, ref, last_input)
        move = self._planner.plan(theta)
        if move.ok:
            self._reserve = None if move.predicted is None else Reserve(move.predicted.u)
        elif self._fallback is not None:
            move = self._fall_back(move, theta)
        return replace(move, seconds=time.perf_counter() - begin)

    def parameters(
        self, x: ArrayLike | Mapping[str, float], ref: Reference = None, last_input: LastInput = None
    ) -> Vector:
        """The vector theta of a call: state, last input where it is used, references stage by stage."""
        parts = [as_vector(x, self.lti.x, "state")]
        if self.uses_last_input:
            if last_input is None:
                names = ", ".join(v.name for v in self.lti.u)
                raise ArgumentError(
                    f"last_input is missing: increments are planned or limited, so the input applied last ({names}) "
                    "counts"
                )
            parts.append(as_vector(last_input, self.lti.u, "last input"))
        table = self.references.table(ref)
        names_of_tracked = [self.lti.y[i].name for i in self.weights.tracked]
        columns = [table.get(name, np.zeros(self.horizons.steps + 1)) for name in names_of_tracked]
        return np.concatenate([*parts, *(np.array([c[k] for c in columns]) for k in range(self._stages))])

    @property
    def _stages(self) -> int:
        return self.horizons.steps if self.tracks else 0

    def _fall_back(self, failed: Move, theta: Vector) -> Move:
        if self._softened is not None:
            softened = fallbacks.from_softened(failed, self._softened.plan(theta))
            self._reserve = None if softened.predicted is None else Reserve(softened.predicted.u)
            return softened
        if callable(self._fallback):
            return fallbacks.from_callable(failed, self._fallback, theta[: self.lti.nx], self.lti.u)
        move = fallbacks.from_reserve(failed, self._reserve, lambda u: self._planner.broken_input_limits(theta, u))
        self._reserve = None if self._reserve is None else replace(self._reserve, used=self._reserve.used + 1)
        return move

    def _planner_of(self, limits: ResolvedLinearLimits, *, soften_terminal: bool = False) -> LinearPlanner:
        h = self.horizons
        soften_terminal = soften_terminal and self.terminal_set is not None
        slacks = plan_slacks(limits, h, soften_terminal=soften_terminal)
        tracked = len(self.weights.tracked)
        columns = Columns(
            self.lti.nx, self.lti.nu, h.moves, len(slacks.labels), self.uses_last_input, tracked, self._stages
        )
        prediction = predict(self.models, columns, self._inputs, self.tracks, self.weights.gain)
        rows = limit_rows(limits, prediction, h, slacks, self.terminal_set)
        program = assemble(prediction, self.weights, limits, rows, self.tracks)
        return LinearPlanner(LinearPlan(program, self.models, prediction, slacks), self._backend, self.tolerances)

    @property
    def _inputs(self) -> int:
        """Number of times whose inputs matter; that of time N only to limits that reach so far."""
        h = self.horizons
        final = bool(self.limits.of("u") or self.limits.of("du")) and h.inputs == h.steps
        output = bool(self.limits.of("y")) and h.outputs == h.steps and self.models[-1].D.any()
        return h.steps + int(final or output)
