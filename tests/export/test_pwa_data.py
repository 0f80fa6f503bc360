"""A Pwa in JSON and back, and its graph as DOT."""

import json

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.export.dot import dot_text
from hysdel_py.export.pwa_data import pwa_from_dict, pwa_to_dict, read_pwa_json, write_pwa_json


@pytest.mark.parametrize("name", ["clutch", "two_rooms"])
@pytest.mark.parametrize("merged", [False, True])
def test_what_is_read_is_what_was_written(name, merged, tmp_path):
    pwa = hys.load(name).pwa
    pwa = pwa.merge() if merged else pwa
    write_pwa_json(pwa, tmp_path / "modes.json")
    again = read_pwa_json(tmp_path / "modes.json")
    assert pwa_to_dict(hys.read_json(tmp_path / "modes.json")) == pwa_to_dict(pwa)
    assert json.dumps(pwa_to_dict(again)) == json.dumps(pwa_to_dict(pwa))
    assert again.describe() == pwa.describe()
    state = [(v.low + v.high) / 2 if not v.is_bool else 0 for v in pwa.x]
    control = [(v.low + v.high) / 2 if not v.is_bool else 0 for v in pwa.u]
    for ours, theirs in zip(again.step(state, control), pwa.step(state, control), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_other_data_is_refused():
    data = pwa_to_dict(hys.load("clutch").pwa)
    with pytest.raises(hys.ArgumentError, match="'hysdel_py/pwa/1' was expected"):
        pwa_from_dict(data | {"schema": "hysdel_py/mld/1"})
    with pytest.raises(hys.ArgumentError, match="damaged: KeyError: 'modes'"):
        pwa_from_dict({key: value for key, value in data.items() if key != "modes"})


def test_dot_text():
    pwa = hys.load("clutch").pwa.merge()
    text = dot_text(pwa, pwa.adjacency())
    assert text.startswith('graph "clutch" {\n')
    assert '  3 [label="3: 0*0110\\ngamma > reltol (line 52)\\ngamma <= 10*reltol (line 55)"];\n' in text
    assert '  3 -- 4 [label="gamma <= 10*reltol"];\n' in text
    directed = dot_text(pwa, pwa.transitions())
    assert directed.startswith('digraph "clutch" {\n')
    assert "  0 -> 0;\n" in directed
    assert directed == dot_text(pwa, pwa.transitions())
