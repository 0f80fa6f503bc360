"""Bounds on parameters hold for their values; those on outputs reach both forms."""

import pytest

import hysdel_py as hys
from hysdel_py.diagnostics.codes import Code
from hysdel_py.export.compiled import compile_model
from hysdel_py.export.matlab import MatlabOptions, matlab_text
from hysdel_py.lowering.constants import Constants

TEXT = """SYSTEM s {
  INTERFACE {
    PARAMETER { REAL k [0, 2*top], top = 1; REAL v(2) [0, 1; 2, 3]; }
    STATE { REAL x [0, 4]; }
    OUTPUT { REAL y [0, 9], free; REAL w(2) [0, 1]; BOOL b; }
  }
  IMPLEMENTATION { CONTINUOUS { x = k*x; } OUTPUT { y = 3*x; free = 2*x; w = v*x; } }
}
"""
FIT = {"k": 2.0, "v": [1.0, 2.0]}


def test_values_within_are_accepted_and_kept_in_the_typed_model():
    model = hys.load(TEXT, **FIT)
    assert model.parameters["k"] == 2
    bounded = {s.name for s in model.typed.parameters if s.bounds is not None}
    assert bounded == {"k", "v(1)", "v(2)"}


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"k": 2.5}, r"the parameter k is 2.5, outside of its bounds \[0, 2\]"),
        ({"k": -1}, r"the parameter k is -1, outside of its bounds \[0, 2\]"),
        ({"k": 1.5, "top": 0.5}, r"the parameter k is 1.5, outside of its bounds \[0, 1\]"),
        ({"v": [1.0, 1.0]}, r"the parameter v\(2\) is 1, outside of its bounds \[2, 3\]"),
    ],
)
def test_values_outside_are_errors_that_name_both(given, message):
    with pytest.raises(hys.CompileError, match=message):
        hys.load(TEXT, **(FIT | given))


def test_bounds_of_outputs_are_ranges_of_both_forms():
    model = hys.load(TEXT, **FIT)
    expected = {"y": (0, 9), "w(1)": (0, 1), "w(2)": (0, 1), "b": (0, 1)}
    for form in (model.dha, model.mld):
        assert {v.name: (v.low, v.high) for v in form.y if v.name != "free"} == expected
    assert (model.mld.y[1].low, model.mld.y[1].high) == (0, 8)  # computed
    assert model.dha.step([4])[1].tolist()[:2] == model.mld.step([4])[1].tolist()[:2] == [12, 8]  # not checked


def test_open_parameters_keep_their_bounds_out_of_the_form():
    symbolic = hys.to_symbolic_mld(hys.load(TEXT))
    assert set(symbolic.parameters) == {"k", "v(1)", "v(2)"}
    assert symbolic.bind({"k": 1.0, "v(1)": 1.0, "v(2)": 2.0}).A.tolist() == [[1.0]]


def test_a_parameter_that_only_bounds_another_need_not_be_given():
    model = hys.load(TEXT.replace("top = 1", "top"), **FIT)
    assert model.dha.step([1])[0] == [2]


def test_the_original_takes_neither():
    notes = [d.message for d in hys.load(TEXT, **FIT).diagnostics if d.code is Code.EXTENSION]
    assert "HYSDEL 2.0.5 takes no bounds on the real output y" in notes
    assert "HYSDEL 2.0.5 takes no bounds on the real parameter k" in notes


def test_the_matlab_file_has_the_declared_ranges_of_outputs_only():
    model = hys.load(TEXT, **FIT)
    compiled, _ = compile_model(model.typed, model.parameters, Constants.AFFINE)
    lines = [
        line for line in matlab_text(compiled, MatlabOptions()).splitlines() if line.startswith(("S.yl(", "S.yu("))
    ]
    assert lines == ["S.yl(1) = 0;", "S.yu(1) = 9;", *(f"S.y{e}({k}) = {v};" for k in (3, 4) for e, v in ("l0", "u1"))]
