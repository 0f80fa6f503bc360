"""Comparisons inside logic, strict ones, chains, equalities, and choices inside choices."""

import numpy as np
import pytest

import hysdel_py as hys

FRAME = """SYSTEM s {{
  INTERFACE {{ STATE {{ REAL x [-5, 5]; BOOL b; }} INPUT {{ REAL u [-5, 5]; }} PARAMETER {{ REAL limit = 1; }} }}
  IMPLEMENTATION {{ {} CONTINUOUS {{ x = 0.5*x + 0*u; }} AUTOMATA {{ b = b; }} }}
}}"""


def load(implementation):
    return hys.load(FRAME.format(implementation))


def value(model, name, x, b=0, u=0.0):
    """Value of an auxiliary, after checking that both forms agree on it."""
    _, _, d, z = model.dha.step([x, b], [u])
    for ours, theirs in zip((d, z), model.mld.step([x, b], [u])[2:], strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-9)
    return {v.name: a for v, a in zip((*model.dha.d, *model.dha.z), (*d, *z), strict=True)}[name]


def admits(model, x, b=0, u=0.0):
    """Whether both forms have a step."""
    verdicts = []
    for form in (model.dha, model.mld):
        try:
            form.step([x, b], [u])
            verdicts.append(True)
        except hys.SimulationError:
            verdicts.append(False)
    assert verdicts[0] == verdicts[1]
    return verdicts[0]


@pytest.mark.parametrize(
    ("comparison", "below", "at", "above"),
    [("x <= 3", 1, 1, 0), ("x >= 3", 0, 1, 1), ("x < 3", 1, 0, 0), ("x > 3", 0, 0, 1), ("3 > x", 1, 0, 0)],
)
@pytest.mark.parametrize("section", ["AD", "LOGIC"])
def test_threshold_itself(section, comparison, below, at, above):
    model = load(f"AUX {{ BOOL d; }} {section} {{ d = {comparison}; }}")
    assert [value(model, "d", x) for x in (2, 3, 4)] == [below, at, above]


def test_strict_comparison_is_the_negation_of_the_other_one():
    strict = load("AUX { BOOL d; } AD { d = x < 3; }")
    weak = load("AUX { BOOL d; } LOGIC { d = ~(x >= 3); }")
    assert strict.mld.describe() == weak.mld.describe().replace("d = ~(x >= 3)", "d = x < 3")


def test_condition_has_its_rows_behind_all_items():
    model = load("AUX { REAL z; } DA { z = {IF x >= limit THEN x ELSE 2*u}; } MUST { x <= 4; }")
    assert [row.item for row in model.mld.rows] == ["DA"] * 4 + ["Cont_must"] + ["AD"] * 2
    assert model.mld.rows[-1].defines == "__additional_1"
    assert [value(model, "z", x, u=1) for x in (0, 1, 2)] == [2, 1, 2]


def test_negated_comparison_is_a_literal():
    assert load("AUX { REAL z; } DA { z = {IF x < 1 THEN x ELSE u}; }").mld.nd == 1


def test_comparison_of_constants_is_a_truth_value():
    model = load("AUX { BOOL d; } LOGIC { d = b & (limit <= 2); }")
    assert model.mld.nd == 1
    assert value(model, "d", 0, b=1) == 1


@pytest.mark.parametrize(
    ("item", "rule"),
    [
        ("b -> (x <= 1)", lambda x, b, u: not b or x <= 1),
        ("(x <= 1) <-> (u >= 0)", lambda x, b, u: (x <= 1) == (u >= 0)),
        ("(x >= 0) | b", lambda x, b, u: x >= 0 or b),
        ("b <- x > 2", lambda x, b, u: b or x <= 2),
        ("~(x >= 1 & b)", lambda x, b, u: not (x >= 1 and b)),
        ("x <= 1 & (b | u <= 0)", lambda x, b, u: x <= 1 and (b or u <= 0)),
        ("-1 <= x + u <= 2", lambda x, b, u: -1 <= x + u <= 2),
        ("1 > x > u > -3", lambda x, b, u: 1 > x > u > -3),
        ("x == u + 1", lambda x, b, u: x == u + 1),
        ("(x == u)", lambda x, b, u: x == u),
        ("x < 2", lambda x, b, u: x < 2),
    ],
)
def test_requirement(item, rule):
    model = load(f"MUST {{ {item}; }}")
    verdicts = set()
    for x in (-4, -1, 0, 1, 2, 3):
        for b in (0, 1):
            for u in (-2, -1, 0, 1, 2):
                verdicts.add(admits(model, x, b, u))
                assert admits(model, x, b, u) == bool(rule(x, b, u)), (x, b, u)
    assert verdicts == {True, False}


@pytest.mark.parametrize(
    ("item", "rows"), [("0 <= x <= 1", 2), ("x == u", 2), ("x <= 1 & u <= 1 & b", 3), ("0 <= x <= u <= 3", 3)]
)
def test_conjunctions_of_comparisons_need_no_booleans(item, rows):
    mld = load(f"MUST {{ {item}; }}").mld
    assert (mld.nd, mld.ne) == (0, rows)


def test_choice_inside_a_choice():
    text = "AUX { REAL z; } DA { z = {IF b THEN {IF x >= 0 THEN x ELSE {IF u >= 0 THEN -x}} ELSE {IF x > 1 THEN 7}}; }"
    model = load(text)

    def meant(x, b, u):
        if b:
            return x if x >= 0 else (-x if u >= 0 else 0)
        return 7 if x > 1 else 0

    for x, b, u in [(2, 1, 0), (-2, 1, 1), (-2, 1, -1), (2, 0, 0), (1, 0, 0)]:
        assert value(model, "z", x, b, u) == meant(x, b, u)


def test_cast_of_a_comparison():
    model = load("AUX { REAL z; } LINEAR { z = 2*(REAL x <= 0) + (REAL ~b & (u >= 1)); }")
    assert value(model, "z", -1, u=2) == 3


def test_auxiliaries_in_several_places():
    model = load("AUX { BOOL d; } AD { d = x <= 0; } AUX { REAL z; } LINEAR { z = (REAL d); }")
    assert value(model, "z", -1) == 1


def test_line_comments_document_too():
    model = hys.load(
        "SYSTEM s { // /* not open\n INTERFACE { STATE { REAL x [0, 1]; // [m] level\n } } IMPLEMENTATION { } }"
    )
    assert (model.dha.x[0].unit, model.dha.x[0].description) == ("m", "level")


@pytest.mark.parametrize(
    "item", ["MUST { x; }", "MUST { b <= 1; }", "LOGIC { d = b == b; }", "MUST { b & (x == 1); d | x == 1; }"]
)
def test_refused(item):
    with pytest.raises(hys.CompileError):
        load(f"AUX {{ BOOL d; }} {item}")
