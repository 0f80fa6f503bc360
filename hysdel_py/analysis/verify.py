"""Whether the forms of a model agree: random points first, then a proof or a witness for every row and equation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING

from hysdel_py.analysis.clock import Clock, Watch
from hysdel_py.analysis.comparison import Comparison
from hysdel_py.analysis.equation_questions import equation_checks
from hysdel_py.analysis.margins import Margins
from hysdel_py.analysis.points import Compare, step_points
from hysdel_py.analysis.pwa_modes import modes_within
from hysdel_py.analysis.pwa_pair import PwaPair
from hysdel_py.analysis.questions import allowed_checks, forbidden_checks, value_checks
from hysdel_py.analysis.report import Check, CheckStatus, PointTally, Verification
from hysdel_py.analysis.verify_pwa import pwa_checks
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.pwa import Pwa
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
    pwa: Pwa | None = None,
    forms: Sequence[str] | None = None,
    points: int = 200,
    seed: int = 0,
    margins: Margins | None = None,
    seconds: float = inf,
    progress: Watch | None = None,
) -> Verification:
    """Show that the forms of a model have the same steps, or find a point where they differ.

    Parameters
    ----------
    model : Model
    mld : Mld, optional
        A form to be judged instead of that of the model.
    pwa : Pwa, optional
        The same.
    forms : sequence of str, optional
        What is compared with the Dha: ``"mld"``, ``"pwa"``. By default the forms that are given, and both if none is.
    points : int
        Number of random points that are stepped before the proof; 0 for none.
    seed : int
        Of the random points.
    margins : Margins, optional
        Band around thresholds and tolerance of the statement.
    seconds : float
        Time limit; what is not settled then is said to be.
    progress : callable, optional
        Told the number of searches begun; a true answer ends the work as if its time were over.

    Returns
    -------
    Verification
        Every witness in it has been confirmed by stepping both forms. With more modes than
        :data:`hysdel_py.analysis.verify_pwa.MOST_MODES` the Pwa is not looked at, and the report says so.

    Raises
    ------
    ArgumentError
        A form has other variables than the model, a variable that the proof needs has no finite range, or an argument
        is wrong.
    """
    chosen = _chosen(forms, mld, pwa)
    _require_limits(points, seconds)
    clock = Clock(seconds, progress)
    if "pwa" in chosen and pwa is None:
        pwa = modes_within(model.dha, clock)
    compared = _Compared(chosen, Margins() if margins is None else margins, clock)
    return compared.verification(model.dha, model.mld if mld is None else mld, pwa, (points, seed))


def verify_forms(
    dha: Dha, mld: Mld, *, points: int = 200, seed: int = 0, margins: Margins | None = None, seconds: float = inf
) -> Verification:
    """Compare a Dha with an Mld; see :func:`verify`."""
    _require_limits(points, seconds)
    compared = _Compared(("mld",), Margins() if margins is None else margins, Clock(seconds))
    return compared.verification(dha, mld, None, (points, seed))


_SHOWN = {"mld": "Mld", "pwa": "Pwa"}
"""Names of the forms in reports."""


def _chosen(forms: Sequence[str] | None, mld: Mld | None, pwa: Pwa | None) -> tuple[str, ...]:
    """The forms to be compared, in a fixed order."""
    given = tuple(form for form, value in (("mld", mld), ("pwa", pwa)) if value is not None)
    wanted = (given or tuple(_SHOWN)) if forms is None else tuple(forms)
    unknown = [form for form in wanted if form not in _SHOWN]
    if unknown or not wanted:
        raise ArgumentError(f"forms is ({', '.join(map(str, wanted))}): mld, pwa or both were expected")
    left_out = [form for form in given if form not in wanted]
    if left_out:
        raise ArgumentError(f"a form {left_out[0]} is given, and forms leaves it out")
    return tuple(form for form in _SHOWN if form in wanted)


def _require_limits(points: int, seconds: float) -> None:
    if points < 0:
        raise ArgumentError(f"points is {points}: a number of at least 0 was expected")
    if not seconds > 0:
        raise ArgumentError(f"seconds is {seconds:g}: a time above 0 was expected")


@dataclass(frozen=True, eq=False, slots=True)
class _Compared:
    """Which forms are compared with the Dha, and how closely."""

    forms: tuple[str, ...]
    margins: Margins
    clock: Clock

    def verification(self, dha: Dha, mld: Mld, pwa: Pwa | None, drawn: tuple[int, int]) -> Verification:
        """The report; `drawn` is the number of random points and their seed."""
        dha, notes = _over_common_ranges(dha, mld, "Mld")
        if pwa is not None:
            dha, more = _over_common_ranges(dha, pwa, "Pwa")
            notes = (*notes, *more)
        comparison = Comparison(dha, mld, self.margins, self.clock)
        pair = None if pwa is None else PwaPair(comparison, pwa)
        tally, checks = self._tally(comparison, pair, *drawn), tuple(self._checks(comparison, pair))
        shown = tuple(_SHOWN[form] for form in self.forms)
        return Verification(dha.name, shown, tally, checks, self.margins.band, self.margins.tolerance, notes)

    def _tally(self, comparison: Comparison, pair: PwaPair | None, points: int, seed: int) -> PointTally:
        compare: list[Compare] = [comparison.compare] if "mld" in self.forms else []
        if pair is not None and pair.pwa.is_complete:
            compare.append(pair.compare)
        return step_points(comparison, points, seed, compare) if points and compare else PointTally()

    def _checks(self, comparison: Comparison, pair: PwaPair | None) -> Iterator[Check]:
        if "mld" in self.forms:
            yield from _mld_checks(comparison)
        if pair is not None:
            yield from pwa_checks(pair)


def _mld_checks(comparison: Comparison) -> Iterator[Check]:
    values = tuple(value_checks(comparison))
    yield from values
    yield from forbidden_checks(comparison)
    yield from allowed_checks(comparison, unique=all(_is_proven_alone(check) for check in values))
    yield from equation_checks(comparison)


def _is_proven_alone(check: Check) -> bool:
    return check.status is CheckStatus.HOLDS and check.how == "item"


def _over_common_ranges(dha: Dha, form: Mld | Pwa, label: str) -> tuple[Dha, tuple[str, ...]]:
    """The Dha over the states and inputs for which both forms are made, and what was cut off."""
    for what, ours, theirs in (
        ("state", dha.x, form.x), ("input", dha.u, form.u), ("output", dha.y, form.y),
        ("Boolean auxiliary", dha.d, form.d), ("real auxiliary", dha.z, form.z),
    ):  # fmt: skip
        _require_same(what, ours, theirs, label)
    notes: list[str] = []
    x, u = (
        tuple(_common(v, other, notes) for v, other in zip(ours, theirs, strict=True))
        for ours, theirs in ((dha.x, form.x), (dha.u, form.u))
    )
    return replace(dha, x=x, u=u), tuple(notes)


def _require_same(what: str, ours: tuple[Variable, ...], theirs: tuple[Variable, ...], label: str) -> None:
    if [(v.name, v.type) for v in ours] != [(v.name, v.type) for v in theirs]:
        raise ArgumentError(
            f"the {label} has the {what} vector ({', '.join(v.name for v in theirs)}): "
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
