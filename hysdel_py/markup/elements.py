"""Elements of HTML and SVG whose texts cannot become tags: what is not markup already is escaped."""

from __future__ import annotations

import html
import json
from collections.abc import Iterable
from typing import Any

__all__ = ["Markup", "as_json", "element", "fragment", "number", "table"]

_VOID = frozenset({"br", "circle", "col", "input", "line", "meta", "path", "polyline", "rect"})
_UNSAFE_IN_SCRIPT = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}


class Markup(str):
    """A text that is markup, in which everything that came from outside has been escaped."""

    __slots__ = ()


Child = str | float | None | Iterable[Any]


def element(tag: str, *children: Child, **attributes: Any) -> Markup:
    """One element.

    Parameters
    ----------
    tag : str
    *children : Markup, str, number, None or iterables of them
        A plain str is escaped, None is nothing.
    **attributes
        A trailing underscore is dropped, as in ``class_``, other underscores become hyphens; None and False leave the
        attribute out, True gives one without a value.
    """
    given = {name: value for name, value in attributes.items() if value is not None and value is not False}
    written = "".join(_attribute(name, value) for name, value in given.items())
    inside = fragment(*children)
    if tag in _VOID and not inside:
        return Markup(f"<{tag}{written}/>")
    return Markup(f"<{tag}{written}>{inside}</{tag}>")


def fragment(*children: Child) -> Markup:
    """Children behind each other, without an element around them."""
    return Markup("".join(_escaped(child) for child in children))


def _escaped(child: Child) -> str:
    match child:
        case None:
            return ""
        case Markup():
            return child
        case str():
            return html.escape(_printable(child))
        case float() | int():
            return number(child)
        case _:
            return fragment(*child)


def _printable(text: str) -> str:
    """The text without characters that neither HTML nor XML may hold."""
    return "".join(c if c in "\t\n\r" or c.isprintable() or ord(c) > 0xA0 else "\ufffd" for c in text)


def _attribute(name: str, value: Any) -> str:
    plain = name.removesuffix("_").replace("_", "-")
    if value is True:
        return f" {plain}"
    text = number(value) if isinstance(value, float) else str(value)
    return f' {plain}="{html.escape(_printable(text), quote=True)}"'


def number(value: float) -> str:
    """A number as in a table: six digits, no negative zero."""
    return f"{float(value) + 0.0:.6g}"


def table(head: Iterable[Child], rows: Iterable[Iterable[Child]], **attributes: Any) -> Markup:
    """A table with a line of headings."""
    titles = element("tr", [element("th", title, scope="col") for title in head])
    body = [element("tr", [element("td", cell) for cell in row]) for row in rows]
    return element("table", element("thead", titles), element("tbody", body), **attributes)


def as_json(data: Any) -> Markup:
    """Plain data for a script element: no text in it can end the element."""
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return Markup("".join(_UNSAFE_IN_SCRIPT.get(c, c) for c in text))
