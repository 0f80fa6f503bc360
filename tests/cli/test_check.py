"""``hysdel check``: sizes, warnings, mistakes, missing parameters."""

import pytest

SIZES = {"nx": 2, "nu": 2, "ny": 1, "nd": 0, "nz": 1, "ne": 4}


def test_sound_model(hysdel):
    shown = hysdel("check", "tank.hys")
    expected = "tank.hys: no mistakes found; 2 states, 2 inputs, 1 outputs, 0 Boolean and 1 real auxiliaries, 4 rows\n"
    assert (shown.status, shown.out, shown.err) == (0, expected, "")


def test_sizes_as_json(hysdel):
    data = hysdel("check", "tank.hys", "--json").json
    assert data == {"name": "tank", "file": "tank.hys", "missing_parameters": [], **SIZES, "diagnostics": []}


def test_parameters_in_one_option_and_in_several(hysdel):
    assert hysdel("check", "tank.hys", "--param", "gain=2", "--param", "ts=-1").status == 0
    assert hysdel("check", "tank.hys", "--param", "gain=2, ts=1").status == 0


@pytest.fixture
def without_value(tmp_path):
    path = tmp_path / "open.hys"
    path.write_text((tmp_path / "tank.hys").read_text().replace("gain = 1", "gain"), encoding="utf-8")
    return path


def test_missing_parameter_does_not_fail(hysdel, without_value):
    shown = hysdel("check", without_value)
    assert shown.status == 0
    assert "no mistakes found; parameters without a value: gain" in shown.out
    data = hysdel("check", without_value, "--json").json
    assert data["missing_parameters"] == ["gain"]
    assert "ne" not in data
    assert hysdel("check", without_value, "--param", "gain=3", "--json").json["ne"] == 4


def test_missing_parameter_fails_where_it_is_needed(hysdel, without_value):
    shown = hysdel("compile", without_value)
    assert shown.status == 1
    assert "gain" in shown.err


def test_mistakes_are_shown_with_their_place(hysdel, tmp_path):
    path = tmp_path / "bad.hys"
    path.write_text((tmp_path / "tank.hys").read_text().replace("level + inflow", "level + infow"), encoding="utf-8")
    shown = hysdel("check", path)
    assert shown.status == 1
    assert "error[HYS" in shown.err
    assert "--> bad.hys:12:34" in shown.err
    assert "^^^^^" in shown.err
    data = hysdel("check", path, "--json")
    assert data.status == 1
    found = data.json["diagnostics"][0]
    assert (found["severity"], found["file"], found["line"], found["column"]) == ("error", "bad.hys", 12, 34)


def test_warnings_are_counted_and_do_not_fail(hysdel, tmp_path):
    path = tmp_path / "idle.hys"
    path.write_text((tmp_path / "tank.hys").read_text().replace("REAL inflow;", "REAL inflow, idle;"), encoding="utf-8")
    shown = hysdel("check", path)
    assert shown.status == 0
    assert "no mistakes found, 1 warning;" in shown.out
    assert shown.err.startswith("warning[HYS")
    assert "idle" in shown.err


@pytest.fixture
def folder(tmp_path):
    """A good file, one with a warning, one with an error, one with a note."""
    tank = (tmp_path / "tank.hys").read_text(encoding="utf-8")
    for name, old, new in (
        ("idle.hys", "REAL inflow;", "REAL inflow, idle;"),
        ("bad.hys", "gain*flow", "gain*flow*level"),
        ("spare.hys", "gain = 1", "gain = 1, spare = 2"),
    ):
        (tmp_path / name).write_text(tank.replace(old, new), encoding="utf-8")
    return tmp_path


def test_several_files(hysdel, folder):
    shown = hysdel("check", "tank.hys", "idle.hys", "bad.hys")
    assert shown.status == 1
    lines = shown.out.splitlines()
    assert [line.split(":")[0] for line in lines] == ["tank.hys", "idle.hys", "bad.hys"]
    assert lines[2] == "bad.hys: 1 mistake found"
    assert "warning[HYS502]" in shown.err
    assert "error[HYS302]" in shown.err
    assert hysdel("check", "tank.hys", "idle.hys").status == 0
    data = hysdel("check", "tank.hys", "bad.hys", "--format", "json").json
    assert [len(entry["diagnostics"]) for entry in data] == [0, 1]
    assert "error" in data[1]


def test_strict_makes_warnings_fail(hysdel, folder):
    assert hysdel("check", "idle.hys").status == 0
    assert hysdel("check", "idle.hys", "--strict").status == 1
    assert hysdel("check", "tank.hys", "--strict").status == 0
    assert hysdel("check", "idle.hys", "--strict", "--ignore", "HYS501,HYS502").status == 0


def test_notes_become_warnings(hysdel, folder):
    assert hysdel("check", "spare.hys", "--strict").status == 0
    shown = hysdel("check", "spare.hys", "-W", "525")
    assert shown.status == 0
    assert shown.err.startswith("warning[HYS525]: the parameter spare is never used")
    assert "1 warning" in shown.out
    assert hysdel("check", "spare.hys", "-W", "HYS525", "--strict").status == 1


def test_errors_cannot_be_ignored(hysdel, folder):
    assert hysdel("check", "bad.hys", "--ignore", "HYS302").status == 1


def test_unknown_code_is_wrong_usage(hysdel, folder):
    shown = hysdel("check", "tank.hys", "--ignore", "HYS5O2")
    assert shown.status == 2
    assert "did you mean" in shown.err


def test_sarif(hysdel, folder):
    shown = hysdel("check", "idle.hys", "bad.hys", "--format", "sarif")
    assert shown.status == 1
    results = shown.json["runs"][0]["results"]
    assert {r["ruleId"] for r in results} == {"HYS302", "HYS502"}
    assert {r["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] for r in results} == {
        "idle.hys", "bad.hys",
    }  # fmt: skip


def test_missing_file_is_a_mistake(hysdel):
    shown = hysdel("check", "tank.hys", "nothing.hys")
    assert shown.status == 1
    assert "error[HYS001]" in shown.err


def test_a_mistake_in_a_module_is_shown_in_its_own_file(hysdel, tmp_path):
    (tmp_path / "drain.hys").write_text(
        "SYSTEM drain {\n  INTERFACE { STATE { REAL level [0, 1]; } }\n"
        "  IMPLEMENTATION { CONTINUOUS { level = k*level; } }\n}\n"
    )
    (tmp_path / "whole.hys").write_text("SYSTEM whole { INTERFACE { MODULE { drain d; } } IMPLEMENTATION { } }\n")
    outcome = hysdel("check", str(tmp_path / "whole.hys"))
    assert outcome.status == 1
    assert "d.k is not declared" in outcome.err
    assert "drain.hys:3:41" in outcome.err
