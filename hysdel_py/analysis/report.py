"""What a comparison of two forms says: check by check, with witnesses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any

from hysdel_py.analysis.stepping import Witness
from hysdel_py.systems.origin import Origin, RowOrigin

__all__ = ["Check", "CheckStatus", "PointTally", "Question", "Verification", "VerifyStatus"]


class Question(Enum):
    """What a check asks; the value completes the sentence "is there a point at which ..."."""

    FORBIDDEN = "the Dha has a step that the Mld forbids"
    ANOTHER_VALUE = "the Mld allows another value"
    ALLOWED = "the Mld has a step although MUST is violated"
    EQUATION = "an update or output differs"
    LOST_MODE = "the Dha has a step and the Pwa none"
    BEYOND = "a mode holds that should not"
    MODE = "the map of a mode is another"
    OVERLAP = "two modes hold"


class CheckStatus(Enum):
    """How a check ended."""

    HOLDS = "holds"
    DIFFERENT = "different"
    DOUBTFUL = "doubtful"
    NOT_SETTLED = "not settled"


class VerifyStatus(Enum):
    """How a comparison ended."""

    EQUAL = "equal"
    DIFFERENT = "different"
    NOT_SETTLED = "not settled"


@dataclass(frozen=True, slots=True)
class Check:
    """One question about one row, variable or requirement.

    Attributes
    ----------
    question : Question
    subject : str
        The row, variable or item.
    status : CheckStatus
        ``HOLDS``: there is no point at which it differs, proven outside the band to the tolerance. ``DOUBTFUL``: the
        solver names points, and stepping confirms none of them.
    how : str
        What the proof took: ``interval``, ``item`` (the definitions concerned alone), ``coefficients`` or ``model``.
    rows : tuple of int
        Rows of the Mld that are concerned.
    origins : tuple of Origin or RowOrigin
        Items that are concerned.
    witness : Witness or None
        A confirmed point at which it differs.
    """

    question: Question
    subject: str
    status: CheckStatus
    how: str
    rows: tuple[int, ...] = ()
    origins: tuple[Origin | RowOrigin, ...] = ()
    witness: Witness | None = None

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "question": self.question.name.lower(),
            "subject": self.subject,
            "status": self.status.value,
            "how": self.how,
            "rows": list(self.rows),
            "lines": [{"line": origin.line, "text": origin.text} for origin in self.origins],
            "witness": None if self.witness is None else self.witness.as_data(),
        }


@dataclass(frozen=True, slots=True)
class PointTally:
    """Outcome of the random points: both forms stepped alike, neither had a step, in the band, or differed."""

    equal: int = 0
    infeasible: int = 0
    in_band: int = 0
    different: tuple[Witness, ...] = ()

    @property
    def total(self) -> int:
        """Number of points."""
        return self.equal + self.infeasible + self.in_band + len(self.different)

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "total": self.total,
            "equal": self.equal,
            "infeasible": self.infeasible,
            "in_band": self.in_band,
            "different": [witness.as_data() for witness in self.different],
        }


@dataclass(frozen=True, slots=True)
class Verification:
    """Whether two forms of a model agree.

    Attributes
    ----------
    name : str
    forms : tuple of str
        What was compared with the Dha: ``Mld``, ``Pwa``.
    points : PointTally
    checks : tuple of Check
    band, tolerance : float
        The statement holds outside this band around thresholds and to this tolerance; see :class:`Margins`.
    notes : tuple of str
        What limits the statement, such as ranges that differ.
    """

    name: str
    forms: tuple[str, ...]
    points: PointTally
    checks: tuple[Check, ...]
    band: float
    tolerance: float
    notes: tuple[str, ...] = ()

    @property
    def status(self) -> VerifyStatus:
        """Equal only where every check holds; different as soon as one point is confirmed."""
        if self.points.different or any(check.status is CheckStatus.DIFFERENT for check in self.checks):
            return VerifyStatus.DIFFERENT
        if all(check.status is CheckStatus.HOLDS for check in self.checks):
            return VerifyStatus.EQUAL
        return VerifyStatus.NOT_SETTLED

    @property
    def is_equal(self) -> bool:
        """Whether equality was proven."""
        return self.status is VerifyStatus.EQUAL

    def failed(self) -> tuple[Check, ...]:
        """Checks that do not hold, the confirmed differences first."""
        bad = [check for check in self.checks if check.status is not CheckStatus.HOLDS]
        return tuple(sorted(bad, key=lambda check: check.status is not CheckStatus.DIFFERENT))

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self) -> Iterator[str]:
        """The report in words."""
        from hysdel_py.analysis.report_text import verification_lines

        return verification_lines(self)

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "name": self.name,
            "forms": list(self.forms),
            "status": self.status.value,
            "band": self.band,
            "tolerance": self.tolerance,
            "notes": list(self.notes),
            "points": self.points.as_data(),
            "checks": [check.as_data() for check in self.checks],
        }
