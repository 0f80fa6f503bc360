"""JSON, numpy and MATLAB data files read back are the forms that were written."""

import json
from dataclasses import fields

import numpy as np
import pytest
from export.models import ACCEPTED, NAMES
from hypothesis import HealthCheck, given, settings
from strategies import models

import hysdel_py as hys
from hysdel_py.export.matrices import MATRICES, mld_to_dict, write_json, write_mat, write_npz
from hysdel_py.export.reading import mld_from_dict, read_mat, read_mld_json, read_npz

FORMS = {"json": (write_json, read_mld_json), "npz": (write_npz, read_npz), "mat": (write_mat, read_mat)}
each_form = pytest.mark.parametrize(("write", "read"), FORMS.values(), ids=list(FORMS))


def assert_equal(ours, theirs):
    for field in fields(hys.Mld):
        a, b = getattr(ours, field.name), getattr(theirs, field.name)
        if field.name not in MATRICES:
            assert a == b, field.name
            continue
        assert type(a) is type(b)
        assert a.shape == b.shape
        a, b = (m.toarray() if hasattr(m, "toarray") else m for m in (a, b))
        assert (a == b).all(), field.name


@each_form
@pytest.mark.parametrize("accepted", ACCEPTED, ids=NAMES)
def test_corpus_models_come_back(accepted, write, read, tmp_path):
    mld = accepted.model().mld if accepted.flag == "-5" else hys.to_mld(accepted.model(), constants="aux")
    write(mld, tmp_path / "file")
    assert_equal(read(tmp_path / "file"), mld)


@each_form
def test_a_form_that_came_back_steps_and_is_read_only(write, read, tmp_path):
    mld = hys.load("clutch").mld
    write(mld, tmp_path / "file")
    back = read(tmp_path / "file")
    x = [150, 40, 60, 100, 0]
    for ours, theirs in zip(back.step(x, [0, 0]), mld.step(x, [0, 0]), strict=True):
        assert (ours == theirs).all()
    with pytest.raises(ValueError, match="read-only"):
        back.A[0, 0] = 1


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(models())
def test_random_models_come_back(text):
    mld = hys.load(text).mld
    assert_equal(mld_from_dict(json.loads(json.dumps(mld_to_dict(mld)))), mld)


def damaged(**changes):
    return mld_to_dict(hys.load("clutch").mld) | changes


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (damaged(schema="hysdel_py/mld/99"), "'hysdel_py/mld/99': 'hysdel_py/mld/1' or 'hysdel_py/pwa/1' was expected"),
        ({}, "None"),
        ([], "None"),
        (damaged(A=[[1.0]]), "damaged"),
        (damaged(variables={}), "damaged"),
        (damaged(rows=[{}]), "damaged"),
    ],
)
def test_other_data_is_refused(data, words, tmp_path):
    (tmp_path / "mld.json").write_text(json.dumps(data))
    with pytest.raises(hys.ArgumentError, match=words):
        hys.read_json(tmp_path / "mld.json")


def test_files_of_another_kind_are_refused(tmp_path):
    path = tmp_path / "file"
    path.write_text("{ no")
    for read in (hys.read_json, read_mld_json, read_npz, read_mat):
        with pytest.raises(hys.ArgumentError, match="file"):
            read(path)
    np.savez(tmp_path / "other.npz", a=np.zeros(2))
    with pytest.raises(hys.ArgumentError, match="about"):
        read_npz(tmp_path / "other.npz")
