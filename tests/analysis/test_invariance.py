"""Invariant and feasible sets: closed forms, random runs and the controller's own answer."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.errors import ArgumentError

SWITCHED = """
SYSTEM switched {
INTERFACE { STATE { REAL p [-4, 4]; REAL v [-4, 4]; } INPUT { REAL u [-1, 1]; } }
IMPLEMENTATION {
  AUX { BOOL right; REAL gain; }
  AD { right = p >= 0; }
  DA { gain = { IF right THEN 0.3*v ELSE -0.2*v }; }
  CONTINUOUS { p = p + 0.5*v; v = v + gain + u; }
} }
"""


@pytest.fixture(scope="module")
def switched():
    return hys.load(SWITCHED)


@pytest.fixture(scope="module")
def kept(switched):
    return hys.invariant_set(switched, {"p": (-2, 2), "v": (-2, 2)}, rounds=40)


def test_every_corner_can_stay(switched, kept):
    """From each corner some input leads back into the set; outside of it random inputs never come back for long."""
    assert kept.is_invariant
    assert 0 < kept.rounds < 40
    for piece in kept.states.pieces:
        for corner in piece.region.vertices:
            inside = corner + 1e-6 * (piece.region.ball.centre - corner)
            after = [switched.dha.step(inside, [u])[0] for u in np.linspace(-1, 1, 401)]
            assert any(kept.states.contains(x, 1e-6) for x in after)


def test_what_was_taken_away_is_forced_out(switched, kept):
    rng = np.random.default_rng(0)
    lost = [x for x in rng.uniform(-2, 2, (300, 2)) if not kept.states.contains(x, 1e-6)]
    assert len(lost) > 20
    for x in lost[:6]:
        answer = hys.can_reach(switched, x, "~(-2 <= p & p <= 2 & -2 <= v & v <= 2)", 0)
        assert answer.verdict == "unreachable"
        stays = hys.must_reach(switched, x, "~(p >= -2 & p <= 2 & v >= -2 & v <= 2)", kept.rounds)
        assert stays.verdict in {"inevitable", "no run"}


def test_without_inputs_the_set_is_positively_invariant():
    model = hys.load(
        "SYSTEM s { INTERFACE { STATE { REAL p [-1, 1]; REAL v [-1, 1]; } }"
        " IMPLEMENTATION { CONTINUOUS { p = 0.8*p + 0.8*v; v = -0.4*p + 0.8*v; } } }"
    )
    found = hys.invariant_set(model)
    assert found.is_invariant
    (piece,) = found.states.pieces
    A = np.array([[0.8, 0.8], [-0.4, 0.8]])
    assert all(piece.region.contains(A @ corner, 1e-7) for corner in piece.region.vertices)
    rng = np.random.default_rng(1)
    for x in rng.uniform(-1, 1, (200, 2)):
        stays = all(np.abs(np.linalg.matrix_power(A, k) @ x).max() <= 1 for k in range(40))
        assert piece.region.contains(x, 1e-9) == stays


def test_feasible_states_are_those_of_the_controller(switched):
    limits = hys.Limits(x={"p": (-2, 2), "v": (-1, 1)})
    mpc = hys.HybridMpc(switched, horizon=3, cost=hys.Cost(x={"p": 1, "v": 1}, u={"u": 0.1}, norm=1), limits=limits)
    found = hys.feasible_states(switched, 3, within={"p": (-2, 2), "v": (-1, 1)})
    rng = np.random.default_rng(2)
    seen = set()
    for x in rng.uniform(-4, 4, (25, 2)):
        feasible = mpc.solve(x).u is not None
        seen.add(feasible)
        assert found.contains(x, 1e-6) == feasible
    assert seen == {True, False}


def test_rounds_that_do_not_suffice_are_told(switched):
    found = hys.invariant_set(switched, {"p": (-2, 2), "v": (-2, 2)}, rounds=1)
    assert not found.is_invariant
    assert found.rounds == 1


def test_wrong_arguments(switched):
    with pytest.raises(ArgumentError, match="rounds"):
        hys.invariant_set(switched, rounds=0)
    with pytest.raises(ArgumentError, match="steps"):
        hys.feasible_states(switched, -1)
    with pytest.raises(ArgumentError, match="there is no q"):
        hys.invariant_set(switched, {"q": 1})
    with pytest.raises(ArgumentError, match="Model or Pwa"):
        hys.invariant_set(switched.mld)


def test_output_limits_are_those_of_states_behind_them():
    text = SWITCHED.replace("INPUT { REAL u [-1, 1]; }", "INPUT { REAL u [-1, 1]; } OUTPUT { REAL y; }")
    model = hys.load(text.replace("v = v + gain + u; }", "v = v + gain + u; } OUTPUT { y = p + 0.1; }"))
    found = hys.feasible_states(model, 3, outputs={"y": (-0.9, 1.1)})
    # The limit holds for the first state too, and not for the last one.
    longer, shorter = (hys.feasible_states(model, steps, within={"p": (-1, 1)}) for steps in (3, 2))
    draw = np.random.default_rng(4)
    for x in draw.uniform(-1.5, 1.5, (300, 2)):
        if found.contains(x):
            assert abs(x[0]) <= 1 + 1e-9
            assert shorter.contains(x, 1e-9)
        elif abs(x[0]) <= 1:
            assert not longer.contains(x)


def test_output_limits_with_booleans():
    text = """SYSTEM s { INTERFACE { STATE { REAL p [-4, 4]; BOOL b; } OUTPUT { REAL y; } } IMPLEMENTATION {
      AUX { REAL z; } DA { z = {IF b THEN p ELSE -p}; } CONTINUOUS { p = z; } AUTOMATA { b = b; }
      OUTPUT { y = p + 2*(REAL b); } } }"""
    found = hys.feasible_states(hys.load(text), 1, outputs={"y": (0, 3)})
    assert found.contains([1.0, 1])
    assert not found.contains([1.5, 1])
    assert found.contains([1.5, 0])
    assert not found.contains([-0.5, 0])
    with pytest.raises(ArgumentError, match="there is no w"):
        hys.feasible_states(hys.load(text), 1, outputs={"w": (0, 3)})


def test_many_pieces_are_not_replaced_by_a_box():
    """Eight switches lead from 256 intervals into one; a box around them would hold states that do not get there."""
    switches = "".join(f" BOOL b{i};" for i in range(8))
    steps = " ".join(f"- {4 * 2**i}*(REAL b{i})" for i in range(8))
    model = hys.load(
        f"SYSTEM s {{ INTERFACE {{ STATE {{ REAL x [0, 2000]; }} INPUT {{{switches} }} }}"
        f" IMPLEMENTATION {{ CONTINUOUS {{ x = x {steps}; }} }} }}"
    )
    found = hys.feasible_states(model, 1, terminal={"x": (0, 1)})
    assert len(found.pieces) == 256
    assert found.contains([4.5])
    assert not found.contains([2.5])
