"""The MATLAB file of each corpus model, read back, is what the original wrote."""

import math

import numpy as np
import pytest
from export.matlab_reader import read_matlab
from export.models import ACCEPTED, NAMES

from hysdel_py.export.compiled import compile_model
from hysdel_py.export.matlab import MatlabOptions, matlab_text
from hysdel_py.export.matrices import dense
from hysdel_py.lowering.constants import Constants
from hysdel_py.systems.symbolic_mld import MATRICES

SIZES = ("nx", "nxr", "nxb", "nu", "nur", "nub", "ny", "nyr", "nyb", "nd", "nz")
PLAIN = MatlabOptions()

every_model = pytest.mark.parametrize("accepted", ACCEPTED, ids=NAMES)


def shaped(rows, shape):
    return np.array(rows, dtype=float).reshape(shape)


def check_against_original(data, expected):
    """Matrices with the rows in order, sizes, ranges and the origin of each row."""
    assert {key: data[key] for key in SIZES} == {key: expected[key] for key in SIZES}
    assert data["ne"] == expected["nE"]
    for name in MATRICES:
        if expected.get(name) is None:
            assert name not in data
        else:
            np.testing.assert_allclose(data[name], shaped(expected[name], data[name].shape), rtol=1e-9, atol=1e-12)
    for key in ("xl", "xu", "ul", "uu", "dl", "du", "zl", "zu"):
        infinite = math.inf if key[1] == "u" else -math.inf
        theirs = [expected["bounds"].get(key, {}).get(str(i + 1), infinite) for i in range(len(data[key]))]
        np.testing.assert_allclose(data[key].ravel(), theirs, rtol=1e-9, err_msg=key)
    for row, theirs in enumerate(expected["rows"], start=1):
        check_row(data["rowinfo"]["ineq"][row], theirs)


def check_row(ours, theirs):
    assert [ours["group"], ours["subgroup"], ours["subindex"]] == theirs["group"]
    assert (ours["item_type"], ours["section"], ours["defines"]) == (
        theirs["item"], theirs["section"], theirs["defines"],
    )  # fmt: skip
    if ours["source"][0].isalnum():  # the original is a line off for an item that starts with a sign
        assert ours["sourceline"] == theirs["line"]


@every_model
def test_file_is_that_of_the_original(accepted):
    check_against_original(read_matlab(matlab_text(accepted.compiled(), PLAIN)), accepted.expected)


@every_model
def test_file_over_parameters_gives_the_same_numbers(accepted):
    compiled = accepted.compiled(every=True)
    values = accepted.model().parameters
    text = matlab_text(compiled, PLAIN)
    check_against_original(read_matlab(text, values), accepted.expected)


@every_model
def test_symbol_table_is_sorted_and_has_every_name(accepted):
    compiled = accepted.compiled()
    table = read_matlab(matlab_text(compiled, PLAIN))["symtable"]
    names = [table[i]["name"] for i in sorted(table)]
    assert names == sorted(names)
    mld = compiled.mld
    variables = {v.name: key for key in "xuydz" for v in getattr(mld, key)}
    assert set(names) == set(variables) | {s.name for s in compiled.typed.parameters}
    for fields in table.values():
        assert fields["kind"] == variables.get(fields["name"], "p")
        if fields["kind"] != "p":
            group = [v for v in getattr(mld, fields["kind"]) if v.is_bool == (fields["type"] == "b")]
            assert group[int(fields["index"]) - 1].name == fields["name"]


EXAMPLE = """SYSTEM example {
  INTERFACE {
    STATE { REAL x [-1, 3]; BOOL b; }
    INPUT { REAL u [0, k]; }
    PARAMETER { REAL k, twice = 2*k; }
  }
  IMPLEMENTATION {
    AUX { BOOL d; REAL z; }
    AD { d = x - k <= 0; }
    DA { z = {IF d THEN twice*x - sin(k)^2 ELSE u [-7, 7, 0]}; }
    CONTINUOUS { x = z/(k - 5) + k; }
    AUTOMATA { b = ~d; }
  }
}
"""


def example(hys_load, constants=Constants.AFFINE, **given):
    model = hys_load(EXAMPLE, **given)
    return compile_model(model.typed, model.parameters, constants)[0]


def test_parameters_without_value_stay_open():
    import hysdel_py as hys

    compiled = example(hys.load)
    assert compiled.mld.parameters == ("k",)
    for k in (1.5, -2.0, 0.0):
        numeric = hys.to_mld(hys.load(EXAMPLE, k=k), big_m="interval")
        bound = compiled.mld.bind({"k": k})
        data = read_matlab(matlab_text(compiled, PLAIN), {"k": k})
        for name in MATRICES:
            assert (dense(bound, name) == dense(numeric, name)).all(), name
            np.testing.assert_allclose(data[name].reshape(dense(numeric, name).shape), dense(numeric, name), rtol=1e-13)
        assert [(v.low, v.high) for v in bound.u] == [(v.low, v.high) for v in numeric.u]


def test_options_of_the_text():
    import hysdel_py as hys

    compiled = example(hys.load)
    text = matlab_text(compiled, PLAIN)
    assert "if ~isfield(params, 'k')" in text
    assert "max(0, params.k)" in text
    assert "maple" not in text
    bare = matlab_text(compiled, MatlabOptions(symbol_table=False, row_info=False, parameter_checks=False, maple=True))
    assert "isfield" not in bare
    assert "maple('max', 0, params.k)" in bare
    data = read_matlab(bare, {"k": 1.0})
    assert (data["MLDsymtable"], data["MLDrowinfo"]) == (0, 0)
    assert "{" not in bare


def test_fields_of_ad_and_da_rows():
    import hysdel_py as hys

    rows = read_matlab(matlab_text(example(hys.load, k=2), PLAIN))["rowinfo"]["ineq"]
    assert (rows[1]["aff_min"], rows[1]["aff_max"], rows[1]["aff_min_computed"]) == (-3, 1, 1)
    assert rows[2]["aff_eps"] == 1e-6
    assert (rows[3]["else_min"], rows[3]["else_max"], rows[3]["else_min_computed"]) == (-7, 7, 0)
    assert rows[3]["then_max_computed"] == 1
    assert rows[1]["human"] == "(-3.000001) * d <= (1) * x + (-2.000001)"
    assert rows[1]["source"] == "d = x - k <= 0;"
    assert "then_min" not in rows[1]
