"""Queries are words of the language only where a file asks for them."""

import pytest

import hysdel_py as hys
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lsp.completion import completions
from hysdel_py.lsp.document import Document
from hysdel_py.semantics.expressions import children
from hysdel_py.syntax.extension import Extension, stated_extensions
from hysdel_py.syntax.formatter import format_text
from hysdel_py.syntax.parser import parse
from hysdel_py.syntax.source import Source

ON = "/* extension: queries */\n"
TEXT = """SYSTEM tank {
  INTERFACE { STATE { REAL level [0, 1]; BOOL shut; } INPUT { REAL q [0, 0.2]; } OUTPUT { REAL y; } }
  IMPLEMENTATION {
    AUX { BOOL high; } AD { high = level >= 0.3; }
    CONTINUOUS { level = 0.5*level + q; } AUTOMATA { shut = high; } OUTPUT { y = level; }
    QUERIES { %s }
  }
}
"""
QUERIES = (
    "NEVER y >= 0.35 WITHIN 20 FROM level <= 0.1 & ~shut;",
    "ALWAYS (level < 0.45) WITHIN 2*10;",
    "EVENTUALLY high | -2^2*level + (1 - 0.5)/2 > 0.1 WITHIN 5;",
    "NEVER (high -> shut) <-> (shut | ~(high & shut)) WITHIN 3;",
    "NEVER (high -> shut) -> (REAL high & shut) - (level - q) <= -1e-3 WITHIN 3;",
)


def parsed(text):
    sink = Sink()
    system = parse(Source("text", text), sink)
    assert not sink.failed
    return system


@pytest.mark.parametrize("query", QUERIES)
def test_layout_keeps_queries(query):
    text = ON + TEXT % query
    formatted = format_text(text)
    assert parsed(formatted) == parsed(text)
    assert format_text(formatted) == formatted


@pytest.mark.parametrize("dialect", ["hysdel 2", "hysdel 3"])
@pytest.mark.parametrize("query", QUERIES)
def test_what_is_printed_is_read_back(query, dialect):
    front = f"/* dialect: {dialect} */" + ON
    (first,) = hys.load(front + TEXT % query).typed.queries
    (again,) = hys.load(front + TEXT % (first.text + ";")).typed.queries
    assert again.text == first.text
    assert (again.kind, again.steps) == (first.kind, first.steps)
    assert bare(again.condition) == bare(first.condition)


def bare(expression):
    """An expression without the numbers of the lines of its symbols."""
    inner = tuple(map(bare, children(expression)))
    return (inner and (expression.op, *inner)) or getattr(expression, "symbol", expression)


def test_words_of_queries_are_names_elsewhere():
    text = """SYSTEM s { INTERFACE { STATE { REAL NEVER [0, 1], WITHIN [0, 1]; } }
      IMPLEMENTATION { AUX { REAL QUERIES; } LINEAR { QUERIES = NEVER; }
      CONTINUOUS { NEVER = WITHIN; WITHIN = QUERIES; } } }"""
    assert hys.load(text).dha.step([0, 1])[0].tolist() == [1, 0]


@pytest.mark.parametrize(
    ("front", "asked"), [(ON, True), ("// Extension:  QUERIES\n", True), ("/* extensions */", False)]
)
def test_ways_to_state_it(front, asked):
    assert (Extension.QUERIES in stated_extensions(Source("text", front + "SYSTEM"), Sink())) is asked


def test_forms_do_not_change():
    plain = hys.load("\n" + TEXT.replace("QUERIES { %s }", ""))
    asked = hys.load(ON + TEXT % QUERIES[0])
    assert asked.mld.describe() == plain.mld.describe()


def test_what_only_a_query_reads_is_used():
    text = ON + (TEXT % "NEVER high WITHIN 3;").replace("shut = high", "shut = shut")
    assert not [d for d in hys.load(text).diagnostics if d.severity.value == "warning"]


def test_editor_proposes_queries_where_they_are_asked_for():
    text = ON + TEXT % "NEVER  WITHIN 3;"
    place = text.index("NEVER ")
    assert {"NEVER", "ALWAYS", "EVENTUALLY"} <= {p.word for p in completions(Document(text), place)}
    inside = {p.word for p in completions(Document(text), place + 6)}
    assert {"level", "y", "high", "WITHIN"} <= inside
    section = text.index("AUX")
    assert "QUERIES" in {p.word for p in completions(Document(text), section)}
    assert "QUERIES" not in {p.word for p in completions(Document(TEXT % ""), section - len(ON))}
