import json

import pytest

import hysdel_py as hys
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic, Label, Severity
from hysdel_py.diagnostics.render import as_data, render
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.source import Source, Span

SOURCE = Source("m.hys", "first\n\tsecond line\nthird")


def error(span, **more):
    return Diagnostic(Code.UNDECLARED, Severity.ERROR, "no", span, **more)


def test_place_is_line_and_column_and_carets():
    text = render(error(Span(14, 18), help="do this", labels=(Label(Span(0, 5), "see here"),)), SOURCE)
    assert text == (
        "error[HYS201]: no\n"
        " --> m.hys:2:9\n"
        "  |\n"
        "2 |  second line\n"
        "  |         ^^^^\n"
        "  see here:\n"
        " --> m.hys:1:1\n"
        "  |\n"
        "1 | first\n"
        "  | -----\n"
        "  help: do this\n"
    )


def test_span_over_several_lines_is_marked_in_the_first():
    lines = render(error(Span(0, 20)), SOURCE).splitlines()
    assert lines[3:] == ["1 | first", "  | ^^^^^"]


def test_very_long_line_is_cut_around_the_column():
    source = Source("m.hys", "x" * 5000 + "?" + "y" * 5000)
    lines = render(error(Span(5000, 5001)), source).splitlines()
    shown, marks = lines[3], lines[4]
    assert len(shown) < 140
    assert shown[marks.index("^")] == "?"


def test_diagnostic_of_the_whole_file():
    assert render(error(None), SOURCE) == "error[HYS201]: no\n  --> m.hys\n"


def test_data_is_json_with_one_based_places():
    data = json.loads(json.dumps(as_data(error(Span(6, 13)), SOURCE)))
    assert (data["line"], data["column"], data["end_line"], data["end_column"]) == (2, 1, 2, 8)
    assert data["code"] == "HYS201"
    assert data["severity"] == "error"


def test_sink_sorts_by_place_and_drops_repeats():
    sink = Sink()
    for span in (Span(9, 10), Span(2, 3), Span(9, 10), None):
        sink.warning(Code.UNUSED, "w", span)
    assert [d.span for d in sink.diagnostics] == [None, Span(2, 3), Span(9, 10)]
    assert not sink.failed


def test_warnings_do_not_raise_and_notes_are_not_shown_with_errors():
    sink = Sink()
    sink.note(Code.EXTENSION, "n")
    sink.warning(Code.UNUSED, "w")
    sink.raise_errors(SOURCE)
    sink.error(Code.UNDECLARED, "e")
    with pytest.raises(hys.CompileError) as caught:
        sink.raise_errors(SOURCE)
    assert {d.severity for d in caught.value.diagnostics} == {Severity.ERROR, Severity.WARNING}
    assert "error[HYS201]: e" in str(caught.value)


def test_codes_are_distinct_and_well_formed():
    values = [code.value for code in Code]
    assert len(set(values)) == len(values)
    assert all(len(value) == 6 and value.startswith("HYS") and value[3:].isdigit() for value in values)
