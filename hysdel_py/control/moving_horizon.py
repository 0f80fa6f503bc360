"""Moving horizon estimation on an MLD model: the past that explains the measurements best.

::

    minimise    |x_0 - xbar|^2_arrival + sum_k |y_k - measured_k|^2_noise + |x_{k+1} - f(x_k, u_k, d_k, z_k)|^2_process
                + sum_k price' u_k (unknown inputs)
    subject to  E2 d_k + E3 z_k <= E1 u_k + E4 x_k + E5,  all variables in their ranges,  known inputs as applied

over the last N steps, by the branch and bound of the controllers. The unknown inputs may stand for faults, and Boolean
states and auxiliaries for modes that nobody measures. The program is that of A. Bemporad, D. Mignone, M. Morari,
"Moving horizon estimation for hybrid systems and fault detection", American Control Conference, 1999.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control import construction
from hysdel_py.control.layout import Layout
from hysdel_py.control.move import MoveStatus
from hysdel_py.control.observer import variances
from hysdel_py.control.window import Variances, Window, assemble_window
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import as_vector

if TYPE_CHECKING:
    from hysdel_py.optimize.miqp import MiqpResult

__all__ = ["Estimate", "MovingHorizonEstimator"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """What the past most likely was.

    Attributes
    ----------
    status : MoveStatus
        ``OPTIMAL``, ``FEASIBLE`` (the search ended early) or why there is no estimate.
    message : str
    x : array of shape (nx,), or None
        Estimate of the state after the last step of the window.
    states : array of shape (M+1, nx), or None
        Over the window of M steps.
    inputs : array of shape (M, nu), or None
        Known inputs as they were given, unknown ones as estimated.
    d : array of shape (M, nd), or None
    cost, bound : float
    nodes : int
    seconds : float
    """

    status: MoveStatus
    message: str
    x: Matrix | None = None
    states: Matrix | None = None
    inputs: Matrix | None = None
    d: Matrix | None = None
    cost: float = inf
    bound: float = -inf
    nodes: int = 0
    seconds: float = 0.0

    @property
    def ok(self) -> bool:
        """Whether there is an estimate."""
        return self.x is not None


@dataclass(slots=True)
class _Past:
    """What is known: measurements, inputs, and the estimate of the state before them."""

    arrival: Matrix
    y: list[Matrix] = field(default_factory=list)
    u: list[Matrix] = field(default_factory=list)


class MovingHorizonEstimator:
    """Estimate states, modes and unknown inputs from the last N measurements.

    Parameters
    ----------
    model : Model or Mld
    horizon : int
        Number N of steps that are looked back on.
    x0 : array_like of shape (nx,), or mapping
        First guess of the state.
    noise : mapping of output name to number, or vector
        Variances of the noise of the measured outputs.
    arrival : mapping of state name to number, vector or number
        Variances of the guess of the first state of a window; infinite for a state of which nothing is known.
    process : mapping of state name to number, or vector
        Variances of what disturbs a real state per step; 0 (the default) where its equation is exact.
    measured : sequence of str, optional
        Outputs that are measured; all by default.
    unknown : mapping of input name to number, or sequence of str
        Inputs that nobody knows, and the price of a unit of each: a fault is reported where it explains more of the
        measurements than it costs. Prices are not negative; without them 0.
    backend, time_limit, node_limit, gap_rel, gap_abs
        As for :class:`HybridMpc`; costs are squared deviations in units of the variances.

    Raises
    ------
    ArgumentError
        If an argument does not fit the model.
    """

    def __init__(
        self,
        model: Any,
        horizon: int,
        x0: ArrayLike | Mapping[str, float],
        noise: Mapping[str, float] | ArrayLike,
        *,
        arrival: Mapping[str, float] | ArrayLike = 1.0,
        process: Mapping[str, float] | ArrayLike = 0.0,
        measured: Sequence[str] | None = None,
        unknown: Mapping[str, float] | Sequence[str] = (),
        backend: str = "auto",
        time_limit: float | None = None,
        node_limit: int | None = None,
        gap_rel: float = 1e-4,
        gap_abs: float = 1e-4,
    ) -> None:
        self.mld = construction.mld_of(model)
        self.horizon = construction.checked_horizon(horizon, self.mld)
        self.measured = _chosen(measured, [v.name for v in self.mld.y], "measured", "outputs")
        states = tuple(v.name for v in self.mld.x)
        self._noise = variances(noise, self.measured, "noise", positive=True)
        self._arrival = variances(arrival, states, "arrival", positive=True, infinite=True)
        self._process = variances(process, states, "process") * [not v.is_bool for v in self.mld.x]
        self._prices = self._unknown(unknown)
        limits = {"time_limit": time_limit, "node_limit": node_limit}
        self._settings = construction.search_settings(backend, limits, gap_rel, gap_abs, 4e-7)
        self._first = as_vector(x0, self.mld.x, "state")
        self._windows: dict[int, Window] = {}
        self._past = _Past(self._first)

    def reset(self) -> None:
        """Forget all measurements."""
        self._past = _Past(self._first)

    def update(self, y: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] = ()) -> Estimate:
        """Take in one step, its measurement and its known inputs, and estimate the state after it.

        Parameters
        ----------
        y : array_like with one entry per measured output, or mapping
        u : array_like with one entry per known input, or mapping

        Returns
        -------
        Estimate
            Trouble in the solver never raises; without an estimate the window is kept.
        """
        outputs = tuple(v for v in self.mld.y if v.name in self.measured)
        known = tuple(v for v in self.mld.u if v.name not in self._prices)
        past = self._past
        past.y.append(as_vector(y, outputs, "output"))
        past.u.append(as_vector(u, known, "input"))
        window = self._window(len(past.y))
        estimate = _estimate(window, window.solve(past.arrival, past.y, past.u, self._known_columns()), self.mld)
        if len(past.y) == self.horizon:
            self._slide(estimate)
        return estimate

    def _slide(self, estimate: Estimate) -> None:
        """Drop the oldest step; its successor as estimated becomes the guess of the next window."""
        past = self._past
        if estimate.states is not None:
            past.arrival = estimate.states[1]
        else:
            past.arrival = np.array([np.clip(v, w.low, w.high) for v, w in zip(past.arrival, self.mld.x, strict=True)])
        del past.y[0], past.u[0]

    def _unknown(self, unknown: Mapping[str, float] | Sequence[str]) -> dict[str, float]:
        names = _chosen(tuple(unknown), [v.name for v in self.mld.u], "unknown", "inputs")
        prices = dict(unknown) if isinstance(unknown, Mapping) else dict.fromkeys(names, 0.0)
        for name, price in prices.items():
            if not (np.isfinite(price) and price >= 0):
                raise ArgumentError(f"the price of {name} is {price}: a number that is not negative was expected")
        return prices

    def _known_columns(self) -> list[int]:
        return [i for i, v in enumerate(self.mld.u) if v.name not in self._prices]

    def _window(self, steps: int) -> Window:
        if steps not in self._windows:
            self._windows[steps] = self._assemble(steps)
        return self._windows[steps]

    def _assemble(self, steps: int) -> Window:
        layout = Layout(self.mld, steps, ())
        outputs = np.flatnonzero([v.name in self.measured for v in self.mld.y])
        prices = np.array([self._prices.get(v.name, 0.0) for v in self.mld.u])
        variances_of_window = Variances(self._arrival, self._noise, self._process)
        return assemble_window(layout, outputs, variances_of_window, prices, self._settings)


def _estimate(window: Window, result: MiqpResult, mld: Mld) -> Estimate:
    status = MoveStatus.NUMERICAL
    if result.x is None:
        status = {"INFEASIBLE": MoveStatus.INFEASIBLE, "NUMERICAL": status}.get(result.status.name, MoveStatus.NO_PLAN)
        message = f"no estimate: {result.message}"
        if status is MoveStatus.INFEASIBLE:
            message += "; no past of the model has these inputs: check ranges, unknown inputs and process variances"
        return Estimate(status, message, bound=result.bound, nodes=result.nodes, seconds=result.seconds)
    status = MoveStatus.OPTIMAL if result.status.name == "OPTIMAL" else MoveStatus.FEASIBLE
    plan = window.layout.split(result.x[: window.layout.n], result.x[window.layout.n :])
    booleans = np.array([v.is_bool for v in mld.x], dtype=bool)
    states = np.where(booleans, np.round(plan.x), plan.x)
    return Estimate(
        status, result.message, states[-1].copy(), states, plan.u, np.round(plan.d), float(result.objective),
        float(result.bound), result.nodes, result.seconds,
    )  # fmt: skip


def _chosen(names: Sequence[str] | None, known: list[str], what: str, kind: str) -> tuple[str, ...]:
    chosen = tuple(known) if names is None else tuple(names)
    wrong = [name for name in chosen if name not in known]
    if wrong:
        raise ArgumentError(f"{what} names {', '.join(wrong)}: {kind} were expected, {', '.join(known) or '(none)'}")
    return tuple(name for name in known if name in chosen)
