"""Every code has a page whose example gives exactly that code at the place that the page names."""

import pytest
from error_pages import FOLDER, INDEX, example, index_text, outcome, page, updated

from hysdel_py.diagnostics.codes import Code

# Codes that no small text can cause, so that their pages have no example.
WITHOUT_EXAMPLE = {
    Code.UNREADABLE, Code.NOT_TEXT, Code.NOT_UTF8, Code.TOO_LONG, Code.TOO_MANY_ERRORS, Code.PARAMETER_UNKNOWN,
    Code.CONSTANT_TERM, Code.TOO_MANY_CLAUSES, Code.TOO_LARGE, Code.MODULE,
    Code.NOT_UNIQUE,
}  # fmt: skip


@pytest.mark.parametrize("code", Code, ids=lambda code: code.name)
def test_every_code_has_a_page(code):
    text = page(code)
    assert text.startswith(f"# {code.value}: ")
    assert len(text.split()) > 15
    assert (example(code) is None) == (code in WITHOUT_EXAMPLE)


def test_no_page_is_left_over():
    assert {path.stem for path in FOLDER.glob("HYS*.md")} == {code.value for code in Code}


@pytest.mark.parametrize("code", [c for c in Code if c not in WITHOUT_EXAMPLE], ids=lambda code: code.name)
def test_example_gives_its_code_and_no_other(code, tmp_path):
    found = outcome(example(code), tmp_path)
    assert [other for other, *_ in found] == [code]
    _, sentence, shown = found[0]
    assert sentence in page(code), "the page names another place: run python tests/error_pages.py"
    assert shown in page(code), "the page shows another text: run python tests/error_pages.py"
    assert updated(page(code), tmp_path) == page(code)


def test_index_is_up_to_date():
    text = INDEX.read_text(encoding="utf-8")
    assert index_text(text) == text, "run python tests/error_pages.py"
    assert all(f"({code.value}.md)" in text for code in Code)
