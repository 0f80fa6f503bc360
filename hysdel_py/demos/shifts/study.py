"""Many runs of a shift on plants that nobody knows exactly.

Every run draws the friction coefficient, the inertias, the load and the mass of the vehicle evenly from 20 % below to
20 % above the numbers of the models, by a Latin hypercube, so that few runs cover the ranges; inputs take effect 5 ms
late and measurements are noisy. The draws depend on the seed and the number of runs alone, whoever computes them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.plant import Deviation
from hysdel_py.demos.shifts.sensors import NOISE
from hysdel_py.demos.shifts.shift import run_shift
from hysdel_py.errors import ArgumentError

__all__ = ["DELAY", "SPREAD", "Trial", "run_trial", "spread_trials", "trials"]

SPREAD = 0.2
"""Share by which a parameter of the plant is off at most."""
DELAY = 0.005
"""Seconds until an input takes effect."""
_DRAWN = ("friction", "inertia", "load", "mass")


@dataclass(frozen=True, slots=True)
class Trial:
    """One run of a study.

    Attributes
    ----------
    shift, controller : str
    number : int
        Also the seed of the noise.
    deviation : Deviation
    observed : bool
        Whether the controllers have their observer.
    """

    shift: str
    controller: str
    number: int
    deviation: Deviation
    observed: bool = True

    @property
    def key(self) -> str:
        """Tells trials of a study apart."""
        return f"{self.shift} {self.controller} {self.number}{'' if self.observed else ' unobserved'}"


def trials(
    shift: str, count: int, *, controller: str = "hybrid", seed: int = 1, delay: float = DELAY, observed: bool = True
) -> tuple[Trial, ...]:
    """Draw the plants of a study.

    Parameters
    ----------
    shift : str
        Name of the shift.
    count : int
        Number of runs.
    controller : str
    seed : int
    delay : float
        [s]
    observed : bool

    Raises
    ------
    ArgumentError
        No such shift, or a count below one.
    """
    if shift not in SHIFTS:
        raise ArgumentError(f"shift is {shift!r}: one of {', '.join(SHIFTS)} was expected")
    if count < 1:
        raise ArgumentError(f"count is {count!r}: at least one run was expected")
    rng = np.random.default_rng(seed)
    cells = np.column_stack([rng.permutation(count) for _ in _DRAWN])
    factors = 1.0 + SPREAD * (2.0 * (cells + rng.random(cells.shape)) / count - 1.0)
    return tuple(
        Trial(shift, controller, i, Deviation(**dict(zip(_DRAWN, map(float, row), strict=True)), delay=delay), observed)
        for i, row in enumerate(factors)
    )


def run_trial(trial: Trial) -> dict[str, Any]:
    """Run one trial and return its figures as plain data."""
    run = run_shift(
        SHIFTS[trial.shift], controller=trial.controller, deviation=trial.deviation, noise=NOISE, seed=trial.number,
        observed=trial.observed,
    )  # fmt: skip
    return (
        {"key": trial.key, "number": trial.number, "observed": trial.observed} | asdict(trial.deviation) | run.figures()
    )


def spread_trials(
    wanted: Sequence[Trial], executor: Any = None, done: Callable[[dict[str, Any]], Any] | None = None
) -> list[dict[str, Any]]:
    """Run trials, over an executor where there is one.

    Parameters
    ----------
    wanted : sequence of Trial
    executor : concurrent.futures.Executor or the like, optional
        Has ``submit``.
    done : callable, optional
        Called with the figures of each trial when they are there, for example to keep them.

    Returns
    -------
    list of dict
        In the order of the trials.
    """
    found: dict[str, dict[str, Any]] = {}
    for result in _results(wanted, executor):
        found[result["key"]] = result
        if done is not None:
            done(result)
    return [found[trial.key] for trial in wanted]


def _results(wanted: Sequence[Trial], executor: Any) -> Iterator[dict[str, Any]]:
    if executor is None:
        yield from map(run_trial, wanted)
        return
    from concurrent.futures import as_completed

    yield from (future.result() for future in as_completed([executor.submit(run_trial, trial) for trial in wanted]))
