"""Members of a contradiction that are the same thing at several steps, put together for the reader."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from hysdel_py.analysis.contradiction import Finding
from hysdel_py.analysis.horizon import End, Member, MemberKind
from hysdel_py.diagnostics.render import region
from hysdel_py.model import Model
from hysdel_py.syntax.source import Source, Span

__all__ = ["Part", "parts_of", "steps_text"]

_ORDER = {
    MemberKind.START: 0, MemberKind.INPUT: 1, MemberKind.REQUIREMENT: 2, MemberKind.LIMIT: 3, MemberKind.DEFINITION: 5,
}  # fmt: skip
_RANGE_ORDER = 4


@dataclass(frozen=True, slots=True)
class Part:
    """One thing of a contradiction.

    Attributes
    ----------
    kind : str
        ``"x(0)"``, ``"given input"``, ``"MUST"``, ``"limit"``, ``"range"`` or ``"definition"``.
    text : str
        In the words of the source.
    steps : tuple of int
    span : Span or None
        Place in the source.
    """

    kind: str
    text: str
    steps: tuple[int, ...]
    span: Span | None = None

    @property
    def is_definition(self) -> bool:
        """Whether it only links what is demanded."""
        return self.kind == MemberKind.DEFINITION.value

    def to_dict(self, source: Source) -> dict[str, Any]:
        """Plain data, ready for JSON."""
        place = {} if self.span is None else {"file": source.home(self.span)[0].name, **region(self.span, source)}
        return {"kind": self.kind, "text": self.text, "steps": list(self.steps), **place}


def parts_of(finding: Finding, model: Model) -> tuple[Part, ...]:
    """What is demanded first, then the definitions by their first step."""
    declared = {symbol.name: symbol.span for symbol in model.typed.symbols if symbol.line}
    defined = {name: _span(item.origin.start, item.origin.end) for name, item in model.dha.definitions.items()}
    things: list[tuple[tuple[int, int, int], Part]] = []
    for members in _alike(finding.members, lambda m: (m.kind, m.name, m.value, m.origin)):
        first: Member = members[0]
        steps = tuple(m.step for m in members)
        span = None if first.origin is None else _span(first.origin.start, first.origin.end)
        when = steps[0] if first.kind is MemberKind.DEFINITION else 0
        place = span.start if span is not None else 0
        things.append(((_ORDER[first.kind], when, place), Part(first.kind.value, _text(first), steps, span)))
    for ends in _alike(finding.ends, lambda e: (e.variable.name, e.is_high, e.derived)):
        end: End = ends[0]
        span = (defined if end.derived else declared).get(end.variable.name)
        part = Part("range", _end_text(end), tuple(e.step for e in ends), span)
        things.append(((_RANGE_ORDER, ends[0].step, span.start if span else 0), part))
    return tuple(part for _, part in sorted(things, key=lambda pair: pair[0]))


def _alike(things: Iterable[Any], key: Any) -> list[list[Any]]:
    found: dict[Any, list[Any]] = {}
    for thing in things:
        found.setdefault(key(thing), []).append(thing)
    return list(found.values())


def _span(start: int, end: int) -> Span | None:
    return Span(start, end) if end > start else None


def _text(member: Member) -> str:
    match member.kind:
        case MemberKind.START | MemberKind.INPUT:
            return f"{member.name} = {member.value:.9g}"
        case MemberKind.LIMIT:
            return member.name
        case _:
            return member.origin.text if member.origin is not None else member.name


def _end_text(end: End) -> str:
    sign = "<=" if end.is_high else ">="
    why = ", which follows from its definition" if end.derived else ""
    return f"{end.variable.name} {sign} {end.value:.6g}{why}"


def steps_text(steps: Sequence[int]) -> str:
    """``k = 0, 3..7``."""
    runs = [
        [step for _, step in group]
        for _, group in groupby(enumerate(sorted(steps)), key=lambda pair: pair[1] - pair[0])
    ]
    return "k = " + ", ".join(str(run[0]) if len(run) == 1 else f"{run[0]}..{run[-1]}" for run in runs)
