"""The two forms of a model agree wherever the MLD form is defined, on random models and on the clutch."""

import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from strategies import models

import hysdel_py as hys
from hysdel_py.systems.dha import Event

POINTS_PER_MODEL = 12
AGREEMENT = 1e-10


def random_point(variables, generator):
    """Values within the declared ranges, on a coarse grid half of the time so that thresholds are hit exactly."""
    exact = generator.integers(2)
    values = []
    for v in variables:
        if v.is_bool:
            values.append(float(generator.integers(2)))
        elif exact:
            values.append(float(np.clip(np.round(generator.uniform(v.low, v.high) * 2) / 2, v.low, v.high)))
        else:
            values.append(float(generator.uniform(v.low, v.high)))
    return np.array(values)


def least_gap(dha, values):
    """Smallest distance above a threshold, in units of its epsilon; infinite if all events hold or are far off."""
    forms = [(item.form.value(values), item.epsilon) for item in dha.items if isinstance(item, Event)]
    return min((value / epsilon for value, epsilon in forms if value > 0), default=np.inf)


def compare(dha, mld, x, u):
    """Step both; 'equal', 'must' or 'gap' after checking that nothing else can be the reason."""
    try:
        expected = dha.step(x, u)
    except hys.SimulationError as error:
        assert all("MUST" in problem for problem in error.problems), error  # noqa: PT017 -- one of two verdicts
        with pytest.raises(hys.SimulationError):
            mld.step(x, u)
        return "must"
    _, _, d, z = expected
    values = {v.name: value for group, vector in ((dha.x, x), (dha.u, u), (dha.d, d), (dha.z, z))
              for v, value in zip(group, vector, strict=True)}  # fmt: skip
    try:
        found = mld.step(x, u)
    except hys.SimulationError as error:
        in_a_gap = least_gap(dha, values) < 1.0 and "unique" not in str(error)
        assert in_a_gap, f"infeasible away from every threshold: {error}"  # noqa: PT017 -- the other verdict
        return "gap"
    for ours, theirs in zip(found, expected, strict=True):
        np.testing.assert_allclose(ours, theirs, atol=AGREEMENT, rtol=AGREEMENT)
    return "equal"


@settings(max_examples=250, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models(), st.integers(0, 2**32 - 1))
def test_random_models(text, seed):
    model = hys.load(text)
    dha, mld = model.dha, model.mld
    generator = np.random.default_rng(seed)
    for _ in range(POINTS_PER_MODEL):
        compare(dha, mld, random_point(mld.x, generator), random_point(mld.u, generator))


def test_random_models_reach_all_three_outcomes():
    """The property above would be empty if its models were always infeasible."""
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-2, 2]; BOOL b; } }
      IMPLEMENTATION { AUX { BOOL d; REAL z; } AD { d = x <= 0; } DA { z = {IF d & b THEN x ELSE 1}; }
      CONTINUOUS { x = z; } AUTOMATA { b = ~d; } MUST { x <= 1; } } }"""
    model = hys.load(text)
    points = {"equal": [0.0, 1.0], "gap": [5e-7, 0.0], "must": [1.5, 0.0]}
    for outcome, x in points.items():
        assert compare(model.dha, model.mld, np.array(x), np.zeros(0)) == outcome


def test_clutch_sizes():
    mld = hys.load("clutch").mld
    assert (mld.nx, mld.nu, mld.ny, mld.nd, mld.nz, mld.ne) == (5, 2, 3, 6, 3, 26)


def test_clutch_at_two_thousand_points():
    model = hys.load("clutch")
    generator = np.random.default_rng(7)
    outcomes = [
        compare(model.dha, model.mld, random_point(model.mld.x, generator), random_point(model.mld.u, generator))
        for _ in range(2000)
    ]
    assert outcomes.count("equal") >= 1990
    assert "must" not in outcomes


def test_every_row_names_its_item():
    mld = hys.load("clutch").mld
    for row in mld.rows:
        assert row.line > 0
        assert re.match(r"line \d+: \S", str(row))
        assert row.defines in {v.name for v in (*mld.d, *mld.z)}
