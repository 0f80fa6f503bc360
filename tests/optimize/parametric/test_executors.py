"""Runs on executors, progress, limits and interrupts."""

from __future__ import annotations

from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor

import pytest
from problems import EXPECTED, benchmark, of_small_integers

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.optimize.mpqp import MpQpSettings, solve_mpqp
from hysdel_py.optimize.parametric.exploration import Stop


class Backwards:
    """An executor that runs the last submitted task first."""

    def __init__(self):
        self.pending = []

    def submit(self, function, *arguments):
        future = Future()
        future.result = lambda timeout=None: self.value(future)
        self.pending.append((future, function, arguments))
        self.values = {}
        return future

    def value(self, future):
        for other, function, arguments in reversed(self.pending):
            self.values.setdefault(id(other), function(*arguments))
        return self.values[id(future)]


def contents(solution):
    """All bytes of a map."""
    return [
        (
            region.active,
            region.r,
            *(getattr(region, name).tobytes() for name in ("A", "b", "K", "k", "P", "q", "centre")),
        )
        for region in solution.regions
    ]


@pytest.mark.parametrize("problem", [benchmark("e_rnd0_z3t2")[0], of_small_integers(8, "semidefinite")])
def test_the_answer_does_not_depend_on_the_executor(problem):
    settings = MpQpSettings(chunk=2)
    alone = contents(solve_mpqp(problem, settings))
    assert contents(solve_mpqp(problem)) == alone
    with ThreadPoolExecutor(2) as threads, ProcessPoolExecutor(2) as processes:
        for executor in (threads, processes, Backwards()):
            other = solve_mpqp(problem, settings, executor=executor)
            assert other.complete
            assert contents(other) == alone


class Lazy:
    """An executor that runs a task when its result is asked for, and notes what is cancelled."""

    def __init__(self):
        self.cancelled = 0

    def submit(self, function, *arguments):
        future = Future()
        future.result = lambda timeout=None: function(*arguments)
        future.cancel = self.cancel
        return future

    def cancel(self):
        self.cancelled += 1


def test_a_limit_stops_an_executor_at_the_same_map():
    settings, executor = MpQpSettings(regions=7, chunk=1), Lazy()
    problem, _ = benchmark("e_rnd1_z4t2")
    solution = solve_mpqp(problem, settings, executor=executor)
    assert solution.stop is Stop.REGIONS
    assert not solution.complete
    assert executor.cancelled > 0
    for chunk in (1, 50):
        assert contents(solve_mpqp(problem, MpQpSettings(regions=7, chunk=chunk))) == contents(solution)


def test_progress_counts_up_to_all_regions():
    calls = []
    solution = solve_mpqp(benchmark("e_rnd1_z4t2")[0], progress=lambda found, waiting: calls.append((found, waiting)))
    found = [call[0] for call in calls]
    assert found == sorted(found)
    assert calls[-1] == (len(solution.regions), 0)


def test_a_limit_leaves_a_partial_map():
    solution = solve_mpqp(benchmark("e_rnd1_z4t2")[0], MpQpSettings(regions=10))
    assert not solution.complete
    assert solution.stop is Stop.REGIONS
    assert len(solution.regions) == 10
    assert not ExplicitLaw.of(solution).complete
    assert solve_mpqp(benchmark("e_rnd1_z4t2")[0], MpQpSettings(seconds=1e-9)).stop is Stop.SECONDS


def test_an_interrupt_leaves_a_partial_map():
    calls = []

    def progress(found, waiting):
        calls.append((found, waiting))
        if len(calls) == 3:
            raise KeyboardInterrupt

    solution = solve_mpqp(benchmark("e_rnd1_z4t2")[0], progress=progress)
    assert solution.stop is Stop.INTERRUPTED
    assert not solution.complete
    assert 0 < len(solution.regions) < EXPECTED["e_rnd1_z4t2"]
    assert calls[0][0] == 1
