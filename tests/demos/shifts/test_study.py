"""Studies of many plants: the same draws for everyone, results in order, whoever computes them."""

import numpy as np
import pytest

from hysdel_py.demos.shifts import study
from hysdel_py.demos.shifts.study import run_trial, spread_trials, trials
from hysdel_py.errors import ArgumentError


def test_draws_cover_their_ranges_and_depend_on_the_seed_alone():
    drawn = trials("upshift-23", 20)
    friction = np.sort([trial.deviation.friction for trial in drawn])
    assert np.all((friction - 0.8) // 0.02 == np.arange(20)), "one in each twentieth: a Latin hypercube"
    assert drawn == trials("upshift-23", 20)
    assert drawn != trials("upshift-23", 20, seed=2)
    assert all(0.8 <= trial.deviation.inertia <= 1.2 and trial.deviation.delay == 0.005 for trial in drawn)
    assert len({trial.key for trial in (*drawn, *trials("upshift-23", 20, controller="ramps"))}) == 40


def test_a_trial_gives_plain_figures():
    row = run_trial(trials("upshift-23", 3, controller="ramps")[1])
    assert row["key"] == "upshift-23 ramps 1"
    assert row["shift"] == "upshift-23"
    assert 0.8 <= row["friction"] <= 1.2
    assert isinstance(row["relative_release"], float)


class Backwards:
    """An executor that finishes its tasks in the reverse order."""

    def submit(self, function, argument):
        from concurrent.futures import Future

        future = Future()
        future.set_result(function(argument))
        return future


@pytest.mark.parametrize("executor", [None, Backwards()])
def test_results_come_in_order_and_are_told(monkeypatch, executor):
    monkeypatch.setattr(study, "run_trial", lambda trial: {"key": trial.key})
    wanted, told = trials("upshift-23", 5), []
    found = spread_trials(wanted, executor, told.append)
    assert [row["key"] for row in found] == [trial.key for trial in wanted]
    assert sorted(row["key"] for row in told) == sorted(trial.key for trial in wanted)


def test_wrong_studies():
    with pytest.raises(ArgumentError, match="shift is 'upshift-34': one of upshift-23"):
        trials("upshift-34", 3)
    with pytest.raises(ArgumentError, match="count is 0"):
        trials("upshift-23", 0)
