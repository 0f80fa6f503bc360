"""The explanation in the words of the source, from a model and from a controller."""

import json

import pytest
from golden_explanations import GOLDEN, TANK, explanation_texts

import hysdel_py as hys
from hysdel_py.reports.demands import comparison
from hysdel_py.reports.parts import steps_text
from hysdel_py.reports.remedies import outwards


@pytest.fixture(scope="module")
def tank():
    return hys.load(TANK)


def test_text():
    assert explanation_texts() == GOLDEN.read_text(encoding="utf-8")


def test_controller_brings_its_limits(tank):
    mpc = hys.HybridMpc(tank, 4, hys.Cost(y={"y": 1.0}), hys.Limits(y={"y": (None, 5.0)}))
    move = mpc.solve([7.0, 0])
    assert not move.ok
    assert "hys.explain_infeasible(controller, x)" in move.message
    explanation = hys.explain_infeasible(mpc, [7.0, 0])
    assert explanation.verdict == "smallest"
    assert [part.text for part in explanation.parts if part.kind == "limit"] == ["y <= 5"]
    assert explanation.parts[1].steps == (1,)  # no input moves y(0), so the controller leaves its limit out
    assert hys.explain_infeasible(mpc, [5.0, 0]).feasible == mpc.solve([5.0, 0]).ok is True


def test_soft_limits_and_declared_auxiliaries_of_a_controller():
    text = TANK.replace("REAL out;", "REAL out [0, 0.3];")
    mpc = hys.HybridMpc(hys.load(text), 2, hys.Cost(y={"y": 1.0}), hys.Limits(y={"y": (None, 5.0)}, soft=True))
    explanation = hys.explain_infeasible(mpc, [7.0, 0], inputs={"open": 1})
    assert [part.text for part in explanation.parts if part.kind == "range"] == ["out <= 0.3"]
    assert hys.explain_infeasible(mpc, [7.0, 0]).feasible
    assert hys.explain_infeasible(hys.load(text), [7.0, 0], 2, inputs={"open": 1}).feasible


def test_terminal_polytope(tank):
    limits = hys.Limits(terminal=([[-1.0, 0.0]], [-9.9]))
    explanation = hys.explain_infeasible(tank, [5.0, 0], 3, limits=limits)
    assert [(p.text, p.steps) for p in explanation.parts if p.kind == "limit"] == [("level >= 9.9", (3,))]
    assert any("limit: level >= 7.25 instead" in line for line in explanation.remedies)


def test_data(tank):
    explanation = hys.explain_infeasible(tank, [10.5, 0], 1)
    data = json.loads(json.dumps(explanation.to_dict()))
    assert data["verdict"] == "smallest"
    assert data["contradiction"][0] == {"kind": "x(0)", "text": "level = 10.5", "steps": [0]}
    assert data["contradiction"][1]["line"] in (3, 16)
    assert hys.explain_infeasible(tank, [1.0, 0], 1).to_dict()["run"]["x"][0] == [1.0, 0.0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"horizon": 0}, "whole number of at least 1"),
        ({"horizon": None}, "horizon is missing"),
        ({"horizon": 10**7}, "rows would be needed"),
        ({"seconds": 0}, "a positive number"),
        ({"inputs": {"flw": 1}}, "no input named flw: the inputs are flow, open"),
        ({"inputs": [1.0]}, "inputs has shape"),
        ({"inputs": {"flow": [1.0, 2.0]}}, "input flow has shape"),
        ({"inputs": {"open": 0.5}}, "it is Boolean"),
        ({"limits": {"y": 1}}, "Limits was expected"),
        ({"x0": [1.0]}, "state has shape"),
    ],
)
def test_wrong_arguments(tank, change, message):
    arguments = {"x0": [1.0, 0], "horizon": 3} | change
    with pytest.raises(hys.ArgumentError, match=message):
        hys.explain_infeasible(tank, **arguments)


def test_wrong_subjects(tank):
    cost = hys.Cost(y={"y": 1.0})
    with pytest.raises(hys.ArgumentError, match="build it from a Model"):
        hys.explain_infeasible(hys.HybridMpc(tank.mld, 2, cost), [1.0, 0])
    with pytest.raises(hys.ArgumentError, match="has its own"):
        hys.explain_infeasible(hys.HybridMpc(tank, 2, cost), [1.0, 0], limits=hys.Limits())
    with pytest.raises(hys.ArgumentError, match="a Mld was given"):
        hys.explain_infeasible(tank.mld, [1.0, 0], 2)


def test_undefined_auxiliary():
    model = hys.load(TANK.replace("AD { high = level >= 8; }", ""))
    with pytest.raises(hys.SimulationError, match="high is used but never defined"):
        hys.explain_infeasible(model, [1.0, 0], 2)


def test_a_missing_range_is_an_argument_error():
    model = hys.load(TANK.replace("level [0, 10]", "level"))
    with pytest.raises(hys.ArgumentError, match="level has no finite range, which the definition of high needs"):
        hys.explain_infeasible(model, [1.0, 0], 2)


def test_a_strict_requirement_on_the_end_of_a_range():
    model = hys.load(
        "SYSTEM m { INTERFACE { INPUT { REAL u [-1,1]; } STATE { BOOL b; } }"
        " IMPLEMENTATION { AUTOMATA { b = b; } MUST { u > 1; } } }"
    )
    explanation = hys.explain_infeasible(model, [0], 1)
    assert explanation.verdict == "smallest"
    assert explanation.finding.borderline
    assert [(part.kind, part.text) for part in explanation.parts] == [("MUST", "u > 1"), ("range", "u <= 1")]
    assert "borderline: it would be enough if each gave by 1e-06" in str(explanation)


def test_small_words():
    assert steps_text([3, 4, 5, 9, 0]) == "k = 0, 3..5, 9"
    assert comparison((("a", -1.0), ("b", -2.0)), float("-inf"), -3.0) == "a + 2*b >= 3"
    assert outwards(0.83000000001, up=True) == "0.83"
    assert outwards(0.8300001, up=True) == "0.830001"
    assert outwards(0.8300009, up=False) == "0.83"
    assert outwards(0.0, up=True) == "0"
