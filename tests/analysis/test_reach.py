"""Reachable sets against random runs, against each other, and against closed forms."""

import numpy as np
import pytest
from scipy.linalg import expm

import hysdel_py as hys
from hysdel_py.analysis.hybrid_set import Piece, hybrid_set
from hysdel_py.analysis.reach import reach, reach_backward
from hysdel_py.analysis.replacement import box_around, empty_share
from hysdel_py.errors import ArgumentError, SimulationError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.geometry.relations import are_equal

TWO_ROOMS_LIKE = """
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


@pytest.fixture(scope="module")
def relay():
    return hys.load(TWO_ROOMS_LIKE).pwa


def start(rng, given, variables):
    return [rng.uniform(*np.broadcast_to(given.get(v.name, (v.low, v.high)), 2)) for v in variables]


@pytest.mark.parametrize("sets", ["exact", "boxes", "octagons"])
def test_random_runs_stay_in_the_sets(relay, sets):
    rng = np.random.default_rng(1)
    found = reach(relay, {"T": (15, 20), "on": 0}, 8, sets=sets)
    assert found.is_complete
    assert found.is_exact == (sets == "exact")
    for _ in range(60):
        x = np.array([rng.uniform(15, 20), 0.0])
        for k in range(9):
            assert found.sets[k].contains(x, 1e-7)
            x = relay.step(x, [rng.uniform(-1, 1)])[0]


def test_exact_sets_hold_nothing_that_is_not_reached(relay):
    """Every vertex of the last sets is reached by inputs at the ends of their range."""
    found = reach(relay, {"T": 17, "on": 1}, 4)
    ends = set()
    for word in np.ndindex(2, 2, 2, 2):
        x = np.array([17.0, 1.0])
        for bit in word:
            x = relay.step(x, [2.0 * bit - 1])[0]
        ends.add(round(float(x[0]), 6))
    low, high = found.sets[-1].ranges()["T"]
    assert low == pytest.approx(min(ends), abs=1e-5)
    assert high == pytest.approx(max(ends), abs=1e-5)


def test_relay_settles_and_never_leaves_its_band(relay):
    found = reach(relay, {"T": (18, 22), "on": 0}, 14)
    assert found.settled_at is not None
    low, high = found.union.ranges()["T"]
    assert low == pytest.approx(0.9 * (0.9 * 18 - 1) - 1, abs=1e-5)  # the switch acts one step late
    assert high == pytest.approx(0.9 * (0.9 * 22 + 4) + 4, abs=1e-5)
    assert found.first_meeting({"T": (40, 60)}) is None
    assert found.first_meeting({"T": (18.5, 19), "on": 1}) is not None


def test_backward_and_forward_agree(relay):
    rng = np.random.default_rng(2)
    target = {"T": (21, 21.5), "on": 1}
    back = reach_backward(relay, target, 3)
    for _ in range(12):
        x = {"T": rng.uniform(12, 24), "on": float(rng.integers(2))}
        forth = reach(relay, x, 3)
        meets = forth.sets[3].meets(hybrid_set(target, relay.x, "target")) is not None
        assert meets == back.sets[3].contains(x)


def test_linear_system_has_the_sets_of_its_exponential():
    A = expm(np.array([[0.0, 1.0], [-1.0, -0.2]]) * 0.3)
    p, v = (f"{row[0]:.17g}*p + {row[1]:.17g}*v" for row in A)
    text = f"""SYSTEM s {{ INTERFACE {{ STATE {{ REAL p [-50, 50]; REAL v [-50, 50]; }} }}
    IMPLEMENTATION {{ CONTINUOUS {{ p = {p}; v = {v}; }} }} }}"""
    found = reach(hys.load(text).pwa, {"p": (1, 2), "v": (-1, 1)}, 5)
    expected = Polyhedron.box([1, -1], [2, 1]).image(np.linalg.matrix_power(A, 5))
    assert len(found.sets[5].pieces) == 1
    assert are_equal(found.sets[5].pieces[0].region, expected, 1e-7)


def test_branches_meet_at_their_threshold(relay):
    """The gap of a threshold is the false side's alone: no state far from the true side takes its branch."""
    at = 18.0  # cold = T <= 18
    for offset in (-5e-7, 0.0, 5e-7):
        found = reach(relay, {"T": at + offset, "on": 1}, 1, inputs={"w": 0})
        words = {piece.word for piece in found.sets[1].pieces}
        assert (True,) in words
        assert relay.locate([at + offset, 1.0], [0.0]) is not None or offset > 0
    above = reach(relay, {"T": at + 5e-7, "on": 0}, 1, inputs={"w": 0})
    assert {piece.word for piece in above.sets[1].pieces} == {(False,)}


def test_modes_lead_to_a_piece(relay):
    found = reach(relay, {"T": 17, "on": 0}, 3, merge=False)
    x, modes = np.array([17.0, 0.0]), []
    for _ in range(3):
        x, _, mode = relay.step(x, [0.0])
        modes.append(mode)
    numbers = [i for i, p in enumerate(found.sets[3].pieces) if p.region.contains(x[:1]) and p.word == (bool(x[1]),)]
    assert tuple(modes) in {found.modes_to(3, i) for i in numbers}


def test_too_many_pieces_become_one_enclosure(relay):
    whole = reach(relay, {"T": (10, 30)}, 6, merge=False)
    few = reach(relay, {"T": (10, 30)}, 6, merge=False, most=2)
    assert whole.is_exact
    assert not few.is_exact
    assert all(len(states.pieces) <= 4 for states in few.sets[1:])
    assert few.sets[6].covers(whole.sets[6])
    assert not any(whole.losses)
    assert len(few.losses) == 7


def test_loss_of_a_box_is_its_empty_share():
    corners = [Piece((), Polyhedron.box([x, x], [x + 1, x + 1])) for x in (0.0, 3.0)]
    box = box_around(corners)
    assert np.allclose(box.bounding_box, [[0, 0], [4, 4]], atol=1e-6)
    assert empty_share(box, corners) == pytest.approx(1 - 2 / 16, abs=0.01)
    assert empty_share(box, [Piece((), box)]) == 0.0


def test_interrupt_gives_the_sets_so_far(relay):
    def stop(k, _):
        if k == 3:
            raise KeyboardInterrupt

    found = reach(relay, {"T": 17, "on": 0}, 10, progress=stop)
    assert not found.is_complete
    assert len(found.sets) == 4


def test_states_without_successor_end(relay):
    found = reach(relay, {"T": (59, 60), "on": 1}, 2, inputs={"w": 1})
    with pytest.raises(SimulationError):
        relay.step([70.0, 1.0], [1.0])
    assert not found.sets[1].is_empty


def test_set_operations(relay):
    whole, part = (hybrid_set(g, relay.x, "x0") for g in ({"T": (0, 10)}, {"T": (2, 3), "on": 1}))
    assert len(whole.pieces) == 2
    assert whole.covers(part)
    assert not part.covers(whole)
    left = whole.minus(part)
    assert not left.contains([2.5, 1.0])
    assert left.contains([2.5, 0.0])
    assert (left & part).ranges() == {} or (left & part).pieces[0].region.is_flat
    assert isinstance((whole | part).pieces[-1], Piece)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"x0": {"S": 1}}, "there is no S"),
        ({"x0": {"T": (2, 1)}}, "holds no number"),
        ({"x0": {"T": "warm"}}, "must be a number"),
        ({"x0": Polyhedron.box([0], [1])}, "2 states"),
        ({"x0": 3}, "expected names"),
        ({"x0": {}, "sets": "spheres"}, "octagons"),
        ({"x0": {}, "sets": np.eye(2)}, "shape"),
        ({"x0": {}, "inputs": {"v": 0}}, "there is no v"),
        ({"x0": {}, "steps": -1}, "at least 0"),
    ],
)
def test_wrong_arguments(relay, wrong, words):
    with pytest.raises(ArgumentError, match=words):
        reach(relay, wrong["x0"], wrong.get("steps", 1), **{k: v for k, v in wrong.items() if k not in {"x0", "steps"}})
