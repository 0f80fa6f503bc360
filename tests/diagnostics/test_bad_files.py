"""Every file under tests/data/bad gives exactly the diagnostics that its own comments announce."""

import pytest
from diagnostics.expectations import as_triples, bad_files, diagnostics_of, expected_in
from error_pages import example

from hysdel_py.diagnostics.codes import Code
from hysdel_py.syntax.source import Source

# Codes that no small file can cause, and the test that causes each.
ELSEWHERE = {
    Code.UNREADABLE: "test_reader.py",
    Code.NOT_TEXT: "test_reader.py",
    Code.NOT_UTF8: "test_reader.py",
    Code.TOO_LONG: "test_reader.py",
    Code.PARAMETER_UNKNOWN: "test_parameters.py",
    Code.TOO_MANY_ERRORS: "test_recovery.py",
    Code.TOO_LARGE: "test_mld_rows.py",
}
# Notes that many small models give on the side; a file that is about them announces them.
ON_THE_SIDE = {Code.UNUSED_PARAMETER, Code.MISSING_BOUNDS, Code.MUST_ALWAYS_HOLDS}


@pytest.mark.parametrize("path", bad_files(), ids=lambda path: path.stem)
def test_file(path):
    text = path.read_text(encoding="utf-8")
    expected = expected_in(text)
    assert expected, "the file announces nothing"
    announced = {code for _, code, _ in expected}
    found = [d for d in diagnostics_of(path) if d.code not in ON_THE_SIDE or d.code.value in announced]
    assert as_triples(found, Source(path.name, text)) == expected


def test_every_code_is_caused_by_a_file():
    announced = {code for path in bad_files() for _, code, _ in expected_in(path.read_text(encoding="utf-8"))}
    announced |= {code.value for code in Code if example(code)}  # test_document.py compiles those
    missing = {code.name for code in Code if code.value not in announced and code not in ELSEWHERE}
    assert not missing


@pytest.mark.parametrize("path", bad_files(), ids=lambda path: path.stem)
def test_messages_are_sentences_without_python(path):
    for d in diagnostics_of(path):
        for text in (d.message, d.help):
            assert "object at" not in text
            assert "None" not in text
            assert not text.endswith(".")
            assert "\n" not in text
