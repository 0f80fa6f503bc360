"""MLD_bigMbound bounds the variables that nothing else bounds, and only where a range is needed."""

import pytest

import hysdel_py as hys
from hysdel_py.diagnostics.codes import Code

TEXT = """SYSTEM s {
  INTERFACE { PARAMETER { REAL MLD_bigMbound = 1e3; } STATE { REAL x; REAL free; } INPUT { REAL u [-2, 2]; } }
  IMPLEMENTATION { AUX { REAL z, w [-7, 9], a, b; BOOL d, e; }
    LINEAR { z = 2*x + u; w = x; a = b - u; b = a + u; }
    AD { d = z <= w; e = a >= 0; }
    CONTINUOUS { x = 0.5*x + u + (REAL d & e); free = free + u; }
  }
}
"""


def ranges(model):
    return {v.name: (v.low, v.high) for v in (*model.mld.x, *model.mld.u, *model.mld.z)}


def assumed(model):
    _ = model.mld
    return [d.message.split()[0] for d in model.diagnostics if d.code is Code.ASSUMED_BOUNDS]


def test_declared_ranges_win_then_definitions_then_the_parameter():
    found = ranges(hys.load(TEXT))
    assert found["x"] == (-1e3, 1e3)  # its update needs its own range
    assert found["z"] == (-2002, 2002)  # follows from its definition
    assert found["w"] == (-7, 9)
    assert found["u"] == (-2, 2)
    assert found["a"] == (-1e3, 1e3)  # defined in a circle with b


def test_each_variable_that_got_it_is_named_once():
    assert assumed(hys.load(TEXT)) == ["x", "a"]
    quiet = {d.message.split()[3] for d in hys.load(TEXT).diagnostics if d.code is Code.MISSING_BOUNDS}
    assert "x" not in quiet


def test_rows_are_those_of_the_declared_range():
    declared = TEXT.replace("REAL x;", "REAL x [-1000, 1000];").replace(", a, b;", ", a [-1000, 1000], b;")
    assert hys.load(TEXT).mld.E2.toarray().tolist() == hys.load(declared).mld.E2.toarray().tolist()


def test_simulation_of_the_mld_form_checks_it():
    model = hys.load(TEXT.replace("a = b - u; b = a + u;", "a = u; b = u;"))
    assert model.dha.step({"x": 1001, "free": 0}, [0])[0][0] == 500.5
    with pytest.raises(hys.SimulationError, match="x = 1001 is outside its range"):
        model.mld.step({"x": 1001, "free": 0}, [0])


def test_without_the_parameter_the_error_says_that_it_would_help():
    with pytest.raises(hys.CompileError, match="HYS402") as error:
        _ = hys.load(TEXT.replace("REAL MLD_bigMbound = 1e3;", "REAL c;")).mld
    assert "REAL MLD_bigMbound = 1e4;" in str(error.value)


@pytest.mark.parametrize("value", ["-1", "0", "1/0"])
def test_it_must_be_positive_and_finite(value):
    with pytest.raises(hys.CompileError, match=r"MLD_bigMbound is .*a positive finite number was expected"):
        hys.load(TEXT.replace("1e3", value))
    with pytest.raises(hys.CompileError, match="HYS207"):
        hys.load(TEXT, MLD_bigMbound=-1)


def test_it_must_be_real_and_needs_a_value():
    with pytest.raises(hys.CompileError, match="MLD_bigMbound is Boolean"):
        hys.load(TEXT.replace("REAL MLD_bigMbound = 1e3", "BOOL MLD_bigMbound = TRUE"))
    model = hys.load(TEXT.replace(" = 1e3", ""))
    with pytest.raises(hys.CompileError, match="a value is missing for the parameter MLD_bigMbound"):
        _ = model.dha


def test_it_stays_a_number_where_parameters_are_open():
    model = hys.load(TEXT.replace("bound = 1e3;", "bound = 1e3, k = 2;").replace("2*x", "k*x"))
    symbolic = hys.to_symbolic_mld(model, every=True)
    assert symbolic.parameters == ("k",)
    bound = symbolic.bind({"k": 2.0})
    assert bound.E2.toarray().tolist() == hys.to_mld(model, big_m="interval").E2.toarray().tolist()
    assert [v.low for v in bound.x] == [v.low for v in model.mld.x]
