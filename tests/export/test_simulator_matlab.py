"""The MATLAB simulator: what is refused, and its name; test_octave.py runs it."""

import re

import pytest
from export.models import ACCEPTED, NAMES
from export.test_matlab import PLAIN

import hysdel_py as hys
from hysdel_py.export.compiled import compile_model
from hysdel_py.export.matlab import matlab_text
from hysdel_py.export.matlab_text import parameter_is_missing, parameter_text
from hysdel_py.export.simulator_matlab import function_name, simulator_text
from hysdel_py.lowering.constants import Constants


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


VECTORS = """SYSTEM s {
  INTERFACE { PARAMETER { REAL W(2, 2); REAL c(2); } STATE { REAL a(2) [-9, 9]; } OUTPUT { REAL y(2); } }
  IMPLEMENTATION { CONTINUOUS { a = W*a + c; } OUTPUT { y = a; } }
}
"""


def test_elements_of_parameters_are_those_of_matrices():
    model = hys.load(VECTORS)
    text = simulator_text(compile_model(model.typed, model.parameters, Constants.AFFINE)[0], "sim", PLAIN)
    assert "if ~isfield(params, 'W') || size(params.W, 1) < 2 || size(params.W, 2) < 1, error" in text
    assert "if ~isfield(params, 'c') || numel(params.c) < 2, error" in text
    assert "(params.W(2, 1))*x(1)" in text


def test_parameters_of_modules_are_those_of_structs():
    assert parameter_text("t1.end.k(2)") == "params.t1.('end').k(2)"
    assert parameter_is_missing("t1.k") == "~isfield(params, 't1') || ~isfield(params.t1, 'k')"


def names_of_code(text):
    """Words in front of parentheses or dots outside of texts and comments."""
    code = re.sub(r"'(?:[^']|'')*'|%.*", "", text)
    return set(re.findall(r"[A-Za-z_]\w*(?=[.(])", code))


def test_names_with_parentheses_are_in_texts_only():
    model = hys.load("three_tanks")
    compiled = compile_model(model.typed, model.parameters, Constants.AFFINE)[0]
    elements = {variable.name.split("(")[0] for variable in (*model.mld.x, *model.mld.u, *model.mld.y)} - {"level"}
    assert {"h", "q", "open"} == elements
    for text in (simulator_text(compiled, "sim", PLAIN), matlab_text(compiled, PLAIN)):
        assert not names_of_code(text) & {"h", "q", "open", "level", "high", "flow"}
