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
        ([("x <= 0;", "x < 0;")], [("HYS101", 10, 16)]),
        ([("0.5*z", "0.5*")], [("HYS102", 13, 26)]),
        ([("0.5*z", "+0.5*z")], [("HYS102", 13, 22)]),
        ([("x <= 0", "x == 0")], [("HYS102", 10, 16)]),
        ([("AD {", "AD { # now")], [("HYS101", 10, 10)]),
        ([("AD {", "AD { // don't\n")], [("HYS101", 10, 10)]),
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
        ([("AUX {", "LINEAR { } AUX {")], [("HYS102", 9, 16)]),
    ],
)  # fmt: skip
def test_mistakes(changes, errors):
    assert found(broken(*changes)) == errors


@pytest.mark.parametrize(
    ("old", "new"),
    [("a*u};", "a*u}"), ("STATE {", "state {"), ("d & b;", "d & b;;"), ("0.5*z", "+0.5*z"), ("a*u};", "a*u;"),
     ("x <= 0;", "x < 0;"), ("STATE {", "STATE"), ("CONTINUOUS", "Continous")],
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
        "/",
        "SYSTEM s { ",
        "STATE { ",
        "@\n",
        "d = ;\n",
    ],
)
@pytest.mark.parametrize("before", ["\n", "SYSTEM s { INTERFACE { ", GOOD[: GOOD.index("LOGIC { ")] + "LOGIC { "])
def test_garbage_costs_little(before, garbage):
    start = time.process_time()
    assert found(before + garbage * (60_000 // len(garbage)))
    assert time.process_time() - start < 3
