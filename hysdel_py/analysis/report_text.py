"""Reports of comparisons in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

from hysdel_py.analysis.stepping import Outcome, Values, Witness

if TYPE_CHECKING:
    from hysdel_py.analysis.report import Check, PointTally, Verification

__all__ = ["listed", "outcome_lines", "verification_lines", "witness_lines"]

SHOWN_POINTS = 3
"""So many random points with a difference are shown."""


def verification_lines(report: Verification) -> Iterator[str]:
    """The report of :func:`hysdel_py.analysis.verify.verify` in words."""
    yield f"{report.name}: {_verdict(report)}"
    yield (
        f"  to a tolerance of {report.tolerance:g}, outside a band of {report.band:g} around thresholds "
        "(both relative to the size of the terms)"
    )
    yield from (f"  note: {note}" for note in report.notes)
    if report.points.total:
        yield f"  {_points(report.points)}"
    yield from (f"  {line}" for line in _summary(report.checks))
    for witness in report.points.different[:SHOWN_POINTS]:
        yield "different at a random point"
        yield from witness_lines(witness, ("Dha", witness.form))
    for check in report.failed():
        yield from _check_lines(check)


def _verdict(report: Verification) -> str:
    forms = ", ".join(("Dha", *report.forms))
    return {
        "equal": f"{forms} have the same steps",
        "different": f"{forms} differ",
        "not settled": f"whether {forms} have the same steps is not settled",
    }[report.status.value]


def _points(points: PointTally) -> str:
    return (
        f"{points.total} random points: {points.equal} alike, {points.infeasible} without a step in either form, "
        f"{points.in_band} in the band, {len(points.different)} different"
    )


def _summary(checks: tuple[Check, ...]) -> Iterator[str]:
    """One line for each question: how many were asked, and how they ended."""
    for question in dict.fromkeys(check.question for check in checks):
        statuses = Counter(check.status.value for check in checks if check.question is question)
        answer = ", ".join(f"{statuses[status]} {word}" for status, word in _WORDS.items() if statuses[status])
        yield f"is there a point at which {question.value}? {statuses.total()} checks: {answer}"


_WORDS = {"holds": "no", "different": "yes", "doubtful": "doubtful", "not settled": "not settled"}


def _check_lines(check: Check) -> Iterator[str]:
    if check.witness is not None:
        yield f"{check.subject}: {check.question.value}"
    else:
        yield f"{check.subject}: {check.status.value} whether {check.question.value}{_REASON[check.status.value]}"
    yield from (f"  {origin}" for origin in check.origins if str(origin) and str(origin) not in check.subject)
    if check.witness is not None:
        yield from witness_lines(check.witness, ("Dha", check.witness.form))


_REASON = {
    "doubtful": "; the solver names points at which stepping shows no difference",
    "not settled": "; a limit came first, or the solver gave up",
}


def witness_lines(witness: Witness, labels: tuple[str, str]) -> Iterator[str]:
    """State, input, and what each form makes of them."""
    yield f"  at x: {listed(witness.x)}"
    if witness.u:
        yield f"     u: {listed(witness.u)}"
    width = max(map(len, labels))
    for label, outcome in zip(labels, (witness.first, witness.second), strict=True):
        yield from outcome_lines(outcome, label.ljust(width), witness.differing)


def outcome_lines(outcome: Outcome, label: str, names: tuple[str, ...]) -> Iterator[str]:
    """What one form makes of a point; the values of some names only, if there are any."""
    if not outcome.exists:
        yield f"  {label}: no step; {'; '.join(outcome.problems)}"
        return
    values = [
        *outcome.auxiliaries,
        *((f"{name}'", value) for name, value in outcome.next),
        *outcome.outputs,
    ]  # fmt: skip
    yield f"  {label}: {listed(tuple((n, v) for n, v in values if not names or n in names))}"


def listed(values: Values) -> str:
    """Names and values in one line."""
    return ", ".join(f"{name} = {value:.9g}" for name, value in values) if values else "(nothing)"
