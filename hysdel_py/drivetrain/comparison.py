"""All methods on the Dual-clutch: errors against the exact solution, times, orders, and the document's two tables.

Times are processor times of one run, each the best of a few, with compiled kernels warmed up before; only their ratios
mean something. "Mean error" is the mean over time and over the four speeds of the absolute difference [rad/s].
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import inf, nan
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.drivetrain import Drivetrain
from hysdel_py.drivetrain.dual_clutch import SHAFTS, START, UNTIL, dual_clutch
from hysdel_py.drivetrain.schemes.options import (
    AugmentedLagrangian,
    EventDriven,
    Exact,
    FixedStepLcp,
    Karnopp,
    Moreau,
    Scheme,
    Smoothing,
    SwitchModel,
    VariableStepMoreau,
    WaitState,
)
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory
from hysdel_py.errors import SimulationError

__all__ = ["BASE", "FIXED", "PAIRS", "VARIABLE", "Comparison", "Pair", "Row", "compare", "convergence_orders"]

Matrix = NDArray[np.float64]

_SAMPLE = 1e-3
_REPEATS = 2
_LONG = 0.5
"""Processor time of a run [s] from which it is measured once."""

_ORDER_STEPS = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
_SWITCH = SwitchModel(band=1e-2, tau=1e-2, integrator="euler")

BASE = "SWITCH"
"""The method to whose time the others are compared."""

FIXED: Mapping[str, Scheme] = {
    "SWITCH": _SWITCH,
    "SWITCH tau=inf, band 0.1": SwitchModel(band=0.1, tau=inf, integrator="euler"),
    "SWITCH ode3": replace(_SWITCH, integrator="rk3"),
    "LCPEV": FixedStepLcp(band=0.1, solver="active-set"),
    "LCPTS": Moreau(theta=None, inputs="start"),
    "AUGLAGR p=1 tol=1e-4": AugmentedLagrangian(steepness=1.0, tolerance=1e-4, theta=None, inputs="start"),
    "AUGLAGR p=1 tol=1e-8": AugmentedLagrangian(steepness=1.0, tolerance=1e-8, theta=None, inputs="start"),
    "AUGLAGR p=10 tol=1e-4": AugmentedLagrangian(steepness=10.0, tolerance=1e-4, theta=None, inputs="start"),
    "SIMDRV": WaitState(),
    "Karnopp rk3": Karnopp(),
    "Switch Model, band tied to step": SwitchModel(),
    "Moreau, inputs in the middle": Moreau(theta=None),
    "Moreau theta=1/2": Moreau(),
    "augmented Lagrangian theta=1/2": AugmentedLagrangian(),
    "smoothing 10 rk4": Smoothing(steepness=10.0, dt=1e-3),
}
"""Methods with fixed steps; the names in capitals are the document's."""

LONGEST_STEP_ONLY: Mapping[str, Scheme] = {
    "LCPEV, explicit LCP": FixedStepLcp(band=0.1),
    "LCPTS, explicit LCP": Moreau(theta=None, inputs="start", solver="auto"),
}
"""The same without compiled loop: one LCP after another in Python."""

VARIABLE: Mapping[str, Scheme] = {
    "smoothing 1e3 Radau": Smoothing(),
    "variable-step Moreau 1e-3": VariableStepMoreau(tolerance=1e-3),
    "variable-step Moreau 1e-4": VariableStepMoreau(),
    "event-driven RK45 1e-6": EventDriven(integrator="rk45", rtol=1e-6, atol=1e-6, solver="active-set"),
    "event-driven DOP853 1e-9": EventDriven(solver="active-set"),
}
"""Methods with error control."""

PAIRS: tuple[tuple[str, str, str], ...] = (
    ("LCPEV", "SWITCH", "1e-10"),
    ("LCPEV, explicit LCP", "SWITCH tau=inf, band 0.1", "1e-10"),
    ("LCPTS", "AUGLAGR p=1 tol=1e-4", "1e-3"),
    ("LCPTS", "AUGLAGR p=1 tol=1e-8", "1e-7"),
    ("LCPTS", "AUGLAGR p=10 tol=1e-4", "1e-3"),
    ("LCPTS", "SWITCH", "1e-1"),
    ("SWITCH", "AUGLAGR p=1 tol=1e-4", "1e-1"),
    ("SWITCH ode3", "SIMDRV", "1e-2"),
    ("AUGLAGR p=1 tol=1e-4", "SIMDRV", "5e-2 at 1e-3, 5e-3 at 1e-4"),
)
"""Pairs of the document's tables H.1 and H.2 with the mean difference printed there."""


@dataclass(frozen=True, slots=True)
class Row:
    """One method with one step.

    Attributes
    ----------
    method : str
    dt : float or None
        Step [s]; None where the method chooses it.
    error : float
        Mean error against the exact solution [rad/s].
    seconds : float
        Processor time.
    ratio : float
        That time over the time of BASE with the largest step.
    events : int
        Changes of modes.
    imbalance : float
        Greatest energy that no work accounts for [J].
    messages : tuple of str
    """

    method: str
    dt: float | None
    error: float
    seconds: float
    ratio: float
    events: int
    imbalance: float
    messages: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Pair:
    """Mean difference between two methods with the same step [rad/s], and what the document prints."""

    first: str
    second: str
    dt: float
    difference: float
    printed: str


@dataclass(frozen=True, slots=True)
class Comparison:
    """Result of :func:`compare`; `orders` maps methods to fitted orders of convergence, empty if not asked for."""

    case: str
    rows: tuple[Row, ...]
    pairs: tuple[Pair, ...]
    orders: Mapping[str, float]

    def to_dict(self) -> dict[str, Any]:
        """Plain data, ready for JSON."""
        rows = [{name: getattr(row, name) for name in Row.__slots__} for row in self.rows]
        pairs = [{name: getattr(pair, name) for name in Pair.__slots__} for pair in self.pairs]
        return {"case": self.case, "rows": rows, "pairs": pairs, "orders": dict(self.orders)}


def compare(
    case: str = "a",
    steps: tuple[float, ...] = (1e-3, 1e-4),
    *,
    orders: bool = False,
    repeats: int = _REPEATS,
    progress: Callable[[int, int], Any] | None = None,
) -> Comparison:
    """Run all methods on a case of the Dual-clutch.

    Parameters
    ----------
    case : {"a", "b"}
    steps : tuple of float
        Steps of the methods with fixed steps [s], largest first.
    orders : bool
        Also fit orders of convergence.
    repeats : int
        Runs of which the fastest counts.
    progress : callable, optional
        Called with the number of finished runs and the number of all.

    Raises
    ------
    ArgumentError
        There is no such case.
    SimulationError
        The exact solution that all are compared with ends early.
    """
    plant = dual_clutch(case)
    exact = _reference(plant, _SAMPLE)
    jobs: list[tuple[str, Scheme, float | None]] = [
        (name, _with_step(scheme, dt), dt) for dt in steps for name, scheme in FIXED.items()
    ]
    jobs += [(name, _with_step(scheme, steps[0]), steps[0]) for name, scheme in LONGEST_STEP_ONLY.items()]
    jobs += [(name, scheme, None) for name, scheme in VARIABLE.items()]
    found: dict[tuple[str, float | None], tuple[DrivetrainTrajectory, float]] = {}
    for done, (name, scheme, dt) in enumerate(jobs):
        found[name, dt] = _timed(plant, scheme, repeats)
        if progress is not None:
            progress(done + 1, len(jobs))
    base = found[BASE, steps[0]][1]
    rows = tuple(_row(key, run, seconds, base, exact) for key, (run, seconds) in found.items())
    pairs = tuple(
        Pair(a, b, dt, mean_error(found[a, dt][0], found[b, dt][0]), printed)
        for dt in steps
        for a, b, printed in PAIRS
        if (a, dt) in found
    )
    return Comparison(case, rows, pairs, convergence_orders(case) if orders else {})


def _reference(plant: Drivetrain, sample: float) -> DrivetrainTrajectory:
    """The exact solution, up to the end."""
    run = plant.simulate(START, UNTIL, Exact(), sample=sample)
    if run.t[-1] < UNTIL:
        raise SimulationError((f"there is nothing to compare with: in the exact solution {run.messages[0]}",))
    return run


def _with_step(scheme: Scheme, dt: float) -> Scheme:
    changed: Scheme = replace(scheme, dt=dt)  # type: ignore[arg-type]
    return changed


def _row(
    key: tuple[str, float | None], run: DrivetrainTrajectory, seconds: float, base: float, exact: DrivetrainTrajectory
) -> Row:
    name, dt = key
    error, imbalance = mean_error(run, exact), float(np.max(np.abs(run.imbalance)))
    return Row(name, dt, error, seconds, seconds / base, len(run.events), imbalance, run.messages)


def _timed(plant: Drivetrain, scheme: Scheme, repeats: int) -> tuple[DrivetrainTrajectory, float]:
    """A run and its time, once the kernels are compiled; methods that choose their steps are timed without samples.

    Runs that take long are not repeated: what disturbs a measurement is short.
    """
    plant.simulate(START, 10 * _SAMPLE, scheme, sample=_SAMPLE)
    best = inf
    free = scheme in VARIABLE.values()
    for _ in range(repeats):
        start = process_time()
        run = plant.simulate(START, UNTIL, scheme, sample=None if free else _SAMPLE)
        best = min(best, process_time() - start)
        if best > _LONG:
            break
    return (plant.simulate(START, UNTIL, scheme, sample=_SAMPLE) if free else run), best


def mean_error(run: DrivetrainTrajectory, other: DrivetrainTrajectory) -> float:
    """Mean over time and over the four speeds of the absolute difference [rad/s]; NaN where a run ended early."""
    if len(run.t) != len(other.t):
        return nan
    return float(np.mean([np.abs(run[name] - other[name]) for name in SHAFTS]))


def convergence_orders(case: str, steps: tuple[float, ...] = _ORDER_STEPS) -> dict[str, float]:
    """Slope of log error over log step by least squares, for each method with fixed steps."""
    plant = dual_clutch(case)
    exact = _reference(plant, max(steps))
    orders = {}
    for name, scheme in FIXED.items():
        runs = [plant.simulate(START, UNTIL, _with_step(scheme, dt), sample=max(steps)) for dt in steps]
        errors = np.array([mean_error(run, exact) for run in runs])
        converged = np.array([not run.info.get("failures") for run in runs])  # diverged iterations tell nothing
        finite = np.isfinite(errors) & converged
        orders[name] = (
            float(np.polyfit(np.log(np.array(steps)[finite]), np.log(errors[finite]), 1)[0])
            if np.count_nonzero(finite) > 1
            else float("nan")
        )
    return orders
