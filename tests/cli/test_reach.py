"""``hysdel reach`` and ``hysdel safety``."""

import pytest


def test_sets_and_unsafe(hysdel):
    found = hysdel("reach", "tank.hys", "--x0", "level=0:1,was_open=0", "--steps", 3, "--unsafe", "level >= 5")
    assert found.status == 0
    assert "the states themselves after k steps" in found.out
    assert "-3 .. 4" in found.out
    assert "unreachable" in found.out
    found = hysdel("reach", "tank.hys", "--x0", "level=0:1,was_open=0", "--steps", 3, "--unsafe", "level >= 3.5")
    assert found.status == 1
    assert "reachable: this run meets it at step 3" in found.out


def test_sets_as_data(hysdel):
    found = hysdel("reach", "tank.hys", "--x0", "level=0:1,was_open=0", "--steps", 2, "--sets", "boxes", "--json")
    assert found.status == 0
    data = found.json
    assert data["is_exact"] is False
    assert len(data["sets"]) == 3
    assert data["sets"][0][0]["booleans"] == [0]


def test_backward(hysdel):
    found = hysdel("reach", "tank.hys", "--x0", "level=5", "--steps", 2, "--backward")
    assert found.status == 0
    assert "steps before the target" in found.out
    assert "3 .. 7" in found.out


def test_picture(hysdel, tmp_path):
    picture = tmp_path / "sets.png"
    assert hysdel("reach", "tank.hys", "--x0", "level=0:1", "--steps", 2, "--plot", picture).status == 0
    assert picture.stat().st_size > 1000


@pytest.mark.parametrize(
    ("statement", "status", "words"),
    [
        (("--never", "level >= 5"), 0, "unreachable"),
        (("--never", "level >= 3"), 1, "reachable: this run"),
        (("--always", "level <= 4.5"), 0, "unreachable"),
        (("--always", "y <= 2"), 1, "reachable"),
        (("--eventually", "level >= 3"), 1, "avoidable: this run of 3 steps"),
        (("--eventually", "level <= 1"), 0, "inevitable: every run meets it within 1 steps"),
    ],
)
def test_statements(hysdel, statement, status, words):
    found = hysdel("safety", "tank.hys", "--x0", "level=0:1,was_open=0", "--steps", 3, *statement)
    assert found.status == status
    assert words in found.out


def test_inputs_are_narrowed_and_runs_written(hysdel, tmp_path):
    common = ("safety", "tank.hys", "--x0", "level=0", "--steps", 3, "--never", "level >= 2")
    assert hysdel(*common, "--input", "flow=-1:0.5").status == 0
    table = tmp_path / "run.csv"
    found = hysdel(*common, "--csv", table, "--json")
    assert found.status == 1
    assert found.json["time"] == 2
    assert "level" in table.read_text()


def test_not_settled(hysdel):
    found = hysdel("safety", "tank.hys", "--x0", "level=0", "--steps", 3, "--never", "level >= 9", "--seconds", 1e-9)
    assert found.status == 4
    assert "not settled" in found.out


@pytest.mark.parametrize(
    "arguments",
    [
        ("safety", "tank.hys", "--steps", 3),
        ("safety", "tank.hys", "--steps", 3, "--never", "level >="),
        ("safety", "tank.hys", "--steps", 3, "--never", "depth >= 1"),
        ("safety", "tank.hys", "--x0", "level", "--steps", 3, "--never", "level >= 1"),
        ("reach", "tank.hys", "--x0", "level=2:1", "--steps", 3),
        ("reach", "tank.hys", "--x0", "level=0", "--steps", -1),
        ("reach", "tank.hys", "--x0", "level=0", "--steps", 1, "--backward", "--unsafe", "level >= 1"),
        ("reach", "tank.hys", "--x0", "level=0", "--steps", 1, "--plot", "sets.txt"),
    ],
)
def test_wrong_usage(hysdel, arguments):
    assert hysdel(*arguments).status == 2


QUERIES = "QUERIES { NEVER level >= 5 WITHIN 3 FROM level <= 1; EVENTUALLY level >= 3 WITHIN 3; } } }"


def test_queries_of_a_model(hysdel, tmp_path):
    text = (tmp_path / "tank.hys").read_text().rstrip().removesuffix("}").rstrip().removesuffix("}")
    (tmp_path / "asked.hys").write_text("/* extension: queries */\n" + text + QUERIES)
    found = hysdel("safety", "asked.hys")
    assert found.status == 1
    assert "holds: NEVER level >= 5 WITHIN 3 FROM level <= 1" in found.out
    assert "violated: EVENTUALLY level >= 3 WITHIN 3" in found.out
    data = hysdel("safety", "asked.hys", "--json").json
    assert [entry["verdict"] for entry in data] == ["holds", "violated"]
    refused = hysdel("safety", "asked.hys", "--steps", 3)
    assert refused.status == 2
    assert "a query says it itself" in refused.err


def test_safety_without_a_question(hysdel):
    found = hysdel("safety", "tank.hys")
    assert found.status == 2
    assert "has no QUERIES" in found.err
    assert "--steps is missing" in hysdel("safety", "tank.hys", "--never", "level >= 1").err


def test_observe(hysdel):
    found = hysdel("observe", "tank.hys", "--steps", 2)
    assert found.status == 1
    assert "indistinguishable" in found.out  # nobody sees whether the valve was open
    assert hysdel("observe", "tank.hys", "--steps", 2, "--of", "level").status == 0
    assert (
        hysdel("observe", "tank.hys", "--steps", 2, "--of", "was_open", "--json").json["verdict"] == "indistinguishable"
    )
    assert "names of states" in hysdel("observe", "tank.hys", "--steps", 2, "--of", "flow").err
