"""Rows of each kind of item, in order, and the treatment of constants."""

import pytest

import hysdel_py as hys
from hysdel_py.systems.describe import inequalities


def load(implementation, outputs="REAL y; BOOL w;"):
    interface = f"STATE {{ REAL x [-2, 3]; BOOL b; }} INPUT {{ REAL u [0, 1]; BOOL v; }} OUTPUT {{ {outputs} }}"
    return hys.load(f"SYSTEM s {{ INTERFACE {{ {interface} }} IMPLEMENTATION {{ {implementation} }} }}")


def rows(implementation, **options):
    return list(inequalities(hys.to_mld(load(implementation), big_m="interval", **options)))


@pytest.mark.parametrize(
    ("implementation", "expected"),
    [
        ("AUX { BOOL d; } AD { d = x <= 1; }", ["-3.000001*d <= x - 1.000001", "2*d <= -x + 3"]),
        ("AUX { BOOL d; } AD { d = x >= 1; }", ["-2.000001*d <= -x + 0.999999", "3*d <= x + 2"]),
        ("AUX { BOOL d; } AD { d = x <= 0 [9, -9, 0.5]; }", ["-9.5*d <= x - 0.5", "9*d <= -x + 9"]),
        (
            "AUX { REAL z; } DA { z = {IF b THEN x ELSE u}; }",
            ["-z <= -3*b - x + 3", "z <= -3*b + x + 3", "-z <= -u + 3*b", "z <= u + 3*b"],
        ),
        (
            "AUX { REAL z; } DA { z = {IF ~b THEN x ELSE u}; }",
            ["-z <= -u - 3*b + 3", "z <= u - 3*b + 3", "-z <= 3*b - x", "z <= 3*b + x"],
        ),
        (
            "AUX { REAL z; } DA { z = {IF b THEN x}; }",
            ["-z <= -3*b - x + 3", "z <= -2*b + x + 2", "-z <= 2*b", "z <= 3*b"],
        ),
        ("AUX { REAL z; } DA { z = {IF b THEN 5 ELSE 1}; }", ["-z <= -4*b - 1", "z <= 4*b + 1"]),
        ("AUX { REAL z; } LINEAR { z = 2*x - u + 1; }", ["-z <= u - 2*x - 1", "z <= -u + 2*x + 1"]),
        ("AUX { BOOL d; } LOGIC { d = b & ~v; }", ["-d <= v - b", "d <= b", "d <= -v + 1"]),
        ("AUX { BOOL d; } LOGIC { d = TRUE; }", ["-d <= -1"]),
        ("MUST { x + u <= 1; }", ["0 <= -u - x + 1"]),
        ("MUST { x >= u; }", ["0 <= -u + x"]),
        ("MUST { b | v; }", ["0 <= v + b - 1"]),
        ("MUST { ~b; ~b; }", ["0 <= -b", "0 <= -b"]),
        ("MUST { TRUE; }", []),
        ("MUST { FALSE; }", ["0 <= -1"]),
        ("AUTOMATA { b = ~v; }", []),
        ("AUTOMATA { b = b & v; }", ["-__additional_1 <= -v - b + 1", "__additional_1 <= b", "__additional_1 <= v"]),
        ("CONTINUOUS { x = x + 1; }", []),
    ],
)
def test_rows_of_one_item(implementation, expected):
    found = rows(implementation)
    assert [_sorted(row) for row in found] == [_sorted(row) for row in expected]


def _sorted(row):
    """Both sides with their terms in alphabetical order."""
    sides = []
    for side in row.split(" <= "):
        terms = side.replace(" - ", " + -").split(" + ")
        sides.append(sorted(terms))
    return sides


def test_generated_definitions_come_after_all_items():
    found = [(row.item, row.defines, row.group, row.subgroup) for row in load(
        "AUX { REAL z; BOOL d; } DA { z = {IF b & v THEN x ELSE u}; } AD { d = x <= 1; } MUST { d; }"
    ).mld.rows]  # fmt: skip
    assert found == (
        [("DA", "z", 1, 1)] * 4 + [("AD", "d", 2, 1)] * 2 + [("Logic_must", "", 3, 1)]
        + [("Logic", "__additional_1", 1, 2)] * 3
    )  # fmt: skip


def test_one_counter_numbers_generated_booleans_and_reals():
    mld = hys.to_mld(load("CONTINUOUS { x = x + 1; } AUTOMATA { b = b & v; } OUTPUT { y = x + 2; }"), constants="aux")
    assert [v.name for v in mld.d] == ["__additional_2"]
    assert [v.name for v in mld.z] == ["__additional_1", "__additional_3"]
    assert not mld.B5.any()
    assert not mld.D5.any()


def test_constants_of_updates_and_outputs():
    model = load("CONTINUOUS { x = x + 1; } OUTPUT { y = 2; w = ~b; }")
    mld = model.mld
    assert mld.B5.tolist() == [1, 0]
    assert mld.D5.tolist() == [2, 1]
    assert mld.C.tolist() == [[0, 0], [0, -1]]
    aux = hys.to_mld(model, constants="aux")
    for x in ([1.0, 0.0], [-2.0, 1.0]):
        for ours, theirs in zip(mld.step(x, [0, 0])[:2], aux.step(x, [0, 0])[:2], strict=True):
            assert ours == pytest.approx(theirs)
    with pytest.raises(hys.CompileError, match="HYS403"):
        hys.to_mld(model, constants="forbid")


@pytest.mark.parametrize("text", ["x + 1 - 1", "x + 0", "x - (2 - 2)"])
def test_forbidden_constants_are_found_by_form(text):
    with pytest.raises(hys.CompileError, match="HYS403"):
        hys.to_mld(load(f"CONTINUOUS {{ x = {text}; }}"), constants="forbid")


@pytest.mark.parametrize("options", [{"big_m": "loose"}, {"constants": "no"}, {"big_m": None}])
def test_unknown_option(options):
    with pytest.raises(hys.ArgumentError, match=r"one of '.*' was expected"):
        hys.to_mld(load(""), **options)


def test_forms_are_read_only():
    mld = load("AUX { BOOL d; } AD { d = x <= 1; } CONTINUOUS { x = x; }").mld
    for matrix in (mld.A, mld.B5, mld.E5, mld.C):
        with pytest.raises(ValueError, match="read-only"):
            matrix[...] = 1


def test_model_too_large_for_dense_matrices_is_refused():
    names = [f"x{i}" for i in range(7100)]
    text = f"SYSTEM big {{ INTERFACE {{ STATE {{ REAL {', '.join(names)}; }} }} IMPLEMENTATION {{ }} }}"
    with pytest.raises(hys.CompileError, match="HYS406"):
        _ = hys.load(text).mld


def test_an_item_over_several_lines_has_the_line_of_its_first_token():
    mld = hys.load(
        "SYSTEM s {\nINTERFACE { STATE { REAL x [0, 1]; } }\n"
        "IMPLEMENTATION {\nAUX { BOOL d; }\nAD {\nd =\nx <= 0.5;\n}\n} }"
    ).mld
    assert {row.line for row in mld.rows} == {6}
    assert {row.text for row in mld.rows} == {"d = x <= 0.5"}
