"""The canonical layout: it is what the page shows, it is stable, and it means the same."""

import random
import re
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, example, given, settings
from hypothesis import strategies as st
from strategies import models

from hysdel_py import CompileError
from hysdel_py.compiler import analyse
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.shipped import shipped_models
from hysdel_py.syntax.formatter import format_text
from hysdel_py.syntax.parser import parse
from hysdel_py.syntax.source import Source
from hysdel_py.syntax.tokens import tokenize
from hysdel_py.syntax.wrapping import WIDTH

DATA = Path(__file__).parents[1] / "data"
FILES = sorted([*DATA.rglob("*.hys"), *shipped_models().values()])


def read(path):
    data = path.read_bytes()
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def tree(text):
    return parse(Source("text", text), Sink())


def words(text):
    return [(token.kind, " ".join(token.text.split())) for token in tokenize(text)]


def declared(text):
    """What comments say about the declarations."""
    try:
        return [(s.name, s.unit, s.description) for s in analyse(text, {})[0].symbols]
    except CompileError:
        return None


def item(code, section="LINEAR"):
    """The lines of one item in the canonical layout."""
    lines = format_text(f"SYSTEM s {{ IMPLEMENTATION {{ {section} {{ {code} }} }} }}").split("\n")
    return [line.removeprefix("      ") for line in lines[3:-4]]


def check(text):
    formatted = format_text(text)
    assert format_text(formatted) == formatted
    assert words(formatted) == words(text)
    assert tree(formatted) == tree(text)
    assert declared(formatted) == declared(text)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_files_keep_their_meaning(path):
    check(read(path))


@pytest.mark.parametrize("path", shipped_models().values(), ids=lambda path: path.stem)
def test_shipped_models_are_formatted(path):
    assert format_text(read(path)) == read(path)


def test_layout():
    text = """SYSTEM s{/* head */INTERFACE{STATE{REAL a/* no */,b;/* [m] b */BOOL c
      ;/* not c */}

    PARAMETER{REAL k=-2^-1,longer=1e-3;//two
    REAL m = 3; /* three */}}


    IMPLEMENTATION{AD{}LOGIC{

    d=~a&(b|c->d);


    e = TRUE; /* one
                 two */
    }}} // end"""
    assert (
        format_text(text)
        == """SYSTEM s {   /* head */
  INTERFACE {
    STATE {
      REAL a /* no */, b;   /* [m] b */
      BOOL c;
      /* not c */
    }

    PARAMETER {
      REAL k = -2^-1, longer = 1e-3;   //two
      REAL m = 3;                      /* three */
    }
  }

  IMPLEMENTATION {
    AD {}
    LOGIC {
      d = ~a & (b | c -> d);

      e = TRUE;   /* one
                     two */
    }
  }
}   // end
"""
    )


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("z=-(-x)+--1*(REAL b)-sin( pi*x )/2;", "z = -(-x) + --1*(REAL b) - sin(pi*x)/2;"),
        ("d=x<=3 [ -1,2 , 1e-6 ];", "d = x <= 3 [-1, 2, 1e-6];"),
        ("z={IF(a|b)THEN-x[0,1,2]ELSE 2};", "z = {IF (a | b) THEN -x [0, 1, 2] ELSE 2};"),
        ("z = 2 * - x ^ - 1;", "z = 2*-x^-1;"),
        ("~ a;", "~a;"),
        ("x ( 2 )=A (1,i+1) ;", "x(2) = A(1, i + 1);"),
        ("A=[1,.1;0,1] * x( 1 : n );", "A = [1, .1; 0, 1]*x(1:n);"),
        ("t2 . q=t1 .out;", "t2.q = t1.out;"),
        ("a+b==3;", "a + b == 3;"),
        ("a<-b;", "a <- b;"),
        ("a< -b;", "a < -b;"),
        ("a/ /* half */2;", "a/ /* half */ 2;"),
        ("REAL x(2)[0,1;-5,5],y;", "REAL x(2) [0, 1; -5, 5], y;"),
    ],
)  # fmt: skip
def test_spaces(code, expected):
    assert item(code) == [expected]


def test_loops_nest():
    assert item("FOR(i=1:n){FOR(j=1:m){z(i,j)=x(i);}}") == [
        "FOR (i = 1:n) {", "  FOR (j = 1:m) {", "    z(i, j) = x(i);", "  }", "}",
    ]  # fmt: skip


def test_long_items_break_at_the_weakest_operator():
    lines = item("d = " + " | ".join(f"long_name_{i} & other_name_{i}" for i in range(5)) + ";", "LOGIC")
    assert all(line.startswith("    | ") for line in lines[1:])
    assert not [line for line in lines if re.match(r"\s*&", line)]
    assert max(map(len, lines)) <= WIDTH - 6


def test_breaks_inside_parentheses_are_indented():
    terms = " + ".join(f"coefficient_{i}*x" for i in range(8))
    first, second, *_ = item(f"z = ts*({terms});")
    assert first.startswith("z = ts*(coefficient_0*x")
    assert second.startswith("      + coefficient_")


def test_choices_that_are_long_or_nested():
    assert item("z = {IF a THEN b ELSE {IF c THEN d ELSE e}};", "DA") == [
        "z = {IF a", "     THEN b", "     ELSE {IF c", "           THEN d", "           ELSE e}};",
    ]  # fmt: skip
    name = "n" * 60
    assert item(f"z = {{IF a THEN {name} ELSE {name}}};", "DA") == [
        "z = {IF a", f"     THEN {name}", f"     ELSE {name}}};",
    ]  # fmt: skip


def test_a_comment_in_the_middle_stays_with_its_line():
    assert item("REAL a, /* [m] a */\n b, /* b */ c\n /* own */ , d;", "AUX") == [
        "REAL a,   /* [m] a */", "     b, /* b */ c", "     /* own */, d;",
    ]  # fmt: skip


@pytest.mark.parametrize("text", ["", "  \n\n", "\r\n"])
def test_nothing_stays_nothing(text):
    assert format_text(text) == ""


@pytest.mark.parametrize(
    "text", ["/* open", "/* open *\n\n", "SYSTEM s { /*/", "a;;", "}}};", "{{{", "( ) ] ;", "a = {", "é # $", ";"]
)
def test_wrong_texts_are_no_fault(text):
    formatted = format_text(text)
    assert format_text(formatted) == formatted
    assert words(formatted) == words(text)


def test_line_ends_of_windows():
    text = read(shipped_models()["clutch"])
    assert format_text(text.replace("\n", "\r\n")) == text


COMMENTS = ("/* c */", "/* [m] two\n   lines */", "/**/", "/* a\t*/", "/*\n*/")
SPACES = ("", " ", "\n", "\n\n\n", "\t", "\r\n", "  \n   ")


@st.composite
def laid_out(draw):
    """A valid model with any white space and comments between its tokens."""
    tokens = tokenize(draw(models()))
    noise = random.Random(draw(st.integers(0, 2**32)))
    share = draw(st.sampled_from([0.0, 0.1, 0.5]))
    text = ""
    for token in tokens:
        for _ in range(3):
            text += noise.choice(SPACES)
            if noise.random() < share:
                text += noise.choice(COMMENTS)
        text += " " * (text[-1:].isalnum() or text[-1:] == "_") + token.text
    return text


FAST = (Phase.explicit, Phase.reuse, Phase.generate)  # texts of this size take minutes to shrink


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow], phases=FAST)
@given(laid_out())
def test_any_layout_keeps_its_meaning(text):
    check(text)


@settings(max_examples=15, deadline=None, phases=FAST)
@given(models(), st.integers(0, 1000))
def test_layout_without_comments_does_not_matter(text, seed):
    noise = random.Random(seed)
    other = re.sub(r"\s+", lambda _: noise.choice([" ", "\n", "\t "]), text)
    assert format_text(other) == format_text(text)


@given(
    st.lists(st.sampled_from([*"(){}[];,=-~ab\n ", "/* c */", "// l\n", "IF ", " THEN ", " AD ", "REAL "]), max_size=40)
)
@example(["{", ",", "/* c */"])
def test_formatting_any_tokens_is_stable(parts):
    formatted = format_text("".join(parts))
    assert format_text(formatted) == formatted


DEPTH = 10_000


@pytest.mark.parametrize(
    "code",
    [
        "(" * DEPTH + "x" + ")" * DEPTH,
        "~" * DEPTH + "x",
        "x" + "+(0" * DEPTH + ")" * DEPTH,
        "{IF b THEN 1 ELSE " * 2_000 + "0" + "}" * 2_000,
        "[" * DEPTH + "]" * DEPTH,
    ],
    ids=["parentheses", "not", "sums", "choices", "matrices"],
)
def test_depth(code):
    text = f"SYSTEM s {{ IMPLEMENTATION {{ LINEAR {{ z = {code}; }} }} }}"
    formatted = format_text(text)
    assert words(formatted) == words(text)
    assert len(formatted) < 10 * len(text)


def test_time_grows_with_length_only():
    """A file of a megabyte is formatted; four times the text takes about four times as long."""

    def seconds(terms):
        text = "SYSTEM s { IMPLEMENTATION { LINEAR { z = " + " + ".join(["x*2"] * terms) + "; } } }"
        start = time.process_time()
        format_text(text)
        return time.process_time() - start

    seconds(1000)
    assert seconds(8_000) < 16 * max(seconds(2_000), 0.01)
