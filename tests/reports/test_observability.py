"""Observability against linear programs over differences of states, and hybrid cases that can be followed by hand."""

import numpy as np
import pytest
from scipy.optimize import linprog

import hysdel_py as hys
from hysdel_py.errors import ArgumentError

SWITCHED = """SYSTEM switched {
  INTERFACE { STATE { REAL x [-1, 1]; BOOL b; } INPUT { REAL u [-1, 1]; } OUTPUT { REAL y; } }
  IMPLEMENTATION {
    AUX { BOOL up; REAL z; }
    AD { up = x >= 0; }
    DA { z = {IF b THEN 0.5*x ELSE -0.5*x}; }
    CONTINUOUS { x = 0.2*x + 0.1*u; }
    AUTOMATA { b = b; }
    OUTPUT { y = z; }
  }
}
"""


def linear_text(A, C):
    names = ["p", "q"]

    def row(r):
        return " + ".join(f"({c!r})*{n}" for c, n in zip(map(float, r), names, strict=True))

    updates = " ".join(f"{n} = {row(r)};" for n, r in zip(names, A, strict=True))
    return (
        "SYSTEM l { INTERFACE { STATE { REAL p [-1, 1]; REAL q [-1, 1]; } OUTPUT { REAL y; } }"
        f" IMPLEMENTATION {{ CONTINUOUS {{ {updates} }} OUTPUT {{ y = {row(C)}; }} }} }}"
    )


def hidden_by_programs(A, C, steps, apart, resolution):
    """Whether a difference of two states stays below the resolution: two linear programs for each state."""
    rows = np.array([C @ np.linalg.matrix_power(A, k) for k in range(steps)])
    answers = [
        linprog(-sign * np.eye(2)[i], np.vstack([rows, -rows]), np.full(2 * steps, resolution), bounds=(-2, 2))
        for i in range(2) for sign in (1, -1)
    ]  # fmt: skip
    return max(-a.fun for a in answers), apart


@pytest.mark.parametrize("seed", range(6))
def test_linear_systems_agree_with_linear_programs(seed):
    draw = np.random.default_rng(seed)
    A, C = draw.uniform(-0.45, 0.45, (2, 2)).round(2), draw.uniform(-1, 1, 2).round(2)
    for steps in (1, 3):
        width = 2 * np.abs(C).sum()
        largest, _ = hidden_by_programs(A, C, steps, 0.1, 0.01 * width)
        for share in (0.9, 1.1):
            if largest * share >= 2:
                continue
            answer = hys.observability(hys.load(linear_text(A, C)), steps, apart=largest * share / 2, resolution=0.01)
            assert answer.verdict == ("indistinguishable" if share < 1 else "observable"), (seed, steps, share)


def test_witness_is_a_pair_of_runs_with_the_same_outputs():
    model = hys.load(SWITCHED)
    answer = hys.observability(model, 3)
    assert answer.verdict == "indistinguishable"  # x with b, and -x without
    first, second = answer.first, answer.second
    assert np.array_equal(first.u, second.u)
    assert np.abs(first.y - second.y).max() <= answer.resolution["y"] + 1e-9
    assert first.x[0, 1] != second.x[0, 1] or abs(first.x[0, 0] - second.x[0, 0]) >= 0.1 - 1e-9
    for run in (first, second):
        assert np.allclose(model.simulate(run.x[0], run.u).x, run.x)
    assert "x | x" in str(answer)


def test_what_is_known_of_the_start_and_the_inputs_helps():
    model = hys.load(SWITCHED)
    assert hys.observability(model, 2, x0={"b": 1}).verdict == "observable"
    assert hys.observability(model, 2, x0={"x": (0.2, 1)}, of="b").verdict == "observable"
    # With a large input the sign of the second state is known, whatever the first one was.
    assert hys.observability(model, 2, inputs={"u": 1}, x0={"x": (-0.1, 0.1)}, of="b").verdict == "observable"
    assert hys.observability(model, 1, inputs={"u": 1}, x0={"x": (-0.1, 0.1)}, of="b").verdict == "indistinguishable"


def test_modes():
    model = hys.load(SWITCHED)
    assert hys.observability(model, 2, of="modes").verdict == "indistinguishable"
    assert (
        hys.observability(model, 2, of=["up"], x0={"b": 1, "x": (-1, 1)}, resolution=1e-3).verdict
        == "indistinguishable"
    )
    blind = hys.observability(model, 2, of="up", x0={"b": 1, "x": (0.1, 1)})
    assert blind.verdict == "observable"


def test_no_run():
    text = SWITCHED.replace("OUTPUT { y = z; }", "OUTPUT { y = z; } MUST { x >= 0.5; }")
    assert hys.observability(hys.load(text), 3).verdict == "no run"


def test_wrong_arguments():
    model = hys.load(SWITCHED)
    for words, given in (
        ("names of states", {"of": "z"}),
        ("positive distance", {"apart": 0}),
        ("a distance for each of x", {"apart": {"b": 1}}),
        ("at least 1", {"steps": 0}),
        ("a number was expected", {"apart": "far"}),
        ("a number was expected", {"resolution": {"y": None}}),
        ("names of states", {"of": 5}),
        ("x0: expected names", {"x0": "x >= 0"}),
        ("a positive number", {"seconds": "3"}),
    ):
        with pytest.raises(ArgumentError, match=words):
            hys.observability(model, **({"steps": 2} | given))
    with pytest.raises(ArgumentError, match="no outputs"):
        hys.observability(hys.load(SWITCHED.replace("OUTPUT { REAL y; }", "").replace("OUTPUT { y = z; }", "")), 2)
