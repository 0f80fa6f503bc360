"""Comparison of methods: what it does where a run ends early."""

import math

import pytest

import hysdel_py as hys
from hysdel_py.drivetrain import comparison
from hysdel_py.drivetrain.dual_clutch import START, UNTIL, dual_clutch
from hysdel_py.errors import SimulationError


def test_a_run_that_ends_early_has_no_mean_error():
    whole = dual_clutch("b").simulate(START, UNTIL, hys.Moreau(dt=1e-2))
    early = dual_clutch("b").simulate(START, 5.0, hys.Moreau(dt=1e-2))
    assert math.isnan(comparison.mean_error(early, whole))
    assert comparison.mean_error(whole, whole) == 0.0


def test_an_exact_solution_that_ends_early_is_told(monkeypatch):
    class Ending:
        def simulate(self, start, until, scheme, sample):
            run = dual_clutch("b").simulate(START, 0.5, sample=0.1)
            object.__setattr__(run, "messages", ("events accumulate at t = 0.5 s: the run ends there",))
            return run

    monkeypatch.setattr(comparison, "dual_clutch", lambda case: Ending())
    with pytest.raises(SimulationError, match="nothing to compare with: in the exact solution events accumulate"):
        comparison.compare("b")
