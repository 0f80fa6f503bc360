"""Tables of the parser on disk: the same parser, read only where they belong to it."""

import sys
from pathlib import Path

import pytest
from lark import Lark

from hysdel_py.diagnostics.sink import Sink
from hysdel_py.shipped import locate, shipped_models
from hysdel_py.syntax import parser, parser_tables
from hysdel_py.syntax.dialect import Dialect
from hysdel_py.syntax.parser import grammar_text, parse
from hysdel_py.syntax.reader import read_source
from hysdel_py.syntax.tree_to_ast import TreeToAst

BAD = Path(__file__).parents[1] / "data" / "bad"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Where the tables are kept, empty as yet."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(parser_tables, "cache_from_source", lambda _: str(tmp_path / "parser_tables.pyc"))
    return tmp_path


@pytest.fixture
def built(monkeypatch):
    """How often the tables are worked out."""
    seen = []
    build = Lark.__init__

    def counted(self, *args, **options):
        seen.append(options)
        build(self, *args, **options)

    monkeypatch.setattr(Lark, "__init__", counted)
    return seen


def made(grammar=None, name="hysdel_2"):
    return parser_tables.parser_of(grammar_text() if grammar is None else grammar, name, TreeToAst())


def test_tables_are_worked_out_once(folder, built):
    made()
    made()
    assert len(built) == 1
    assert [path.suffix for path in folder.iterdir()] == [".lark"]


def readings(texts, lark, monkeypatch):
    """Trees and diagnostics of texts."""
    monkeypatch.setattr(parser, "_lark", lambda dialect, extensions: lark)
    found = []
    for text in texts:
        sink = Sink()
        source = read_source(text, sink)
        found.append((parse(source, sink), sink.diagnostics))
    return found


def test_tables_that_were_read_give_the_same_trees_and_the_same_mistakes(folder, monkeypatch):
    texts = [*map(locate, shipped_models()), *sorted(BAD.glob("*.hys"))]
    fresh, kept = readings(texts, made(), monkeypatch), readings(texts, made(), monkeypatch)
    assert fresh == kept
    assert any(system for system, _ in fresh)
    assert any(mistakes for _, mistakes in fresh)


def test_another_grammar_has_other_tables(folder, built):
    made()
    other = parser.grammar_of(Dialect.HYSDEL_3, grammar_text())
    made(other)
    made(other)
    assert len(built) == 2


@pytest.mark.parametrize("place", [0, 40, -1])
def test_a_damaged_file_is_not_used_but_replaced(folder, built, place):
    made()
    (path,) = folder.iterdir()
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)
    made()
    made()
    assert len(built) == 2


def test_a_file_that_was_cut_off_is_not_used(folder, built):
    made()
    (path,) = folder.iterdir()
    path.write_bytes(path.read_bytes()[:1000])
    made()
    assert len(built) == 2


def test_nothing_is_written_where_python_writes_no_byte_code(folder, monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    made()
    assert not list(folder.iterdir())


def test_without_a_place_the_tables_are_worked_out_anew(folder, built, monkeypatch):
    monkeypatch.setattr(parser_tables, "cache_from_source", lambda _: str(folder / "nowhere" / "parser_tables.pyc"))
    made()
    made()
    assert len(built) == 2
    assert not list(folder.iterdir())


def test_a_python_that_keeps_no_byte_code_reads_models_all_the_same(monkeypatch):
    monkeypatch.setattr(sys.implementation, "cache_tag", None)
    assert made().parse


def test_a_lark_that_cannot_read_them_makes_them_anew(folder, built, monkeypatch):
    made()

    def refuse(*_, **__):
        raise TypeError("other arguments")

    monkeypatch.setattr(Lark, "_load", refuse)
    made()
    assert len(built) == 2
