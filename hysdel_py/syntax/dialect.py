"""The dialects of the language, which differ in how tight the logic operators bind.

In HYSDEL 2 ``|`` binds weakest, then the arrows, then ``&``; in HYSDEL 3 ``|``, then ``&``, then the arrows, except
that an arrow at the top of an item of MUST parts the whole item. A file says which one it is written in by a comment in
front of it, ``/* dialect: hysdel 3 */``, which other compilers pass over.
"""

from __future__ import annotations

import re
from enum import Enum

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.front import is_in_front, statements
from hysdel_py.syntax.source import Source, Span

__all__ = ["Dialect", "grammar_of", "stated_dialect"]


class Dialect(Enum):
    """How a file is to be read; the value is how its comment calls it."""

    HYSDEL_2 = "hysdel 2"
    HYSDEL_3 = "hysdel 3"


_MEANT = re.compile(r"\bdialect\b.*\bhysdel\s*-?3", re.DOTALL | re.IGNORECASE)
_KNOWN = {dialect.value: dialect for dialect in Dialect}
_ARROWS = "(IMPLIES | IMPLIED_BY | IFF)"
_LADDER_OF_3 = {
    "?disjunction": "conjunction | disjunction OR conjunction -> binary",
    "?conjunction": "implication | conjunction AND implication -> binary",
    "?implication": f"negation | implication {_ARROWS} negation -> binary",
    "requirement": "parted",
}
_MUST_OF_3 = f"""
?parted: disjunct | parted {_ARROWS} disjunct -> binary
?disjunct: conjunct | disjunct OR conjunct -> binary
?conjunct: negation | conjunct AND negation -> binary
"""


def grammar_of(dialect: Dialect, grammar: str) -> str:
    """The grammar with the ladder of logic operators of a dialect; `grammar` is that of HYSDEL 2."""
    if dialect is Dialect.HYSDEL_2:
        return grammar
    for rule, body in _LADDER_OF_3.items():
        grammar, count = re.subn(rf"^{re.escape(rule)}:.*$", f"{rule}: {body}", grammar, flags=re.MULTILINE)
        assert count == 1, f"the grammar has {count} rules {rule}"
    return grammar + _MUST_OF_3


def stated_dialect(source: Source, sink: Sink) -> Dialect:
    """The dialect that the comments in front of a text state, HYSDEL 2 if they state none."""
    first: tuple[Dialect, Span] | None = None
    for stated in statements(source, "dialect"):
        span, value, dialect = stated.span, stated.value, _KNOWN.get(stated.value)
        if not stated.in_front:
            _refuse_late(dialect, span, sink)
        elif dialect is None:
            known = " and ".join(_KNOWN)
            sink.error(
                Code.DIALECT, f"there is no dialect {value or '(empty)'}: the known ones are {known}", span,
                help="write /* dialect: hysdel 3 */, or leave the comment out for hysdel 2",
            )  # fmt: skip
        elif first is None:
            first = (dialect, span)
        elif first[0] is not dialect:
            labels = (Label(first[1], "stated here"),)
            sink.error(Code.DIALECT, f"the dialect is {first[0].value} already", span, labels=labels)
    if first is None and not sink.failed:
        _warn_of_near_misses(source, sink)
    return first[0] if first else Dialect.HYSDEL_2


def _warn_of_near_misses(source: Source, sink: Sink) -> None:
    """Comments in front of a text that speak of the dialect of HYSDEL 3 without stating it."""
    for span in source.comments:
        if is_in_front(source, span) and _MEANT.search(source.text[span.start : span.end]):
            sink.warning(
                Code.DIALECT, "this comment does not state a dialect, and the file is read as hysdel 2", span,
                help="write /* dialect: hysdel 3 */ as a comment of its own",
            )  # fmt: skip


def _refuse_late(dialect: Dialect | None, span: Span, sink: Sink) -> None:
    """What states a known dialect is meant to; any other text behind the first word is a comment like others."""
    if dialect is not None:
        sink.error(
            Code.DIALECT, "the dialect has to be stated in front of SYSTEM", span,
            help="move the comment to the beginning of the file",
        )  # fmt: skip
