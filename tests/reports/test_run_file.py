"""Runs come back from the files that the commands write."""

import json

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.errors import ArgumentError
from hysdel_py.reports.run_file import read_run, recorded

TANK = """SYSTEM tank {
  INTERFACE {
    STATE { REAL level [-9, 9]; /* [m] level */ BOOL was; }
    INPUT { REAL flow [-1, 1]; BOOL open; }
    OUTPUT { REAL level_y; }
  }
  IMPLEMENTATION {
    AUX { REAL z; BOOL high; }
    AD { high = level >= 1; }
    DA { z = {IF open THEN flow ELSE 0}; }
    CONTINUOUS { level = level + z; }
    AUTOMATA { was = open; }
    OUTPUT { level_y = level; }
  }
}"""


@pytest.fixture(scope="module")
def model():
    return hys.load(TANK)


@pytest.fixture(scope="module")
def trajectory(model):
    rng = np.random.default_rng(3)
    return model.simulate([0.5, 0], np.column_stack([rng.uniform(-1, 1, 9), rng.integers(2, size=9)]), ts=0.5)


def variables(model):
    return {key: getattr(model.mld, key) for key in ("x", "u", "y", "d", "z")}


def test_from_json_a_run_comes_back_whole(tmp_path, model, trajectory):
    path = tmp_path / "run.json"
    path.write_text(json.dumps(trajectory.to_dict() | {"messages": ["a word"], "info": {"cost": [None] * 9}}))
    run, same = read_run(path, variables(model)), recorded(trajectory)
    assert run.t.tolist() == same.t.tolist()
    assert run.messages == ("a word",)
    for ours, theirs in zip(run.group("x", "u", "y", "d", "z"), same.signals, strict=True):
        assert (ours.name, ours.group, ours.unit, ours.is_bool) == (
            theirs.name,
            theirs.group,
            theirs.unit,
            theirs.is_bool,
        )
        assert ours.values.tolist() == theirs.values.tolist()
    assert np.isnan(run.group("info")[0].values).all()


def test_a_table_holds_the_steps(tmp_path, model, trajectory):
    path = tmp_path / "run.csv"
    path.write_text(trajectory.to_csv())
    run = read_run(path, variables(model))
    assert [(s.name, s.group) for s in run.signals] == [
        ("level", "x"), ("was", "x"), ("flow", "u"), ("open", "u"), ("level_y", "y"), ("high", "d"), ("z", "z"),
    ]  # fmt: skip
    assert run.signals[0].values == pytest.approx(trajectory["level"][:-1], abs=1e-11)
    assert run.signals[0].unit == "m"


def test_names_that_two_vectors_share(tmp_path):
    model = hys.load("SYSTEM s { INTERFACE { STATE { REAL a [0, 9]; } OUTPUT { REAL b; } } "
                     "IMPLEMENTATION { CONTINUOUS { a = a; } OUTPUT { b = a; } } }")  # fmt: skip
    path = tmp_path / "run.csv"
    path.write_text("t,x.a,y.b,info.t,odd.name\n0,1,2,3,4\n1,1,2,3,4\n")
    found = [(s.name, s.group) for s in read_run(path, variables(model)).signals]
    assert found == [("a", "x"), ("b", "y"), ("t", "info"), ("odd.name", "info")]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no column t"),
        ("a,b\n1,2\n", "no column t"),
        ("t,level\n1,2,3\n", "each line should have 2 values"),
        ("t,level\n1,high\n", "is no run"),
        ("{", "is no run"),
        ('{"error": "no"}', "is no run"),
        ('{"t": [0, 1], "names": {"x": ["level"]}, "x": [[1], [2], [3], [4]], "info": {}, "messages": []}', "4 values"),
        ("t,speed\n0,1\n", "of another model: it has speed"),
    ],
)
def test_what_is_no_run(tmp_path, model, text, words):
    path = tmp_path / "run"
    path.write_text(text)
    with pytest.raises(ArgumentError, match=words):
        read_run(path, variables(model))
