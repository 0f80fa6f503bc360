"""Nothing recurses over expressions: ten thousand levels compile like one."""

import pytest

import hysdel_py as hys

DEPTH = 10_000


def model(section, item, declared="REAL z; BOOL d;"):
    return hys.load(
        f"""SYSTEM deep {{
          INTERFACE {{ STATE {{ REAL x [-1, 1]; BOOL b; }} }}
          IMPLEMENTATION {{ AUX {{ {declared} }} {section} {{ {item} }}
            CONTINUOUS {{ x = 0.5*x; }} AUTOMATA {{ b = b; }} }}
        }}"""
    )


@pytest.mark.parametrize(
    ("section", "expression", "value"),
    [
        ("LINEAR", "(" * DEPTH + "x" + ")" * DEPTH, 0.5),
        ("LINEAR", "-" * DEPTH + "x", 0.5),
        ("LINEAR", "-(" * DEPTH + "x" + ")" * DEPTH, 0.5),
        ("LINEAR", " + ".join(["x"] * DEPTH), 0.5 * DEPTH),
        ("LINEAR", "x" + "*2/2" * (DEPTH // 2), 0.5),
        ("LINEAR", "x" + "+(0" * DEPTH + ")" * DEPTH, 0.5),
    ],
    ids=["parentheses", "minus", "minus and parentheses", "sum", "products", "nested sums"],
)
def test_arithmetic(section, expression, value):
    loaded = model(section, f"z = {expression};", "REAL z;")
    for form in (loaded.dha, loaded.mld):
        assert form.step([0.5, 1])[3] == pytest.approx([value])


@pytest.mark.parametrize(
    "expression",
    [
        "(" * DEPTH + "b" + ")" * DEPTH,
        "~" * DEPTH + "b",
        "~(" * DEPTH + "b" + ")" * DEPTH,
        " & ".join(["b"] * DEPTH),
        "b & (" * DEPTH + "b" + ")" * DEPTH,
        " | ".join(["b"] * DEPTH),
    ],
    ids=["parentheses", "not", "not and parentheses", "and", "nested and", "or"],
)
def test_logic(expression):
    loaded = model("LOGIC", f"d = {expression};", "BOOL d;")
    assert loaded.dha.step([0.5, 1])[2] == [1.0]
    assert loaded.dha.step([0.5, 0])[2] == [0.0]


@pytest.mark.parametrize("arrow", ["->", "<-", "<->"])
def test_chain_of_arrows(arrow):
    loaded = model("LOGIC", f"d = b{f' {arrow} b' * (DEPTH - 1)};", "BOOL d;")
    # Arrows associate to the left, so an even chain of implications of one name by itself is true.
    assert loaded.dha.step([0.5, 1])[2] == [1.0]


def test_mld_of_deep_logic():
    loaded = model("LOGIC", f"d = {'~' * DEPTH}b;", "BOOL d;")
    assert loaded.mld.step([0.5, 1])[2] == [1.0]


def test_unclosed_parentheses_are_one_error():
    with pytest.raises(hys.CompileError) as caught:
        model("LINEAR", "z = " + "(" * DEPTH + "x;", "REAL z;")
    assert [d.code.value for d in caught.value.diagnostics] == ["HYS102"]
    assert len(str(caught.value)) < 2000


def test_deep_syntax_trees_can_be_dropped():
    """Freeing a deep structure must not overflow the stack of the interpreter either."""
    loaded = model("LINEAR", f"z = {'-' * (4 * DEPTH)}x;", "REAL z;")
    del loaded


def test_choices_inside_choices():
    depth = 500  # each one is a variable of its own
    loaded = model("DA", "z = " + "{IF b THEN " * depth + "x" + "}" * depth + ";", "REAL z;")
    assert loaded.dha.step([0.5, 1])[3][0] == 0.5
    assert loaded.dha.step([0.5, 0])[3][0] == 0.0


def test_casts_and_comparisons_inside_each_other():
    depth = 500
    loaded = model("LOGIC", "d = " + "((REAL " * depth + "b" + ") >= 1)" * depth + ";", "BOOL d;")
    assert loaded.dha.step([0.5, 1])[2][0] == 1.0


def test_chain_of_comparisons():
    loaded = model("LOGIC", f"d = x{' <= x' * DEPTH};", "BOOL d;")
    assert len(loaded.typed.items) == 3
