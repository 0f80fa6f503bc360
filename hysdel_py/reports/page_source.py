"""The source of a model and the rows of its MLD form, each told which lines it comes from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hysdel_py.markup.elements import Markup, element, fragment
from hysdel_py.systems.describe import equations, inequalities

if TYPE_CHECKING:
    from hysdel_py.model import Model
    from hysdel_py.syntax.source import Source
    from hysdel_py.systems.origin import RowOrigin

__all__ = ["Place", "place_of_items", "source_section"]


@dataclass(frozen=True, slots=True)
class Place:
    """Lines of an item in one of the files of a model.

    Attributes
    ----------
    file : int
        Number of the file, from 0.
    first, last : int
        Lines, from 1.
    """

    file: int
    first: int
    last: int

    @property
    def keys(self) -> tuple[str, ...]:
        """A word for each line."""
        return tuple(f"{self.file}-{line}" for line in range(self.first, self.last + 1))


@dataclass(frozen=True, slots=True)
class _Row:
    label: str
    text: str
    lines: tuple[str, ...]


def place_of_items(model: Model) -> dict[int, Place]:
    """Where each item of a model is written, by its number."""
    return {item.number: _place(model.typed.source, item.span.start, item.span.end) for item in model.typed.items}


def _place(source: Source, start: int, end: int) -> Place:
    from hysdel_py.syntax.source import Span

    file, span = source.home(Span(start, end))
    first, last = file.position(span.start)[0], file.position(max(span.start, span.end - 1))[0]
    return Place(_files(source).index(file), first, last)


def _files(source: Source) -> tuple[Source, ...]:
    return source.parts or (source,)


def source_section(model: Model) -> Markup:
    """Source on the left, rows on the right."""
    rows = tuple(_rows(model))
    counts: dict[str, int] = {}
    for row in rows:
        for key in row.lines:
            counts[key] = counts.get(key, 0) + 1
    files = [_file(number, file, counts) for number, file in enumerate(_files(model.typed.source))]
    listed = element("ol", [_row(row) for row in rows], class_="rows", id="rows")
    hint = element("p", "Choose a line number to see its rows, or a row to see its lines. Choose it again to let go.")
    told = element("p", "", id="chosen", role="status", aria_live="polite")
    columns = element("div", element("div", files, class_="source"), listed, class_="beside")
    return fragment(hint, told, columns)


def _file(number: int, file: Source, counts: dict[str, int]) -> Markup:
    total = file.text.count("\n") + (not file.text.endswith("\n"))
    lines = [_line(f"{number}-{line}", line, file.line_text(line), counts) for line in range(1, total + 1)]
    return fragment(element("h3", file.name), element("ol", lines, class_="lines"))


def _line(key: str, line: int, text: str, counts: dict[str, int]) -> Markup:
    count = counts.get(key, 0)
    rows = f"{count} row{'s' * (count != 1)}"
    mark: Markup = (
        element(
            "button",
            str(line),
            type="button",
            data_line=key,
            aria_pressed="false",
            aria_label=f"line {line}, {rows}",
            title=rows,
        )
        if count
        else element("span", str(line), class_="plain")
    )
    return element("li", mark, element("code", text or " "), data_key=key)


def _row(row: _Row) -> Markup:
    button = element("button", element("b", row.label), " ", element("code", row.text), type="button",
                     data_rows=" ".join(row.lines), aria_pressed="false")  # fmt: skip
    return element("li", button)


def _rows(model: Model) -> Iterator[_Row]:
    """Equations and inequalities in the order of the matrices."""
    mld, places = model.mld, place_of_items(model)
    labels = [*(f"x{i}" for i in range(mld.nx)), *(f"y{i}" for i in range(mld.ny)), *(f"E{i}" for i in range(mld.ne))]
    origins = (*mld.updates, *mld.outputs, *mld.rows)
    for label, text, origin in zip(labels, (*equations(mld), *inequalities(mld)), origins, strict=True):
        yield _Row(label, text, _lines(origin, places))


def _lines(origin: RowOrigin, places: dict[int, Place]) -> tuple[str, ...]:
    if origin.group in places:
        return places[origin.group].keys
    return (f"0-{origin.line}",) if origin.line else ()
