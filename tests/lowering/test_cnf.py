"""Clauses say the same as the formula, and come in the documented order."""

from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hysdel_py.lowering.cnf import MAX_CLAUSES, TooManyClauses, cnf
from hysdel_py.systems.formula import Connective, Formula, Literal

NAMES = ("p", "q", "r", "s")
BINARY = [c for c in Connective if c is not Connective.NOT]


@st.composite
def formulas(draw, depth=4):
    if depth == 0 or draw(st.integers(0, 4)) == 0:
        return (draw(st.one_of(st.sampled_from(NAMES), st.booleans())),)
    if draw(st.integers(0, 3)) == 0:
        return (*draw(formulas(depth - 1)), Connective.NOT)
    return (*draw(formulas(depth - 1)), *draw(formulas(depth - 1)), draw(st.sampled_from(BINARY)))


def truth(clauses, values):
    return all(any(values[literal.name] == literal.positive for literal in clause) for clause in clauses)


@settings(max_examples=400, deadline=None, derandomize=True)
@given(formulas())
def test_truth_tables_agree(postfix):
    formula = Formula(postfix)
    clauses = cnf(formula)
    for row in product((False, True), repeat=len(NAMES)):
        values = dict(zip(NAMES, row, strict=True))
        assert truth(clauses, values) == formula.value(values)


@settings(max_examples=200, deadline=None, derandomize=True)
@given(formulas())
def test_no_literal_twice_and_no_tautology_inside_a_clause(postfix):
    for clause in cnf(Formula(postfix)):
        assert len({literal.name for literal in clause}) == len(clause)


def shown(*postfix):
    return [" | ".join(map(str, clause)) for clause in cnf(Formula(postfix))]


AND, OR, NOT, IFF, IMPLIES, IMPLIED_BY = (
    Connective.AND, Connective.OR, Connective.NOT, Connective.IFF, Connective.IMPLIES, Connective.IMPLIED_BY,
)  # fmt: skip


@pytest.mark.parametrize(
    ("postfix", "clauses"),
    [
        (("p",), ["p"]),
        ((True,), []),
        ((False,), [""]),
        (("p", "q", AND, "r", OR), ["p | r", "q | r"]),
        (("p", "q", "r", AND, OR), ["p | q", "p | r"]),
        (("p", "p", "q", OR, AND), ["p", "p | q"]),  # a conjunction does not absorb
        (("p", "p", AND), ["p", "p"]),
        (("p", "p", "q", OR, OR), ["p | q"]),
        (("p", "p", NOT, OR), []),
        (("p", "q", IMPLIES), ["~p | q"]),
        (("p", "q", IMPLIED_BY), ["~q | p"]),
        (("p", "q", IFF), ["p | ~q", "q | ~p"]),
        (("d", "p", "q", AND, IFF), ["d | ~p | ~q", "p | ~d", "q | ~d"]),
        (("p", "q", OR, NOT), ["~p", "~q"]),
        (("p", False, AND), [""]),
        (("p", True, IFF), ["p"]),
        (("p", False, OR), ["p"]),
    ],
)
def test_order_of_clauses(postfix, clauses):
    assert shown(*postfix) == clauses


def test_literal_text():
    assert (str(Literal("p")), str(Literal("p", positive=False))) == ("p", "~p")


def test_explosion_is_refused():
    def conjunction(letter):
        return (f"{letter}0", *(entry for i in range(1, 200) for entry in (f"{letter}{i}", AND)))

    with pytest.raises(TooManyClauses):
        cnf(Formula((*conjunction("p"), *conjunction("q"), OR)))
    assert MAX_CLAUSES >= 1024
