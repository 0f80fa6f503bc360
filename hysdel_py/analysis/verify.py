"""Whether the forms of a model agree: random points first, then a proof or a witness for every row and equation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

from hysdel_py.analysis.comparison import Comparison
from hysdel_py.analysis.equation_questions import equation_checks
from hysdel_py.analysis.margins import Margins
from hysdel_py.analysis.points import step_points
from hysdel_py.analysis.questions import allowed_checks, forbidden_checks, value_checks
from hysdel_py.analysis.report import Check, CheckStatus, PointTally, Verification
from hysdel_py.analysis.search import Clock
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import Variable

if TYPE_CHECKING:
    from typing import Protocol

    class Lowered(Protocol):
        """A model with its forms."""

        @property
        def dha(self) -> Dha:
            """The automaton."""

        @property
        def mld(self) -> Mld:
            """The rows."""


__all__ = ["verify", "verify_forms"]


def verify(
    model: Lowered,
    *,
    mld: Mld | None = None,
    points: int = 200,
    seed: int = 0,
    margins: Margins | None = None,
    seconds: float = inf,
) -> Verification:
    """Show that the Dha and the Mld of a model have the same steps, or find a point where they differ.

    Parameters
    ----------
    model : Model
    mld : Mld, optional
        The form to be judged; by default that of the model.
    points : int
        Number of random points that are stepped before the proof; 0 for none.
    seed : int
        Of the random points.
    margins : Margins, optional
        Band around thresholds and tolerance of the statement.
    seconds : float
        Time limit; what is not settled then is said to be.

    Returns
    -------
    Verification
        Every witness in it has been confirmed by stepping both forms.

    Raises
    ------
    ArgumentError
        The Mld has other variables than the model, or a variable that the proof needs has no finite range.
    """
    return verify_forms(
        model.dha, model.mld if mld is None else mld, points=points, seed=seed, margins=margins, seconds=seconds
    )


def verify_forms(
    dha: Dha, mld: Mld, *, points: int = 200, seed: int = 0, margins: Margins | None = None, seconds: float = inf
) -> Verification:
    """Compare a Dha with an Mld; see :func:`verify`."""
    if points < 0:
        raise ArgumentError(f"points is {points}: a number of at least 0 was expected")
    if not seconds > 0:
        raise ArgumentError(f"seconds is {seconds:g}: a time above 0 was expected")
    chosen = Margins() if margins is None else margins
    dha, notes = _over_common_ranges(dha, mld)
    comparison = Comparison(dha, mld, chosen, Clock(seconds))
    tally = step_points(comparison, points, seed) if points else PointTally()
    checks = tuple(_checks(comparison))
    return Verification(dha.name, ("Mld",), tally, checks, chosen.band, chosen.tolerance, notes)


def _checks(comparison: Comparison) -> Iterator[Check]:
    values = tuple(value_checks(comparison))
    yield from values
    yield from forbidden_checks(comparison)
    yield from allowed_checks(comparison, unique=all(_is_proven_alone(check) for check in values))
    yield from equation_checks(comparison)


def _is_proven_alone(check: Check) -> bool:
    return check.status is CheckStatus.HOLDS and check.how == "item"


def _over_common_ranges(dha: Dha, mld: Mld) -> tuple[Dha, tuple[str, ...]]:
    """The Dha over the states and inputs for which both forms are made, and what was cut off."""
    for what, ours, theirs in (
        ("state", dha.x, mld.x), ("input", dha.u, mld.u), ("output", dha.y, mld.y),
        ("Boolean auxiliary", dha.d, mld.d), ("real auxiliary", dha.z, mld.z),
    ):  # fmt: skip
        _require_same(what, ours, theirs)
    notes: list[str] = []
    x, u = (
        tuple(_common(v, other, notes) for v, other in zip(ours, theirs, strict=True))
        for ours, theirs in ((dha.x, mld.x), (dha.u, mld.u))
    )
    return replace(dha, x=x, u=u), tuple(notes)


def _require_same(what: str, ours: tuple[Variable, ...], theirs: tuple[Variable, ...]) -> None:
    if [(v.name, v.type) for v in ours] != [(v.name, v.type) for v in theirs]:
        raise ArgumentError(
            f"the Mld has the {what} vector ({', '.join(v.name for v in theirs)}): "
            f"({', '.join(v.name for v in ours)}) was expected, as in the model"
        )


def _common(ours: Variable, theirs: Variable, notes: list[str]) -> Variable:
    low, high = max(ours.low, theirs.low), min(ours.high, theirs.high)
    if low > high:
        raise ArgumentError(f"{ours.name} has no value that is in the range of both forms")
    declared = (ours.low, ours.high)
    if declared not in ((low, high), (-inf, inf)):
        notes.append(f"{ours.name} is compared over [{low:g}, {high:g}], which both forms allow")
    return replace(ours, low=low, high=high)
