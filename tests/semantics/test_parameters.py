"""Values of parameters: from the file, from the call, predefined, wrong."""

import math

import pytest

import hysdel_py as hys

TEXT = """SYSTEM p {
  INTERFACE {
    PARAMETER { REAL a, c = 2*a, k = 7; BOOL q = TRUE; REAL unneeded; }
    STATE { REAL x [-100, 100]; }
  }
  IMPLEMENTATION { CONTINUOUS { x = a*x + c + (REAL q); } }
}"""


def codes(error):
    return [d.code.value for d in error.value.diagnostics]


def test_call_wins_over_file_and_dependent_values_follow():
    assert hys.load(TEXT, a=3).parameters["c"] == 6
    assert hys.load(TEXT, a=3, c=1).parameters["c"] == 1
    assert hys.load(TEXT, a=3, q=False).dha.step([0])[0] == [6.0]


def test_a_value_that_nothing_needs_may_be_missing():
    assert hys.load(TEXT, a=1).dha.step([1])[0] == [4.0]


def test_missing_value_is_found_when_lowering():
    model = hys.load(TEXT)
    with pytest.raises(hys.CompileError, match="parameter a") as caught:
        _ = model.dha
    assert codes(caught) == ["HYS205"]


def test_unknown_name_lists_the_known_ones():
    with pytest.raises(hys.CompileError, match="a, c, k, q, unneeded") as caught:
        hys.load(TEXT, a=1, aa=2)
    assert codes(caught) == ["HYS206"]


@pytest.mark.parametrize("value", [math.nan, "much", None, [1, 2], 1j])
def test_real_value_that_is_no_number(value):
    with pytest.raises(hys.CompileError, match=r"parameter a was given .* a number was expected") as caught:
        hys.load(TEXT, a=value)
    assert codes(caught) == ["HYS207"]


@pytest.mark.parametrize("value", [2, 0.5, math.nan, "yes"])
def test_bool_value_that_is_neither_true_nor_false(value):
    with pytest.raises(hys.CompileError, match="True or False was expected") as caught:
        hys.load(TEXT, a=1, q=value)
    assert codes(caught) == ["HYS207"]


@pytest.mark.parametrize("value", [math.inf, -math.inf])
def test_infinite_value_is_refused_where_it_is_used(value):
    with pytest.raises(hys.CompileError, match="not a finite number") as caught:
        _ = hys.load(TEXT, a=value).dha
    assert set(codes(caught)) == {"HYS309"}


@pytest.mark.parametrize("value", [0, -1e-6, math.inf])
def test_epsilon_must_be_positive(value):
    with pytest.raises(hys.CompileError, match="MLD_epsilon"):
        hys.load(TEXT, a=1, MLD_epsilon=value)


def test_epsilon_can_be_set_by_the_call():
    text = """SYSTEM e { INTERFACE { STATE { REAL x [-1, 1]; } }
      IMPLEMENTATION { AUX { BOOL d; } AD { d = x <= 0; } CONTINUOUS { x = (REAL d); } } }"""
    assert hys.load(text, MLD_epsilon=0.125).mld.E5[0] == -0.125


def test_predefined_pi_and_its_redeclaration():
    text = "SYSTEM p {{ INTERFACE {{ PARAMETER {{ REAL t = 2*pi{}; }} }} IMPLEMENTATION {{ }} }}"
    assert hys.load(text.format("")).parameters["t"] == pytest.approx(2 * math.pi)
    assert hys.load(text.format(", pi = 3")).parameters["t"] == 6


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2^3", 8), ("-2^2", 4), ("2^-1", 0.5), ("4^0.5", 2), ("2^3^2", 64), ("7/2", 3.5), ("1 - 2 - 3", -4),
        ("exp(0)", 1), ("log(exp(2))", 2), ("sqrt(9)", 3), ("sin(pi/2)", 1), ("cos(0)", 1), ("(REAL TRUE)", 1),
        ("(REAL TRUE & ~TRUE)", 0), ("1/0", math.inf), ("-1/0", -math.inf), ("exp(1000)", math.inf),
    ],
)  # fmt: skip
def test_constant_arithmetic(text, value):
    model = hys.load(f"SYSTEM p {{ INTERFACE {{ PARAMETER {{ REAL t = {text}; }} }} IMPLEMENTATION {{ }} }}")
    assert model.parameters["t"] == pytest.approx(value)


def test_circle_is_named():
    text = "SYSTEM p { INTERFACE { PARAMETER { REAL a = b, b = a; } } IMPLEMENTATION { } }"
    with pytest.raises(hys.CompileError, match=r"a -> b -> a|b -> a -> b"):
        hys.load(text)


def said_of(text, **given):
    try:
        model = hys.load(text, **given)
        return [d.code.value for d in (model.mld and model.diagnostics)]
    except hys.CompileError as error:
        return [d.code.value for d in error.diagnostics]


REAL = (
    "SYSTEM s {{ INTERFACE {{ PARAMETER {{ {} }} STATE {{ REAL x; }} }} "
    "IMPLEMENTATION {{ AUX {{ BOOL d; }} AD {{ d = x <= 0; }} CONTINUOUS {{ x = x; }} }} }}"
)


def test_a_bound_with_a_faulty_value_is_all_that_is_reported():
    assert said_of(REAL.format("REAL MLD_bigMbound = ;")) == ["HYS102"]


def test_a_vector_is_no_bound():
    assert "HYS301" in said_of(REAL.format("REAL MLD_bigMbound(2) = [1; 2];"))


def test_text_is_no_number():
    assert "HYS207" in said_of(REAL.format("REAL MLD_bigMbound = 1, k;"), k="1")
