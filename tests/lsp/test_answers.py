"""Questions of editors, asked as functions."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hysdel_py.errors import ArgumentError
from hysdel_py.lsp.completion import completions
from hysdel_py.lsp.document import Document
from hysdel_py.lsp.hover import hover
from hysdel_py.lsp.names import definition, references, rename
from hysdel_py.lsp.outline import outline_of
from hysdel_py.lsp.positions import Positions
from hysdel_py.lsp.symbols import entries
from hysdel_py.syntax.tokens import tokenize

TEXT = """SYSTEM tank {
  INTERFACE {
    PARAMETER { REAL area = 2, twice = 2*area; BOOL fast = TRUE; REAL open_value; }
    STATE { REAL level [0, twice]; /* [m] height */ BOOL open; }
    INPUT { REAL pump [0, 1]; }
    OUTPUT { REAL shown; }
  }
  IMPLEMENTATION {
    AUX { BOOL full; REAL leak; }
    AD { full = level >= 3; }
    DA { leak = {IF open THEN 0.1*level ELSE 0}; }
    CONTINUOUS { level = level + (pump - leak)/area; }
    AUTOMATA { open = full | open; }
    OUTPUT { shown = level; }
  }
}
"""


def at(text, words, inside):
    """Offset of `inside` within the first place of `words`."""
    return text.index(words) + words.index(inside)


def ask(function, words, inside, text=TEXT):
    return function(Document(text), at(text, words, inside))


def texts(spans):
    return [TEXT[span.start : span.end] for span in spans]


@pytest.mark.parametrize(
    ("words", "name", "parts"),
    [
        ("level = level", "level", ["**level**: real state in [0, 4] [m]", "height", "CONTINUOUS, line 12"]),
        ("full = level", "full", ["Boolean auxiliary variable", "full = level >= 3", "2 rows", "*full <= "]),
        ("twice = 2", "twice", ["**twice**: real parameter = 4"]),
        ("fast = TRUE", "fast", ["Boolean parameter = TRUE"]),
        ("open_value", "open_value", ["no value given"]),
        ("leak = {", "leak", ["real auxiliary variable in [0, 0.4]", "4 rows"]),
    ],
)
def test_hover(words, name, parts):
    shown = ask(hover, words, name)
    assert [part for part in parts if part not in shown] == []


@pytest.mark.parametrize(("words", "inside"), [("SYSTEM tank", "tank"), ("IF open", "IF"), ("0.1*", "0.1")])
def test_nothing_to_say(words, inside):
    assert ask(hover, words, inside) == ""
    assert ask(definition, words, inside) is None
    assert ask(references, words, inside) == ()


@pytest.mark.parametrize(
    ("old", "new", "shown"),
    [
        ("level >= 3", "level >= nothing", "**level**: real state in [0, twice] [m]"),
        ("level >= 3;", "level >= ;", "**level**: REAL, declared in STATE"),
    ],
)
def test_hover_in_a_wrong_text(old, new, shown):
    text = TEXT.replace(old, new)
    assert ask(hover, "REAL level", "level", text).startswith(shown)


def test_definition_and_references():
    declared = ask(definition, "THEN 0.1*level", "level")
    assert declared.start == at(TEXT, "REAL level", "level")
    uses = ask(references, "THEN 0.1*level", "level")
    assert texts(uses) == ["level"] * 6
    assert declared in uses
    behind = Document(TEXT)
    assert definition(behind, declared.end) == declared


def test_names_of_modules_are_left_alone():
    text = TEXT.replace("shown = level;", "shown = t1.level;")
    assert len(ask(references, "REAL level", "level", text)) == 5


def test_rename():
    spans = rename(Document(TEXT), at(TEXT, "REAL leak", "leak"), "loss")
    text = TEXT
    for span in reversed(spans):
        text = text[: span.start] + "loss" + text[span.end :]
    assert "leak" not in text
    assert Document(text).model is not None


@pytest.mark.parametrize(
    ("inside", "name", "message"),
    [
        ("level", "IF", "word of the language"),
        ("level", "sin", "word of the language"),
        ("level", "pump", "already in use"),
        ("level", "pi", "already in use"),
        ("level", "1a", "is not a name"),
        ("level", "a b", "is not a name"),
        ("REAL", "x", "no name here"),
    ],
)
def test_rename_refuses(inside, name, message):
    with pytest.raises(ArgumentError, match=message):
        rename(Document(TEXT), at(TEXT, "REAL level", inside), name)


def words_at(text):
    place = text.index("§")
    return {p.word for p in completions(Document(text.replace("§", "")), place)}


@pytest.mark.parametrize(
    ("old", "new", "some", "none"),
    [
        ("  INTERFACE {", "  § INTERFACE {", {"INTERFACE"}, {"AD", "level"}),
        ("    INPUT {", "    § INPUT {", {"STATE", "PARAMETER"}, {"AD", "REAL"}),
        ("    AD {", "    § AD {", {"AD", "MUST"}, {"STATE", "level"}),
        ("BOOL open; }", "BOOL open; § }", {"REAL", "BOOL"}, {"level", "sin"}),
        ("[0, twice]", "[0, §]", {"area", "sin"}, {"level", "BOOL"}),
        ("full = level", "§ full = level", {"full"}, {"leak", "level"}),
        ("level = level", "§ level = level", {"level"}, {"open", "leak"}),
        ("level >= 3", "lev§ >= 3", {"level", "pump", "area", "sqrt"}, {"shown", "AD", "IF"}),
        ("leak = {IF", "leak = {§ IF", {"IF"}, {"leak"}),
        ("IF open", "IF §", {"open", "full", "THEN"}, {"shown"}),
        ("shown = level;", "§", {"shown"}, {"level"}),
    ],
)
def test_completion(old, new, some, none):
    found = words_at(TEXT.replace(old, new, 1))
    assert some <= found
    assert not none & found


def test_symbols():
    found = entries(Document(TEXT))
    assert [entry.name for entry in found][:5] == ["PARAMETER", "STATE", "INPUT", "OUTPUT", "AUX"]
    assert [(c.name, c.detail, c.kind) for c in found[1].children] == [
        ("level", "REAL", "variable"), ("open", "BOOL", "variable"),
    ]  # fmt: skip
    assert TEXT[found[1].span.start : found[1].span.end].startswith("STATE {")
    assert TEXT[found[1].span.start : found[1].span.end].endswith("open; }")


def test_diagnostics():
    assert [d.code.value for d in Document(TEXT.replace("pump - leak", "pmup - leak")).diagnostics] == ["HYS201"]
    assert [d.code.value for d in Document("SYSTEM x").diagnostics] == ["HYS102"]
    assert [d.code.value for d in Document("").diagnostics] == ["HYS005"]
    unbounded = TEXT.replace("pump [0, 1]", "pump").replace("full = level", "full = pump")
    assert "HYS401" in [d.code.value for d in Document(unbounded).diagnostics]


@settings(deadline=None)
@given(st.text(alphabet=st.sampled_from("aé😀\n\r "), max_size=30), st.integers(0, 40))
def test_positions(text, offset):
    offset = min(offset, len(text))
    positions = Positions(text)
    line, column = positions.position(offset)
    assert line == text[:offset].count("\n")
    assert column == len(text[:offset].split("\n")[-1].encode("utf-16-le")) // 2
    if "\r" not in text:
        assert positions.offset(line, column) == offset


@settings(deadline=None)
@given(st.integers(0, len(TEXT)), st.integers(0, 40), st.integers(0, len(TEXT)))
def test_no_text_is_a_fault(start, length, offset):
    document = Document(TEXT[:start] + TEXT[start + length :])
    outline_of(tokenize(document.text), len(document.text))
    completions(document, offset)
    references(document, offset)
    entries(document)


def test_hover_over_a_vector():
    text = (
        "SYSTEM s { INTERFACE { STATE { REAL level(2) [0, 9]; /* [m] height */ } PARAMETER { REAL k(2) = [1; 2]; } }"
        " IMPLEMENTATION { CONTINUOUS { level = level - k; } } }"
    )
    shown = ask(hover, "level = level", "level", text)
    for part in ("**level**: 2 elements, real state [m]", "height", "- level(2) in [0, 9]", "CONTINUOUS, line 1"):
        assert part in shown
    assert "- k(2) = 2" in ask(hover, "- k;", "k", text)
