"""Warnings that follow from ranges and truth tables: none that is not true."""

from itertools import product

import pytest

import hysdel_py as hys
from hysdel_py.lowering.truth import constant_truth
from hysdel_py.systems.formula import Connective, Formula

AND, OR, NOT, IFF = Connective.AND, Connective.OR, Connective.NOT, Connective.IFF


@pytest.mark.parametrize(
    "postfix",
    [("a",), ("a", "a", NOT, OR), ("a", "a", NOT, AND), ("a", "b", Connective.IMPLIES), (True,), (False,),
     ("a", "b", AND, "a", Connective.IMPLIES), ("a", "b", "c", IFF, IFF), ("a", "b", Connective.IMPLIED_BY)],
)  # fmt: skip
def test_truth_agrees_with_enumeration(postfix):
    formula = Formula(postfix)
    points = product((0.0, 1.0), repeat=len(formula.names))
    values = {formula.value(dict(zip(formula.names, point, strict=True))) for point in points}
    assert constant_truth(formula) == (values.pop() if len(values) == 1 else None)


@pytest.mark.parametrize("name", sorted(hys.shipped_models()))
def test_shipped_models_are_clean(name):
    model = hys.load(name)
    _ = model.mld
    assert not [d for d in model.diagnostics if d.severity.value == "warning"]


def test_parameters_are_not_blamed():
    model = hys.load("""SYSTEM s {
      INTERFACE { STATE { REAL x [-1, 1]; } PARAMETER { REAL a = 2; BOOL q = TRUE; } }
      IMPLEMENTATION { AUX { BOOL d; REAL z; } AD { d = a <= 3; } DA { z = {IF q THEN x ELSE 0}; }
        CONTINUOUS { x = 0.5*z; } MUST { a <= 5; d | q; } } }""")
    _ = model.mld
    assert not [d for d in model.diagnostics if d.severity.value == "warning"]
