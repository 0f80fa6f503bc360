"""What is written is what the form holds."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_array

import hysdel_py as hys
from hysdel_py.export.matrices import MATRICES, SCHEMA, mld_to_dict, nonzeros, row_text, write_json, write_npz
from hysdel_py.shipped import shipped_models


def dense(matrix):
    return np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else matrix)


@pytest.fixture(scope="module", params=sorted(shipped_models()))
def mld(request):
    return hys.load(request.param).mld


def test_json_holds_every_matrix_with_its_shape(mld, tmp_path):
    path = tmp_path / "model.json"
    write_json(mld, path)
    data = json.loads(path.read_text(encoding="utf-8"))
    assert data["schema"] == SCHEMA
    assert data["sizes"] == {"x": mld.nx, "u": mld.nu, "y": mld.ny, "d": mld.nd, "z": mld.nz, "e": mld.ne}
    for name in MATRICES:
        expected = dense(getattr(mld, name))
        assert np.array(data[name]).reshape(expected.shape) == pytest.approx(expected, abs=0)


def test_json_text_is_the_plain_data(mld, tmp_path):
    path = tmp_path / "model.json"
    write_json(mld, path)
    text = path.read_text(encoding="utf-8")
    assert json.loads(text) == mld_to_dict(mld)
    rows = mld_to_dict(mld)["E3"] or mld_to_dict(mld)["A"]  # a model without logic has no rows in E3
    assert any("\n[" + ", ".join(map(json.dumps, rows[0])) + f"]{end}" in text for end in (",\n", "\n"))


def test_entries_that_are_not_zero():
    matrix = np.array([[0.0, -0.0, 2.5], [np.nan, 0.0, 0.0]])
    for form in (matrix, csr_array(matrix)):
        first, second = nonzeros(form)
        assert first == [(2, 2.5)]
        assert [column for column, _ in second] == [0]
    unordered = csr_array((np.array([1.0, 0.0, 3.0]), np.array([2, 1, 0]), np.array([0, 3])), shape=(1, 4))
    assert list(nonzeros(unordered)) == [[(0, 3.0), (2, 1.0)]]
    assert row_text([(1, 7.0)], 3, "0 ", "{:g} ".format) == "0 7 0 "


def test_json_holds_names_ranges_and_origins(mld):
    data = mld_to_dict(mld)
    for key in ("x", "u", "y", "d", "z"):
        group = getattr(mld, key)
        assert [v["name"] for v in data["variables"][key]] == [v.name for v in group]
        assert [v["type"] for v in data["variables"][key]] == ["BOOL" if v.is_bool else "REAL" for v in group]
    assert [(v["low"], v["high"]) for v in data["variables"]["x"]] == [(v.low, v.high) for v in mld.x]
    assert [row["line"] for row in data["rows"]] == [row.line for row in mld.rows]
    assert len(data["rows"]) == mld.ne
    assert len(data["updates"]) == mld.nx
    assert len(data["outputs"]) == mld.ny


def test_a_step_from_the_written_matrices_is_a_step_of_the_form(mld, tmp_path):
    """A reader who knows nothing but the file gets the same numbers."""
    path = tmp_path / "model.npz"
    write_npz(mld, path)
    with np.load(path) as f:
        share = 0.0 if mld.name == "bist_part2" else 0.5  # its requirement wants no force of the brake
        x = np.where(f["is_bool_x"], 0.0, f["low_x"] + share * (f["high_x"] - f["low_x"]))
        u = np.where(f["is_bool_u"], 0.0, f["low_u"])
        x1, y, d, z = mld.step(x, u, check=False)
        assert f["A"] @ x + f["B1"] @ u + f["B2"] @ d + f["B3"] @ z + f["B5"] == pytest.approx(x1)
        assert f["C"] @ x + f["D1"] @ u + f["D2"] @ d + f["D3"] @ z + f["D5"] == pytest.approx(y)
        assert (f["E2"] @ d + f["E3"] @ z <= f["E1"] @ u + f["E4"] @ x + f["E5"] + 1e-9).all()
        assert f["names_x"].tolist() == [v.name for v in mld.x]
        assert f["high_x"].tolist() == [v.high for v in mld.x]


def test_infinite_ranges_become_null_in_json_and_stay_infinite_in_npz(tmp_path):
    text = "SYSTEM s { INTERFACE { STATE { REAL x; } OUTPUT { REAL y; } } IMPLEMENTATION { CONTINUOUS { x = 2*x; } "
    mld = hys.load(text + "OUTPUT { y = x; } } }").mld
    data = mld_to_dict(mld)
    assert (data["variables"]["x"][0]["low"], data["variables"]["x"][0]["high"]) == (None, None)
    json.dumps(data, allow_nan=False)
    write_npz(mld, tmp_path / "free.npz")
    with np.load(tmp_path / "free.npz") as f:
        assert (f["low_x"][0], f["high_x"][0]) == (-np.inf, np.inf)
        assert f["E1"].shape == (0, 0)


def test_no_negative_zeros(mld):
    """They would make two files of the same model differ."""
    negative = replace(mld, B5=-np.zeros(mld.nx), E1=-0.0 * mld.E1)
    for name in MATRICES:
        values = np.array(mld_to_dict(negative)[name], dtype=float).ravel()
        assert not np.signbit(values[values == 0]).any()


def test_unit_and_description_are_kept():
    variable = mld_to_dict(hys.load("clutch").mld)["variables"]["x"][0]
    assert (variable["name"], variable["unit"], variable["description"]) == ("we", "rad/s", "engine speed")
    assert variable["generated"] is False
