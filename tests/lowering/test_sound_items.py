"""Errors of all stages are reported together, and none that is a consequence of another."""

import pytest

import hysdel_py as hys
from hysdel_py.diagnostics.codes import Code

FRAME = """SYSTEM s {{
  INTERFACE {{ PARAMETER {{ REAL p; {parameters} }} STATE {{ REAL x [-1, 1]; }} INPUT {{ REAL u; REAL v [0, 1]; }} }}
  IMPLEMENTATION {{ AUX {{ REAL a, b; BOOL d, e; }} CONTINUOUS {{ x = {update}; }} {items} }}
}}"""


def codes(items, update="x", parameters="", **given):
    with pytest.raises(hys.CompileError) as error:
        _ = hys.load(FRAME.format(items=items, update=update, parameters=parameters), **given).mld
    return sorted(d.code.value for d in error.value.diagnostics if d.severity.value == "error")


def test_stages_of_the_lowering_are_reported_together():
    assert codes("AD { d = u <= 0; }", update="x + 1/(1-1)") == ["HYS309", "HYS401"]


def test_semantic_errors_do_not_hide_those_of_lowering():
    assert codes("AD { d = u <= 0; }", update="x*x") == ["HYS302", "HYS401"]
    assert codes("AD { d = u <= sqrt(-1); }", update="x*x") == ["HYS302", "HYS309"]


def test_a_missing_value_does_not_hide_other_errors():
    assert codes("AD { d = u <= 0; e = p*v <= 0; }", update="p*x") == ["HYS205", "HYS401"]


@pytest.mark.parametrize(
    "items",
    [
        "LINEAR { a = x*x; b = a + v; } AD { d = b <= 0; }",
        "LINEAR { a = nope; } DA { b = {IF e THEN a ELSE 0}; } AD { d = b <= v; }",
        "LINEAR { a = x; a = v; b = x*x; } AD { d = a + b <= 0; }",
    ],
)
def test_what_depends_on_a_mistake_stays_quiet(items):
    assert not {"HYS401", "HYS402"} & set(codes(items))


@pytest.mark.parametrize("parameters", ["REAL MLD_bigMbound = -1;", "REAL MLD_bigMbound = 0;"])
def test_a_wrong_default_bound_is_all_that_is_said(parameters):
    assert codes("AD { d = u <= 0; }", parameters=parameters) == ["HYS207"]


def test_a_wrong_gap_is_all_that_is_said():
    assert codes("AD { d = v <= 0; }", parameters="REAL MLD_epsilon = -1;") == ["HYS207"]


def test_warnings_of_the_second_look_are_not_reported():
    with pytest.raises(hys.CompileError) as error:
        hys.load(FRAME.format(items="AD { d = v <= 5; }", update="x*x", parameters=""))
    assert {d.code for d in error.value.diagnostics} == {Code.NOT_AFFINE}


def test_names_of_a_missing_module_are_a_consequence():
    with pytest.raises(hys.CompileError) as error:
        hys.load(
            "SYSTEM s { INTERFACE { MODULE { nope m; } OUTPUT { REAL y; } } "
            "IMPLEMENTATION { LINEAR { m.i = 1; } OUTPUT { y = m.q; } } }"
        )
    assert [d.code for d in error.value.diagnostics] == [Code.MODULE]
