"""Numbers that wait for parameters: simplified where that is exact, and equal to plain arithmetic once bound."""

import math
import operator

import pytest
from hypothesis import given
from hypothesis import strategies as st

import hysdel_py as hys
from hysdel_py.systems.symbolic import (
    Symbolic,
    apply_symbolic,
    evaluate,
    greatest,
    is_finite,
    is_undefined,
    least,
    parameter,
    parameters_of,
    postorder,
)

A, B = parameter("a"), parameter("b")
OPERATIONS = (operator.add, operator.sub, operator.mul, operator.truediv, least, greatest)


def test_what_is_known_is_simplified():
    for same in (A + 0, 0 + A, A * 1, 1.0 * A, A / 1, -(-1 * A), least(A), A - 0.0, -1 * -A):
        assert same is A
    for zero in (A * 0, 0.0 * A, 0 / A):
        assert type(zero) is float
        assert zero == 0.0
    assert least(3, 1, 2) == 1
    assert type(least(3.0, 1.0)) is float
    assert (A + -B).op == "-"
    assert (-(A - B)).args == (B, A)
    assert parameters_of(least(B, A + 1, 3, 2) * B) == ("b", "a") or parameters_of(least(B, A)) == ("b", "a")


def test_it_is_immutable_and_no_number_yet():
    with pytest.raises(AttributeError, match="immutable"):
        A.name = "c"
    assert math.isnan(A)
    assert bool(A)
    assert is_finite(A)
    assert not is_undefined(A)
    assert is_undefined(math.nan)
    assert not is_finite(math.inf)


@st.composite
def expressions(draw, depth=4):
    """(symbolic, plain) pairs that were computed by the same operations; a is 0.7 and b is -1.3."""
    if depth == 0 or draw(st.integers(0, 4)) == 0:
        number = draw(st.sampled_from([0.0, 1.0, -1.0, 2.5, -0.3]))
        return draw(st.sampled_from([(A, 0.7), (B, -1.3), (number, number)]))
    left, right = draw(expressions(depth - 1)), draw(expressions(depth - 1))
    operation = draw(st.sampled_from([*OPERATIONS, None]))
    if operation is None:
        return -left[0], -left[1]
    if operation is operator.truediv and abs(right[1]) < 1e-3:
        operation = operator.add
    return operation(left[0], right[0]), operation(left[1], right[1])


@given(expressions())
def test_bound_numbers_are_those_of_plain_arithmetic(pair):
    symbolic, plain = pair
    assert evaluate(symbolic, {"a": 0.7, "b": -1.3}) == plain


def test_functions_and_faults():
    assert evaluate(apply_symbolic("sin", [A]), {"a": 2.0}) == math.sin(2.0)
    assert evaluate(apply_symbolic("^", [A, 3.0]), {"a": 2.0}) == 8.0
    for number, values in ((A, {}), (1 / A, {"a": 0.0}), (apply_symbolic("log", [A]), {"a": -1.0})):
        with pytest.raises(hys.ArgumentError):
            evaluate(number, values)


def test_deep_and_shared_numbers():
    number = A
    for _ in range(10_000):
        number = number + B
    assert evaluate(number, {"a": 1.0, "b": 1.0}) == 10_001
    shared = A
    for _ in range(60):
        shared = shared * shared
    assert shared.size > 2**60
    assert len(list(postorder(shared))) == 61
    assert evaluate(shared, {"a": 1.0}) == 1.0
    assert isinstance(shared, Symbolic)
