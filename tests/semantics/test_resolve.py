"""Names, order of declarations, units, and several errors at once."""

import pytest

import hysdel_py as hys
from hysdel_py.diagnostics.diagnostic import Severity
from hysdel_py.semantics.symbols import Role


def load(interface, implementation=""):
    return hys.load(f"SYSTEM s {{\nINTERFACE {{ {interface} }}\nIMPLEMENTATION {{ {implementation} }}\n}}")


def names(variables):
    return [v.name for v in variables]


def test_reals_come_before_booleans_across_sections():
    model = load(
        "STATE { BOOL b; REAL x [0, 1]; } INPUT { BOOL v; } STATE { BOOL c; REAL w [0, 1]; } INPUT { REAL u [0, 1]; }"
    )
    assert names(model.dha.x) == ["x", "w", "b", "c"]
    assert names(model.dha.u) == ["u", "v"]
    assert names(model.typed.select(Role.STATE)) == ["b", "x", "c", "w"]


@pytest.mark.parametrize(
    ("comment", "unit", "description"),
    [
        ("/* [m/s] speed */", "m/s", "speed"),
        ("/* [m/s] */", "m/s", ""),
        ("/* speed */", "", "speed"),
        ("/* [kg m^2]  of\n the engine */", "kg m^2", "of the engine"),
        ("", "", ""),
        ("\n/* [m] of the next line */", "", ""),
    ],
)
def test_unit_comments(comment, unit, description):
    model = load(f"STATE {{ REAL x [0, 1]; {comment}\n REAL w [0, 1]; /* [N] force */ }}")
    x, w = model.dha.x
    assert (x.unit, x.description) == (unit, description)
    assert (w.unit, w.description, w.label) == ("N", "force", "w [N]")


def test_case_matters_and_ordinary_words_are_names():
    model = load(
        "STATE { REAL min [0, 1], Min [0, 1], inf [0, 1], if [0, 1], e [0, 1]; }", "CONTINUOUS { min = Min + 1e0*e; }"
    )
    assert names(model.dha.x) == ["min", "Min", "inf", "if", "e"]


def test_items_may_refer_forward():
    model = load(
        "STATE { REAL x [0, 1]; }",
        "AUX { REAL z, w; } CONTINUOUS { x = w; } LINEAR { w = 2*z; } LINEAR { z = x - 1; }",
    )
    assert model.dha.step([0.5])[0] == [-1.0]
    assert model.mld.step([0.5])[0] == [-1.0]


def test_all_errors_of_a_file_are_reported_once_each_in_order():
    with pytest.raises(hys.CompileError) as caught:
        load("STATE { REAL x [0, 1]; }", "AUX { REAL z; } LINEAR { z = a*b + a; } CONTINUOUS { x = x*x; }")
    assert [d.message.split()[0] for d in caught.value.diagnostics] == ["a", "b", "a", "a"]
    assert len(caught.value.diagnostics) == 4


@pytest.mark.parametrize(
    "affine", ["x - x", "0*x", "x*(2 - 2)", "2*(x + 1)*3/4", "(x + u)/2", "-(-x)", "x*2^3", "sin(1)*x"]
)
def test_affine_is_a_matter_of_form(affine):
    load("STATE { REAL x [0, 1]; } INPUT { REAL u [0, 1]; }", f"CONTINUOUS {{ x = {affine}; }}")


@pytest.mark.parametrize("bad", ["x*x", "x*u", "1/x", "x/u", "2^x", "x^1", "exp(x)", "x*(u - u)"])
def test_not_affine(bad):
    with pytest.raises(hys.CompileError, match="HYS302"):
        load("STATE { REAL x [0, 1]; } INPUT { REAL u [0, 1]; }", f"CONTINUOUS {{ x = {bad}; }}")


def test_a_state_may_be_its_own_predecessor_but_not_an_auxiliary():
    load("STATE { BOOL b; }", "AUTOMATA { b = ~b; }")
    with pytest.raises(hys.CompileError, match="HYS305"):
        load("", "AUX { REAL z; } LINEAR { z = z/2; }")


def test_redeclared_epsilon_as_variable_is_fine_without_thresholds():
    assert names(load("STATE { REAL MLD_epsilon [0, 1]; }", "CONTINUOUS { MLD_epsilon = 0*MLD_epsilon; }").dha.x) == [
        "MLD_epsilon"
    ]


def test_warnings_do_not_stop():
    model = load("STATE { REAL x [1, 0]; } INPUT { REAL u [0, 1]; }")
    _ = model.mld
    assert {d.severity for d in model.diagnostics} == {Severity.WARNING}
    assert {d.code.value for d in model.diagnostics} == {"HYS501", "HYS502", "HYS503"}
    assert (model.dha.x[0].low, model.dha.x[0].high) == (0, 1)


def test_diagnostics_of_later_stages_join_once_they_ran():
    model = load(
        "STATE { REAL x [0, 1]; }", "AUX { BOOL d; } AD { d = x <= 0 [-9, 9, 1e-6]; } CONTINUOUS { x = (REAL d); }"
    )
    assert model.diagnostics == ()
    _ = model.mld
    assert [d.code.value for d in model.diagnostics] == ["HYS504"]
