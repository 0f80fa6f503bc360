"""The MATLAB simulator: what is refused, and its name; test_octave.py runs it."""

import pytest
from export.models import ACCEPTED, NAMES
from export.test_matlab import PLAIN

import hysdel_py as hys
from hysdel_py.export.simulator_matlab import function_name, simulator_text


@pytest.mark.parametrize("accepted", ACCEPTED, ids=NAMES)
def test_refused_like_the_original(accepted):
    compiled = accepted.compiled()
    if accepted.expected["simulator_ok"]:
        assert simulator_text(compiled, "sim", PLAIN).startswith("function [xn, d, z, y] = sim(x, u, params)")
    else:
        with pytest.raises(hys.CompileError, match="no simulator can be written"):
            simulator_text(compiled, "sim", PLAIN)


@pytest.mark.parametrize(("stem", "name"), [("sim", "sim"), ("my-model.v2", "my_model_v2"), ("2tanks", "s2tanks")])
def test_function_name(stem, name):
    assert function_name(stem) == name
