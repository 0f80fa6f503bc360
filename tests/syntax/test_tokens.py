"""Tokens cover every text, comments and unknown characters included."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hysdel_py.syntax.parser import grammar_text
from hysdel_py.syntax.tokens import FUNCTION_WORDS, KEYWORDS, TokenKind, partner_of_brackets, tokenize


def kinds(text):
    return [(token.kind.value, token.text) for token in tokenize(text)]


def test_kinds():
    assert kinds("AD { d1 = 2.5e-3*x <= .5; }") == [
        ("keyword", "AD"), ("open", "{"), ("name", "d1"), ("operator", "="), ("number", "2.5e-3"), ("operator", "*"),
        ("name", "x"), ("operator", "<="), ("number", ".5"), ("separator", ";"), ("close", "}"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a<->b", ["a", "<->", "b"]),
        ("a<-b", ["a", "<-", "b"]),
        ("a == b", ["a", "==", "b"]),
        ("x(1:n)", ["x", "(", "1", ":", "n", ")"]),
        ("t1.out", ["t1", ".", "out"]),
        ("/* open", ["/* open"]),
        ("/**/ // x /* y\nz", ["/**/", "// x /* y", "z"]),
        ("a # é", ["a", "#", "é"]),
    ],
)
def test_texts(text, expected):
    assert [token.text for token in tokenize(text)] == expected


@given(st.text(alphabet=st.sampled_from("ab1.e/*<->={}()[];,\n\r\t #&é"), max_size=60))
def test_tokens_and_white_space_are_the_text(text):
    end = 0
    for token in tokenize(text):
        between = text[end : token.start]
        assert not between.strip(" \t\r\n")
        assert token.newlines == len(
            between.replace("\r\n", "\n").replace("\r", "\n").replace(" ", "").replace("\t", "")
        )
        assert text[token.start : token.end] == token.text
        end = token.end
    assert not text[end:].strip(" \t\r\n")


def test_keywords_are_those_of_the_grammar():
    import re

    words = set(re.findall(r'"([A-Z]+)"', grammar_text()))
    assert words <= KEYWORDS
    pattern = re.search(r"FUNCTION\S*: /\(([a-z0-9|]+)\)", grammar_text())
    assert pattern is not None
    assert set(pattern[1].split("|")) <= FUNCTION_WORDS


def test_partners():
    tokens = tokenize("{ ( a ] ) } }")
    assert partner_of_brackets(tokens) == {0: 5, 1: 4}
    assert tokens[0].kind is TokenKind.OPEN
