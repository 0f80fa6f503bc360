"""Expressions keep their order of operations when they are written."""

import pytest

from hysdel_py.export.matlab_text import NumberStyle, quoted
from hysdel_py.systems.symbolic import apply_symbolic, greatest, least, parameter

A, B, C, END = (parameter(name) for name in ("a", "b", "c", "end"))


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (A - (B + C), "params.a - (params.b + params.c)"),
        (A - (B - C), "params.a + (params.c - params.b)"),
        (A + B - C, "params.a + params.b - params.c"),
        (A * (B + 1), "params.a * (params.b + 1)"),
        (A / (B * C), "params.a / (params.b * params.c)"),
        (A * B / C, "params.a * params.b / params.c"),
        (-(A + B), "-(params.a + params.b)"),
        (A * -B, "params.a * (-params.b)"),
        (apply_symbolic("^", [-A, 2.0]), "(-params.a)^2"),
        (apply_symbolic("^", [-2.0, A]), "(-2)^params.a"),
        (least(A, B, 3.0), "min(min(3, params.a), params.b)"),
        (greatest(A, -0.5), "max(-0.5, params.a)"),
        (END + 1e-6, "params.('end') + 1e-06"),
    ],
)
def test_expressions(number, text):
    assert NumberStyle().number(number).replace(" ^ ", "^") == text


def test_numbers_and_texts():
    style = NumberStyle()
    assert [style.number(n) for n in (1 / 3, -0.0, 1e21, float("inf"), float("nan"))] == [
        "0.333333333333333", "0", "1e+21", "inf", "NaN",
    ]  # fmt: skip
    assert quoted("it's\n two") == "'it''s two'"
