"""Runs into conditions: against sets, against random runs, and with wrong arguments."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hysdel_py as hys
from hysdel_py.analysis.hybrid_set import hybrid_set
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron

RELAY = """
SYSTEM relay {
INTERFACE {
  STATE { REAL T [-20, 60]; BOOL on; }
  INPUT { REAL w [-1, 1]; }
  OUTPUT { REAL y; }
  PARAMETER { REAL a = 0.9; }
}
IMPLEMENTATION {
  AUX { BOOL hot, cold; REAL heat; }
  AD { hot = T >= 22; cold = T <= 18; }
  DA { heat = { IF on THEN 3 ELSE 0 }; }
  CONTINUOUS { T = a * T + heat + w; }
  AUTOMATA { on = cold | (on & ~hot); }
  OUTPUT { y = T; }
} }
"""
STEPS = 5


@pytest.fixture(scope="module")
def relay():
    return hys.load(RELAY)


@pytest.fixture(scope="module")
def tanks():
    return hys.load("two_tanks")


def replayed(model, run):
    return model.simulate(run.x[0], run.u)


@settings(deadline=None, max_examples=12)
@given(
    low=st.floats(10, 26), width=st.floats(0.0, 2.0), on=st.integers(0, 1), goal=st.floats(10, 30),
    span=st.floats(0.1, 1.0),
)  # fmt: skip
def test_sets_and_programs_agree(relay, low, width, on, goal, span):
    x0, target = {"T": (low, low + width), "on": on}, {"T": (goal, goal + span), "on": 1}
    answer = hys.can_reach(relay, x0, target, STEPS)
    sets = hys.reach(relay, x0, STEPS)
    smaller = hybrid_set({"T": (goal + 1e-4, goal + span - 1e-4), "on": 1}, relay.dha.x, "target")
    larger = hybrid_set({"T": (goal - 1e-4, goal + span + 1e-4), "on": 1}, relay.dha.x, "target")
    if answer.verdict == "reachable":
        assert sets.sets[answer.time].meets(larger) is not None
        assert larger.contains(replayed(relay, answer.run).x[answer.time])
        inner = sets.first_meeting(smaller)
        assert inner is None or inner >= answer.time
    else:
        assert answer.verdict == "unreachable"
        assert sets.first_meeting(smaller) is None


def test_witness_is_earliest_and_does_what_it_says(tanks):
    x0 = {"h1": (0, 0.2), "h2": (0, 0.2)}
    answer = hys.can_reach(tanks, x0, "h1 >= 0.4 & h2 <= 0.1", 20)
    assert (answer.verdict, answer.time, answer.borderline) == ("reachable", 4, False)
    run = replayed(tanks, answer.run)
    np.testing.assert_array_equal(run.x, answer.run.x)
    assert run["h1"][4] >= 0.4
    assert run["h2"][4] <= 0.1
    assert hys.can_reach(tanks, x0, "h1 >= 0.4 & h2 <= 0.1", 3).verdict == "unreachable"
    text = str(answer)
    assert "reachable: this run meets it at step 4" in text
    assert "above becomes true" in text
    assert "two_tanks.hys:43" in text
    assert answer.to_dict()["run"]["x"][4][0] >= 0.4


def test_nothing_is_reached_that_random_runs_reach(relay):
    """What is proven unreachable is met by none of 2000 runs, and it lies close to what is."""
    x0 = {"T": (15, 20), "on": (0, 1)}
    highest = hys.reach(relay, x0, STEPS).union.ranges()["T"][1]
    assert hys.can_reach(relay, x0, f"T >= {highest + 0.01}", STEPS).verdict == "unreachable"
    assert hys.can_reach(relay, x0, f"T >= {highest - 0.01}", STEPS).verdict == "reachable"
    rng = np.random.default_rng(3)
    for _ in range(400):
        run = relay.simulate([rng.uniform(15, 20), float(rng.integers(2))], rng.choice([-1.0, 1.0], (STEPS, 1)))
        assert run["x.T"].max() <= highest + 1e-6


def test_inevitable_and_avoidable(relay):
    cold = {"T": (-5, 15), "on": (0, 1)}
    assert hys.must_reach(relay, cold, "on", 1).verdict == "inevitable"
    answer = hys.must_reach(relay, cold, "T >= 24", 10)
    assert answer.verdict == "avoidable"
    assert replayed(relay, answer.run)["x.T"].max() < 24
    within = hys.must_reach(relay, cold, "T >= 16", 20)
    assert within.verdict == "inevitable"
    assert within.steps <= 20
    assert hys.must_reach(relay, cold, "T >= 16", 20, inputs={"w": 1}).steps <= within.steps


def test_nothing_is_inevitable_without_a_run():
    model = hys.load(
        "SYSTEM s { INTERFACE { STATE { REAL v [0, 1]; } } IMPLEMENTATION { CONTINUOUS { v = v + 0.3; } } }"
    )
    assert hys.must_reach(model, {"v": 0.5}, "v >= 0.9", 4).verdict == "no run"
    assert hys.must_reach(model, {"v": 0.2}, "v >= 0.45", 2).verdict == "inevitable"


def test_an_answer_about_no_runs_says_so():
    model = hys.load(
        "SYSTEM s { INTERFACE { STATE { REAL v [0, 1]; } }"
        " IMPLEMENTATION { CONTINUOUS { v = v + 0.3; } MUST { v <= 0.8; } } }"
    )
    assert hys.can_reach(model, {"v": 0.9}, "v >= 1", 3).verdict == "no run"
    short = hys.can_reach(model, {"v": 0.3}, "v >= 0.95", 5)
    assert short.verdict == "unreachable"
    assert "no run lasts for 5 steps" in str(short)


def test_touching_is_no_passing(tanks):
    """The declared range ends where the condition begins."""
    answer = hys.can_reach(tanks, {"h1": (0.4, 0.6), "h2": 0.3}, "~(h1 <= 0.6)", 3)
    assert (answer.verdict, answer.borderline) == ("unreachable", True)
    assert "touch a threshold" in str(answer)
    assert hys.can_reach(tanks, {"h1": (0.4, 0.6), "h2": 0.3}, "h1 >= 0.6", 3).verdict == "reachable"


def test_a_flat_target_is_met_up_to_the_tolerance(tanks):
    answer = hys.can_reach(tanks, {"h1": 0.4, "h2": 0.3}, {"h1": 0.5}, 6)
    assert answer.verdict == "reachable"
    assert answer.run["h1"][answer.time] == pytest.approx(0.5, abs=1e-6)


def test_conditions_read_every_kind_of_signal(relay, tanks):
    x0 = {"T": 17, "on": 0}
    assert hys.can_reach(relay, x0, "y >= 18.1 & cold", 4).verdict == "unreachable"
    assert hys.can_reach(relay, x0, "y >= 18 & heat >= a & w <= 0", 6).verdict == "reachable"
    assert hys.can_reach(tanks, {"h1": 0.5, "h2": 0.1}, "valve & level2 >= 0.2", 5).verdict == "reachable"
    assert hys.can_reach(relay, x0, "TRUE", 2).time == 0
    assert hys.can_reach(relay, x0, "FALSE", 2).verdict == "unreachable"


def test_starts_and_targets_of_every_kind(relay):
    box = Polyhedron.box([16, 0], [18, 0])
    for x0 in ([17, 0], {"T": 17, "on": 0}, "T >= 16 & T <= 18 & ~on", box, hybrid_set(box, relay.dha.x, "x0")):
        assert hys.can_reach(relay, x0, Polyhedron.box([19, 1], [30, 1]), 8).verdict == "reachable"
        assert hys.can_reach(relay, x0, {"T": (40, 60)}, 8).verdict == "unreachable"


def test_names_with_indices():
    model = hys.load(
        "SYSTEM v { INTERFACE { STATE { REAL level(2) [0, 1]; } INPUT { REAL q [0, 0.1]; } }"
        " IMPLEMENTATION { CONTINUOUS { level(1) = 0.9*level(1) + q; level(2) = 0.5*level(2) + 0.4*level(1); } } }"
    )
    x0 = {"level(1)": 0.0, "level(2)": 0.0}
    assert hys.can_reach(model, x0, "level(1) >= 0.15", 5).time == 2
    assert hys.can_reach(model, x0, "level( 2 ) >= 0.9", 10).verdict == "unreachable"


def test_time_limit_is_told(tanks):
    answer = hys.can_reach(tanks, {}, "h2 >= 0.59 & h1 <= 0.01", 30, seconds=1e-9)
    assert answer.verdict == "not settled"
    assert "time" in answer.message


@pytest.mark.parametrize(
    ("x0", "target", "more", "words"),
    [
        ({}, "h1 >=", {}, "expected an expression"),
        ({}, "h3 >= 1", {}, "there is no h3; the names are h1"),
        ({}, "h1 == 1", {}, "equality"),
        ({}, "h1 + 1", {}, "'h1 \\+ 1'"),
        ({}, "h1 > 0; }", {}, "one Boolean expression"),
        ({}, "", {}, "one Boolean expression"),
        ({}, {"h9": 1}, {}, "there is no h9"),
        ({}, {"h1": (2, 1)}, {}, "holds no number"),
        ({"h1": (0.7, 0.9)}, "h1 >= 0", {}, "nothing in common"),
        ("level1 >= 0.2", "h1 >= 0", {}, "more than states"),
        ([0.1], "h1 >= 0", {}, "2 entries"),
        ({}, Polyhedron.box([0], [1]), {}, "2 states"),
        ({}, "h1 >= 0", {"steps": -1}, "at least 0"),
        ({}, "level1 >= 0", {"steps": 0}, "at least 1"),
        ({}, "h1 >= 0", {"steps": 1.5}, "whole number"),
        ({}, "h1 >= 0", {"inputs": {"p": 1}}, "there is no p"),
        ({}, "h1 >= 0", {"seconds": 0}, "positive"),
    ],
)
def test_wrong_arguments(tanks, x0, target, more, words):
    options = {"steps": 3, **more}
    for query in (hys.can_reach, hys.must_reach):
        with pytest.raises(ArgumentError, match=words):
            query(tanks, x0, target, **options)


def test_a_dha_is_no_model(tanks):
    with pytest.raises(ArgumentError, match="a Model was expected"):
        hys.can_reach(tanks.dha, {}, "h1 >= 0", 1)
