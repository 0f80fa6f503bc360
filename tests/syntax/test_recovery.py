"""Several mistakes in one file: each is reported once and at its place, and nothing correct is."""

import time

import pytest

import hysdel_py as hys
from hysdel_py.syntax.recovery import MAX_SYNTAX_ERRORS

GOOD = """SYSTEM s {
  INTERFACE {
    STATE { REAL x [-1, 1]; BOOL b; }
    INPUT { REAL u [0, 1]; }
    OUTPUT { REAL y; }
    PARAMETER { REAL a = 2; }
  }
  IMPLEMENTATION {
    AUX { REAL z; BOOL d, e; }
    AD { d = x <= 0; }
    LOGIC { e = d & b; }
    DA { z = {IF e THEN x ELSE a*u}; }
    CONTINUOUS { x = 0.5*z; }
    AUTOMATA { b = d; }
    OUTPUT { y = z; }
    MUST { x <= 1; }
  }
}
"""


def found(text):
    """(code, line, column) of all errors, in the order of the report."""
    try:
        model = hys.load(text)
        _ = model.mld
    except hys.CompileError as error:
        return [(d["code"], d.get("line"), d.get("column")) for d in error.data if d["severity"] == "error"]
    return []


def broken(*changes):
    """The good model with some texts exchanged."""
    text = GOOD
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def test_good_model_is_good():
    assert found(GOOD) == []


@pytest.mark.parametrize(
    ("changes", "errors"),
    [
        # missing marks point at what lies before
        ([("a*u};", "a*u}")], [("HYS104", 12, 35)]),
        ([("e = d & b;", "e = d & b")], [("HYS104", 11, 21)]),
        ([("[-1, 1]; BOOL", "[-1, 1] BOOL")], [("HYS104", 3, 26)]),
        ([("a*u};", "a*u;")], [("HYS102", 12, 35)]),
        ([("{IF e", "{IF (e")], [("HYS102", 12, 21)]),
        ([("BOOL b; }", "BOOL b; ")], [("HYS105", 3, 11)]),
        ([("e = d & b; }", "e = d & b;")], [("HYS105", 11, 11)]),
        ([("REAL a = 2; }\n  }", "REAL a = 2; }\n")], [("HYS105", 2, 13)]),
        ([("STATE {", "STATE")], [("HYS102", 3, 11)]),
        # surplus marks
        ([("d & b;", "d & b;;")], [("HYS102", 11, 23)]),
        ([("d & b;", "d & b);")], [("HYS102", 11, 22)]),
        ([("2; }\n  }", "2; }\n  } }")], [("HYS102", 7, 5)]),
        ([("d, e;", "d,, e;")], [("HYS102", 9, 26)]),
        ([("MUST { x", "MUST @ x")], [("HYS101", 16, 10)]),
        ([("y = z;", "} = z;")], [("HYS102", 15, 16)]),
        # keywords
        ([("STATE {", "state {")], [("HYS106", 3, 5)]),
        ([("REAL x", "Real x")], [("HYS106", 3, 13)]),
        ([("CONTINUOUS", "CONTINOUS")], [("HYS106", 13, 5)]),
        ([("INTERFACE", "Interface")], [("HYS106", 2, 3)]),
        ([("IF e THEN", "if e then")], [("HYS106", 12, 15), ("HYS106", 12, 20)]),
        ([("LOGIC {", "SOMETHING {")], [("HYS102", 11, 5)]),
        # expressions
        ([("x <= 0;", "x \u2264 0;")], [("HYS101", 10, 16)]),
        ([("x <= 0;", "x =< 0;")], [("HYS102", 10, 16)]),
        ([("0.5*z", "0.5*")], [("HYS102", 13, 26)]),
        ([("0.5*z", "+0.5*z")], [("HYS102", 13, 22)]),
        ([("x <= 0", "x = 0")], [("HYS102", 10, 16)]),
        ([("AD {", "AD { # now")], [("HYS101", 10, 10)]),
        ([("AD {", "AD { % don't\n")], [("HYS101", 10, 10)]),
        # several at once, syntax and meaning mixed, in the order of the file
        (
            [("x <= 0;", "x <= ;"), ("d & b;", "d & ;"), ("0.5*z", "0.5*")],
            [("HYS102", 10, 19), ("HYS102", 11, 21), ("HYS102", 13, 26)],
        ),
        (
            [("x <= 0;", "x <= ;"), ("d & b", "d & x"), ("0.5*z", "0.5*z*u"), ("y = z;", "y = z")],
            [("HYS102", 10, 19), ("HYS301", 11, 21), ("HYS302", 13, 22), ("HYS104", 15, 18)],
        ),
        # what is skipped is not missed later
        ([("REAL u [0, 1];", "REAL u [0, 1;")], [("HYS102", 4, 25)]),
        ([("REAL u [0, 1];", "REAL u [0 1];")], [("HYS102", 4, 23)]),
        ([("REAL z; BOOL d, e;", "REAL z; BOOL d e;")], [("HYS102", 9, 26)]),
        ([("PARAMETER {", "AUX { REAL q; } PARAMETER {")], [("HYS102", 6, 5)]),
    ],
)  # fmt: skip
def test_mistakes(changes, errors):
    assert found(broken(*changes)) == errors


@pytest.mark.parametrize(
    ("changes", "errors"),
    [
        # matrices and vectors: a semicolon may part rows, so the end of the item has to be found
        ([("x <= 0;", "x <= [1, 2; 3, 4;"), ("y = z", "y = ")], [("HYS102", 10, 30), ("HYS102", 15, 18)]),
        ([("x <= 0;", "x <= [1, [2; 3];")], [("HYS102", 10, 29)]),
        ([("x <= 0; }", "x <= [1, 2;\nd = x(1) <= 2;\n}")], [("HYS102", 10, 24)]),
        ([("x <= 0; }", "x <= [1;\ne(1) = x <= 2;\n}"), ("y = z", "y = ")], [("HYS102", 10, 21), ("HYS102", 17, 18)]),
        ([("x <= 0;", "x <= [1 2];")], [("HYS102", 10, 22)]),
        ([("x [-1, 1]", "x(2) [-1, 1; -2, 2"), ("y = z", "y = ")], [("HYS102", 3, 36), ("HYS102", 15, 18)]),
        ([("x <= 0;", "x(1:2;"), ("y = z", "y = ")], [("HYS102", 10, 19), ("HYS102", 15, 18)]),
        # loops
        ([("LOGIC {", "LOGIC { FOR (i=1:2) e = b; }"), ("y = z", "y = ")], [("HYS102", 11, 25), ("HYS102", 15, 18)]),
        ([("LOGIC {", "LOGIC { FOR (i=1:2) { e = b;"), ("y = z", "y = ")], [("HYS105", 11, 25), ("HYS102", 15, 18)]),
        ([("LOGIC {", "LOGIC { FOR (i=1 2) { e = b; }"), ("y = z", "y = ")], [("HYS102", 11, 22), ("HYS102", 15, 18)]),
        ([("LOGIC {", "LOGIC { for (i=1:2) { e = b; }"), ("y = z", "y = ")], [("HYS102", 11, 19), ("HYS102", 15, 18)]),
        ([("AUX {", "AUX { index i;"), ("y = z", "y = ")], [("HYS106", 9, 11), ("HYS102", 15, 18)]),
        # nested choices
        ([("ELSE a*u}", "ELSE {IF d THEN 1 ELSE 2}"), ("y = z", "y = ")], [("HYS102", 12, 52), ("HYS102", 15, 18)]),
        ([("THEN x", "THEN {IF d THEN 1 ELSE 2"), ("y = z", "y = ")], [("HYS102", 12, 45), ("HYS102", 15, 18)]),
        ([("IF e THEN x", "IF e + THEN {IF d THEN 1}"), ("y = z", "y = ")], [("HYS102", 12, 22), ("HYS102", 15, 18)]),
        ([("AUX {", "AUX { INDEX + i;"), ("y = z", "y = ")], [("HYS102", 9, 11), ("HYS102", 15, 18)]),
    ],
)  # fmt: skip
def test_mistakes_in_vectors_loops_and_nested_choices(changes, errors):
    """What is repaired may have other sizes than its surroundings; only syntax is looked at here."""
    assert [e for e in found(broken(*changes)) if e[0].startswith("HYS10")] == errors


@pytest.mark.parametrize(
    ("old", "new"),
    [("a*u};", "a*u}"), ("STATE {", "state {"), ("d & b;", "d & b;;"), ("0.5*z", "+0.5*z"), ("a*u};", "a*u;"),
     ("x <= 0;", "x \u2264 0;"), ("STATE {", "STATE"), ("CONTINUOUS", "Continous"), ("[-1, 1]", "[-1, 1"),
     ("[-1, 1]", "[-1 1]")],
)  # fmt: skip
def test_fixes_repair(old, new):
    text = broken((old, new))
    with pytest.raises(hys.CompileError) as caught:
        hys.load(text)
    for fix in sorted((f for d in caught.value.diagnostics for f in d.fixes), reverse=True):
        text = text[: fix.span.start] + fix.replacement + text[fix.span.end :]
    assert found(text) == []
    assert hys.load(text).mld.describe() == hys.load(GOOD).mld.describe()


def test_fixes_are_shown_and_are_data():
    with pytest.raises(hys.CompileError) as caught:
        hys.load(broken(("a*u};", "a*u}")))
    assert "fix: insert ';'" in str(caught.value)
    (fix,) = caught.value.data[0]["fixes"]
    assert fix == {"replacement": ";", "line": 12, "column": 36, "end_line": 12, "end_column": 36}


@pytest.mark.parametrize(
    ("old", "new", "said", "unsaid"),
    [
        ("LOGIC {", "LOGIC { 1", "expected a name or '}', found '1'", "FOR"),
        ("AUX {", "AUX { 1", "expected 'BOOL', 'INDEX' or 'REAL', found '1'", "a name"),
        ("AUX {", "AUX { INDEX + i;", "expected a name behind INDEX", "found"),
        ("AUX {", "AUX { INDEX/* */i;", "no comment may stand behind INDEX", "capitals"),
        ("PARAMETER {", "MODULE t { } PARAMETER {", "expected '{' behind MODULE", "found"),
        ("x <= 0;", "x = 0;", "equal is written ==", "semicolon"),
        ("x <= 0;", "[1, 2; 3, 4;", "expected an operator, ',' or ']', found ';'", "semicolon"),
        ("x <= 0;", "[1, 2; 3, 4;", "opened here", "semicolon"),
        ("x <= 0;", "x <= [1, 2)];", "found ')'", "semicolon"),
        ("x <= 0;", "x * <= 0;", "expected an expression, found '<='", "belong"),
        ("LOGIC {", "LOGIC { for (i=1:2) { e = b; }", "keywords are written in capitals: FOR", "=="),
    ],
)
def test_messages(old, new, said, unsaid):
    with pytest.raises(hys.CompileError) as caught:
        hys.load(broken((old, new)))
    (diagnostic,) = (d for d in caught.value.diagnostics if d.code.value.startswith("HYS10"))
    text = " / ".join((diagnostic.message, diagnostic.help, *(label.text for label in diagnostic.labels)))
    assert said in text
    assert unsaid not in text


def test_unclosed_brace_is_found_by_indentation():
    text = GOOD.replace("    MUST { x <= 1; }\n  }\n", "    MUST { x <= 1; }\n")
    assert found(text) == [("HYS105", 8, 18)]


def test_every_single_missing_token_is_one_syntax_error():
    """Dropping any one mark gives one syntax error at most, and no other of any kind."""
    for mark in ";{}()[],=":
        for index in (i for i, c in enumerate(GOOD) if c == mark):
            errors = found(GOOD[:index] + GOOD[index + 1 :])
            assert len(errors) <= 2, (mark, index, errors)
            assert not [e for e in errors if not e[0].startswith("HYS10")], (mark, index, errors)


def test_the_number_of_errors_is_limited():
    text = GOOD.replace("e = d & b;", "e = d & ;\n" * 500)
    errors = found(text)
    assert len(errors) == MAX_SYNTAX_ERRORS + 1
    assert errors[-1][0] == "HYS103"


@pytest.mark.parametrize(
    "garbage",
    [
        "#",
        "<>",
        "a ",
        "{",
        "}",
        ";",
        "(",
        "IF ",
        "\u2212",
        "._",
        "//",
        "/ ",
        "[",
        "[1; ",
        "d = [1; 2;",
        "d = x(",
        "FOR (i = 1:2) {",
        "d = {IF b THEN ",
        "SYSTEM s { ",
        "STATE { ",
        "@\n",
        "d = ;\n",
    ],
)
@pytest.mark.parametrize("before", ["\n", "SYSTEM s { INTERFACE { ", GOOD[: GOOD.index("LOGIC { ")] + "LOGIC { "])
def test_garbage_costs_little(before, garbage):
    start = time.process_time()
    only_a_comment = not before.strip() and garbage == "//"
    assert bool(found(before + garbage * (60_000 // len(garbage)))) != only_a_comment
    assert time.process_time() - start < 3
