"""What the comparison of two models says: names first, then check by check with witnesses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from hysdel_py.analysis.report import CheckStatus, VerifyStatus
from hysdel_py.analysis.report_text import listed
from hysdel_py.analysis.stepping import Witness
from hysdel_py.systems.origin import Origin

__all__ = ["DiffCheck", "Difference", "NameChange", "Responsible"]


@dataclass(frozen=True, slots=True)
class NameChange:
    """A variable that is not the same in both models; an empty text means that the model does not have it."""

    name: str
    old: str
    new: str

    def __str__(self) -> str:
        if not self.old or not self.new:
            return f"{self.name}: only in the {'new' if self.new else 'old'} model ({self.old or self.new})"
        return f"{self.name}: {self.old} in the old model, {self.new} in the new one"


@dataclass(frozen=True, slots=True)
class Responsible:
    """An item whose value differs although all that it reads agrees; None where a model has no such item."""

    name: str
    old: Origin | None
    new: Origin | None

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "name": self.name,
            **{
                key: None if origin is None else {"line": origin.line, "text": origin.text}
                for key, origin in (("old", self.old), ("new", self.new))
            },
        }


@dataclass(frozen=True, slots=True)
class DiffCheck:
    """One comparison.

    Attributes
    ----------
    subject : str
        ``name'`` for the next value of a state, the name of an output, or a MUST of one model.
    status : CheckStatus
    how : str
        ``items`` where both models define it by the same items, ``model`` where the proof took both whole steps.
    witness : Witness or None
        A confirmed state and input at which it differs; `first` is the old model, `second` the new one.
    responsible : tuple of Responsible
    """

    subject: str
    status: CheckStatus
    how: str
    witness: Witness | None = None
    responsible: tuple[Responsible, ...] = ()

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "subject": self.subject,
            "status": self.status.value,
            "how": self.how,
            "witness": None if self.witness is None else self.witness.as_data(),
            "responsible": [item.as_data() for item in self.responsible],
        }


@dataclass(frozen=True, slots=True)
class Difference:
    """Whether two models have the same steps.

    Attributes
    ----------
    old, new : str
        Names of the sources.
    names : tuple of NameChange
        Variables that are missing in one model or declared otherwise.
    checks : tuple of DiffCheck
        Next states, outputs and MUST, over the ranges that both models share.
    band, tolerance : float
        See :class:`hysdel_py.Margins`.
    """

    old: str
    new: str
    names: tuple[NameChange, ...]
    checks: tuple[DiffCheck, ...]
    band: float
    tolerance: float

    @property
    def status(self) -> VerifyStatus:
        """Equal where the names and every check agree."""
        if self.names or any(check.status is CheckStatus.DIFFERENT for check in self.checks):
            return VerifyStatus.DIFFERENT
        settled = all(check.status is CheckStatus.HOLDS for check in self.checks)
        return VerifyStatus.EQUAL if settled else VerifyStatus.NOT_SETTLED

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self) -> Iterator[str]:
        """The report in words."""
        yield f"{self.old} and {self.new}: {self._verdict()}"
        yield (
            f"  to a tolerance of {self.tolerance:g}, outside a band of {self.band:g} around thresholds "
            "(both relative to the size of the terms), within the ranges that both share"
        )
        yield from (str(change) for change in self.names)
        for check in self.checks:
            if check.status is not CheckStatus.HOLDS:
                yield from self._check_lines(check)

    def _verdict(self) -> str:
        held = sum(check.status is CheckStatus.HOLDS for check in self.checks)
        counted = f"{held} of {len(self.checks)} next states, outputs and requirements agree"
        word = {"equal": "the same steps", "different": "different", "not settled": "not settled"}[self.status.value]
        return f"{word}; {counted}"

    def _check_lines(self, check: DiffCheck) -> Iterator[str]:
        if check.witness is None:
            yield f"{check.subject}: {check.status.value}"
            return
        yield f"{check.subject} differs"
        yield f"  at x: {listed(check.witness.x)}"
        yield from [f"     u: {listed(check.witness.u)}"] if check.witness.u else []
        yield from _side_by_side(check.witness)
        for item in check.responsible:
            yield f"  {item.name} is where they part"
            for source, origin in ((self.old, item.old), (self.new, item.new)):
                yield f"    {source}: {origin if origin is not None else 'has no such item'}"

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "old": self.old,
            "new": self.new,
            "status": self.status.value,
            "band": self.band,
            "tolerance": self.tolerance,
            "names": [{"name": c.name, "old": c.old, "new": c.new} for c in self.names],
            "checks": [check.as_data() for check in self.checks],
        }


def _side_by_side(witness: Witness) -> Iterator[str]:
    """A table of both results; what differs is marked."""
    first, second = (
        dict([*o.auxiliaries, *((f"{n}'", v) for n, v in o.next), *o.outputs])
        for o in (witness.first, witness.second)
    )  # fmt: skip
    names = [name for name in dict.fromkeys([*first, *second]) if not name.startswith("__")]
    rows = [(name, *(f"{side[name]:.9g}" if name in side else "-" for side in (first, second))) for name in names]
    cells = [("", "old", "new"), *rows]
    widths = [max(len(row[i]) for row in cells) for i in range(3)]
    for row in cells:
        mark = " *" if row[0] in witness.differing else ""
        yield f"  {row[0].ljust(widths[0])}  {row[1].rjust(widths[1])}  {row[2].rjust(widths[2])}{mark}"
    for label, outcome in (("old", witness.first), ("new", witness.second)):
        yield from (f"  {label}: no step; {problem}" for problem in outcome.problems)
