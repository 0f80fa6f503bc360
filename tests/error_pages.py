"""The pages of docs/errors: what they must show, and a program that brings them up to date.

    python tests/error_pages.py

A page is written by hand up to its example; what the example gives, and the table of the codes in the index, are made.
"""

from __future__ import annotations

import re
from pathlib import Path

from diagnostics.expectations import diagnostics_of

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.explain import title
from hysdel_py.diagnostics.render import render
from hysdel_py.syntax.source import Source

FOLDER = Path(__file__).parents[1] / "docs" / "errors"
INDEX = FOLDER / "README.md"
EXAMPLE = re.compile(r"^```hys\n(.*?)^```$", re.DOTALL | re.MULTILINE)
MADE = re.compile(r"(<!-- made by tests/error_pages.py -->\n).*?(<!-- end -->)", re.DOTALL)
GROUPS = {
    "HYS0": "Reading", "HYS1": "Syntax", "HYS2": "Names", "HYS3": "Types and items", "HYS4": "Lowering",
    "HYS5": "Warnings", "HYS6": "Vectors, loops and modules", "HYS9": "Notes",
}  # fmt: skip


def page(code):
    return (FOLDER / f"{code.value}.md").read_text(encoding="utf-8")


def example(code):
    """The example of a page, None if it has none."""
    match = EXAMPLE.search(page(code))
    return match and match[1]


def outcome(text, folder):
    """What the text after an example has to say: severity, code, place and the rendered diagnostic of each."""
    path = Path(folder) / "example.hys"
    path.write_text(text, encoding="utf-8")
    diagnostics_of.cache_clear()
    source = Source(path.name, text)
    found = []
    for d in diagnostics_of(path):
        place = " at line {}, column {}".format(*source.position(d.span.start)) if d.span else ""
        found.append((d.code, f"This example gives `{d.severity.value}[{d.code.value}]`{place}:", render(d, source)))
    return found


def index_text(old):
    """The index with a fresh table."""
    rows = []
    for prefix, group in GROUPS.items():
        rows += [f"\n### {group}\n", "| code | about |", "|---|---|"]
        rows += [f"| [{c.value}]({c.value}.md) | {title(c)} |" for c in Code if c.value.startswith(prefix)]
    table = "\n".join(rows) + "\n\n"
    return MADE.sub(lambda match: match[1] + table + match[2], old)


def updated(text, folder):
    """A page whose part behind the example is fresh."""
    match = EXAMPLE.search(text)
    if match is None:
        return text
    _, sentence, shown = outcome(match[1], folder)[0]
    return f"{text[: match.end()]}\n\n{sentence}\n\n```text\n{shown}```\n"


def main():
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        for code in Code:
            path = FOLDER / f"{code.value}.md"
            path.write_text(updated(page(code), folder), encoding="utf-8")
    INDEX.write_text(index_text(INDEX.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
