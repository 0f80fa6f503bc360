"""The text of an explanation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from hysdel_py.analysis.contradiction import Finding, Verdict
from hysdel_py.analysis.horizon import MemberKind
from hysdel_py.diagnostics.render import place
from hysdel_py.reports.columns import aligned
from hysdel_py.reports.parts import Part, steps_text
from hysdel_py.semantics.typed_model import TypedModel
from hysdel_py.syntax.source import Source
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["explanation_text"]

_WORTH = {
    Verdict.SMALLEST: "there is none with fewer members",
    Verdict.IRREDUCIBLE: "no member can be left out, but there may be one with fewer",
    Verdict.NOT_SETTLED: "not settled, there may be more here than is needed",
}


def explanation_text(
    finding: Finding, horizon: int, parts: Sequence[Part], remedies: Sequence[str], model: TypedModel
) -> str:
    """What the command prints."""
    source, name = model.source, model.name
    steps = f"{horizon} step{'s' * (horizon > 1)}"
    if finding.run is not None:
        return "\n".join(_feasible(finding, finding.run, steps, name)) + "\n"
    if not parts:
        return f"{name}: not settled over {steps}: {finding.message}\n"
    return "\n".join(_contradiction(finding, parts, remedies, source, f"{name}: no input sequence of {steps}")) + "\n"


def _feasible(finding: Finding, run: Trajectory, steps: str, name: str) -> Iterator[str]:
    yield f"{name}: feasible; these inputs of {steps} keep all ranges, MUST and limits, as the simulator confirms"
    if finding.borderline:
        yield f"borderline: only when ranges, MUST and limits may be missed by {finding.violation:g}"
    names = run.names["u"]
    if not names:
        yield "  (the model has no inputs)"
        return
    rows = [["k", *names], *([str(k), *(f"{v:.6g}" for v in row)] for k, row in enumerate(np.asarray(run.u) + 0.0))]
    yield from aligned(rows)


def _contradiction(
    finding: Finding, parts: Sequence[Part], remedies: Sequence[str], source: Source, opening: str
) -> Iterator[str]:
    yield f"{opening} keeps all ranges, MUST and limits"
    if finding.borderline:
        yield f"borderline: it would be enough if each gave by {finding.violation:.2g}"
    yield f"{_counted(finding)}; {_WORTH[finding.verdict]}"
    starts = [part.text for part in parts if part.kind == MemberKind.START.value]
    if starts:
        yield from ("", f"x(0): {', '.join(starts)}")
    for part in parts:
        if part.kind != MemberKind.START.value and not part.is_definition:
            yield from ("", f"{part.kind} at {steps_text(part.steps)}: {part.text}", *_place(part, source))
    linked = [part for part in parts if part.is_definition]
    if linked:
        yield from ("", "linked by these definitions:")
    for part in linked:
        yield from ("", f"at {steps_text(part.steps)}", *_place(part, source))
    if remedies:
        yield from ("", "each of these changes alone would allow a run:", *(f"  {line}" for line in remedies))
    if finding.message:
        yield from ("", f"not settled further: {finding.message}")


def _counted(finding: Finding) -> str:
    """How many members there are, each at one step; ends of ranges come on top."""
    count, ends = len(finding.members), len(finding.ends)
    ranges = f", and {ends} end{'s' * (ends > 1)} of declared ranges" if ends else ""
    return f"a contradiction of {count} member{'s' * (count != 1)}, each at one time{ranges}"


def _place(part: Part, source: Source) -> list[str]:
    return [] if part.span is None else place(part.span, source)
