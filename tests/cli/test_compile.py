"""``hysdel compile``: the listing and the files."""

import json

import numpy as np
import pytest
from export.matlab_reader import read_matlab

import hysdel_py as hys
from hysdel_py.export.matrices import mld_to_dict
from hysdel_py.export.reading import read_mat


def test_listing_has_every_variable_equation_and_row(hysdel):
    lines = hysdel("compile", "tank.hys").out.splitlines()
    assert lines[0] == "tank: 2 states, 2 inputs, 1 outputs, 0 Boolean and 1 real auxiliaries, 4 rows"
    assert "  state    level [m] in [-5, 10]  level of the water" in lines
    assert "  input    open" in lines
    assert "  output   y [m]  what is measured" in lines
    assert "  level+ = level + inflow" in lines
    assert "  was_open+ = open" in lines
    assert "  y = level" in lines
    assert len(lines) - lines.index("rows") - 1 == 4
    assert all("[DA" in line and "line 11]" in line for line in lines[lines.index("rows") + 1 :])


def test_listing_tells_the_rows_as_they_are(hysdel):
    """``inflow - open <= 0`` and the like: M of flow in [-1, 1] is 1 on both sides."""
    rows = [line.split("    [")[0].strip() for line in hysdel("compile", "tank.hys").out.splitlines()[-4:]]
    assert set(rows) == {
        "inflow - open <= 0",
        "-inflow - open <= 0",
        "inflow - flow + open <= 1",
        "-inflow + flow + open <= 1",
    }


def test_json_file_and_json_on_the_screen_are_the_same(hysdel, tmp_path):
    shown = hysdel("compile", "tank.hys", "-o", "tank.json")
    assert (shown.status, shown.err) == (0, "")
    assert shown.out.startswith("tank.json: 2 states")
    data = json.loads((tmp_path / "tank.json").read_text(encoding="utf-8"))
    assert data == hysdel("compile", "tank.hys", "--json").json
    assert data == mld_to_dict(hys.load(tmp_path / "tank.hys").mld)


def test_npz_file(hysdel, tmp_path):
    assert hysdel("compile", "tank.hys", "--output", "tank.npz", "--param", "gain=3").status == 0
    mld = hys.load(tmp_path / "tank.hys", gain=3).mld
    with np.load(tmp_path / "tank.npz") as data:
        assert (data["E1"] == mld.E1.toarray()).all()
        assert data["names_u"].tolist() == ["flow", "open"]


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("tank.txt", "--output tank.txt: a name that ends in .json, .npz, .mat, .m, .py, .c or .fmu was expected"),
        ("tank", "a name that ends in .json, .npz, .mat, .m, .py, .c or .fmu was expected"),
        ("nowhere/tank.json", "--output nowhere/tank.json: there is no folder nowhere"),
        ("folder.json", "--output folder.json: this is a folder"),
    ],
)
def test_files_that_cannot_be_written(hysdel, tmp_path, path, words):
    (tmp_path / "folder.json").mkdir()
    shown = hysdel("compile", "tank.hys", "-o", path)
    assert shown.status == 2
    assert words in shown.err
    assert not (tmp_path / "tank.txt").exists()


def test_constant_terms_as_auxiliaries(hysdel, tmp_path):
    path = tmp_path / "leak.hys"
    path.write_text((tmp_path / "tank.hys").read_text().replace("level + inflow;", "level + inflow - 0.5;"))
    assert "level+ = level + inflow - 0.5" in hysdel("compile", path).out
    assert "0 Boolean and 2 real auxiliaries" in hysdel("compile", path, "--constants", "aux").out
    assert hysdel("compile", path, "--constants", "forbid").status == 1


def test_model_without_rows(hysdel, tmp_path):
    path = tmp_path / "free.hys"
    path.write_text("SYSTEM s { INTERFACE { STATE { REAL x [0, 1]; } } IMPLEMENTATION { CONTINUOUS { x = x; } } }")
    assert hysdel("compile", path).out.splitlines()[0].endswith("0 rows")


def test_files_for_other_programs(hysdel, tmp_path):
    mld = hys.load(tmp_path / "tank.hys").mld
    for name in ("tank.mat", "tank.m", "tank_step.py"):
        shown = hysdel("compile", "tank.hys", "-o", name)
        assert (shown.status, shown.err) == (0, "")
        assert shown.out.startswith(f"{name}: 2 states")
    assert (read_mat(tmp_path / "tank.mat").A == mld.A).all()
    assert (read_matlab((tmp_path / "tank.m").read_text())["E5"].ravel() == mld.E5).all()
    namespace = {}
    exec((tmp_path / "tank_step.py").read_text(), namespace)
    assert namespace["step"]([1, 0], [0.5, 1])[0] == [1.5, 1.0]


def test_rows_and_constants_by_option(hysdel, tmp_path):
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-1, 9]; BOOL b; } } IMPLEMENTATION { AUX { REAL z; REAL w; }
      DA { z = {IF (x <= 4) & b THEN x ELSE 0}; w = {IF (x <= 4) & b THEN 1 ELSE x}; } MUST { x <= 8; x <= 9; } } }"""
    (tmp_path / "s.hys").write_text(text, encoding="utf-8")

    def sizes(*options):
        data = hysdel("compile", tmp_path / "s.hys", "--json", *options).json
        return len(data["variables"]["d"]), len(data["E5"])

    d, rows = sizes()
    assert sizes("--big-m", "interval") == (d, rows)
    assert sizes("--share")[0] == d // 2
    assert sizes("--compact")[1] < rows
