"""Why a Dha has no run over N steps from a state, or a run if there is one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from math import inf

from hysdel_py.analysis.clock import Clock, Watch
from hysdel_py.analysis.confirmation import confirmed, moved_inside
from hysdel_py.analysis.consistency import Consistency
from hysdel_py.analysis.horizon import Demand, End, Horizon, Member
from hysdel_py.analysis.milp import Answer, Status
from hysdel_py.analysis.repairs import Repair, find_repairs, least_common_violation
from hysdel_py.analysis.settings import DEFAULT_SEARCH_TOLERANCES, SearchTolerances
from hysdel_py.analysis.subsets import irreducible, smallest
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["Finding", "Verdict", "find_contradiction"]

Set = frozenset[int]

_HELD_BACK = 0.4
"""Part of the time that the search for a smaller set must leave for ranges and repairs."""


_NOT_CONFIRMED = "the solver has a point that the simulator does not confirm"


class Verdict(Enum):
    """What was found."""

    FEASIBLE = "feasible"
    """There is a run, and the simulator confirms it."""
    SMALLEST = "smallest"
    """A contradiction with the least possible number of members."""
    IRREDUCIBLE = "irreducible"
    """A contradiction of which no member can be left out; there may be a smaller one."""
    NOT_SETTLED = "not settled"
    """Time was up, or the solver and the simulator disagree; what is shown, if anything, may be more than is needed."""


@dataclass(frozen=True, eq=False, slots=True)
class Finding:
    """Answer of the search.

    Attributes
    ----------
    verdict : Verdict
    members : tuple of Member
        The contradiction, by time; empty without one.
    ends : tuple of End
        The ends of ranges that it needs.
    repairs : tuple of Repair
        What alone would make the problem feasible.
    violation : float
        Least number by which all requirements, limits and ranges would have to give at once; infinite if unknown.
    borderline : bool
        Whether that is within a few times the tolerance of the solver, or the contradiction is one only where events
        that are false keep away from their thresholds.
    run : Trajectory or None
    message : str
        Why it is not settled.
    calls : int
        Mixed-integer searches.
    seconds : float
    """

    verdict: Verdict
    members: tuple[Member, ...] = ()
    ends: tuple[End, ...] = ()
    repairs: tuple[Repair, ...] = ()
    violation: float = inf
    borderline: bool = False
    run: Trajectory | None = None
    message: str = ""
    calls: int = 0
    seconds: float = 0.0


def find_contradiction(
    dha: Dha,
    horizon: Horizon,
    demands: Sequence[Demand] = (),
    *,
    seconds: float = inf,
    tolerances: SearchTolerances = DEFAULT_SEARCH_TOLERANCES,
    kept_apart: Callable[[float], Horizon] | None = None,
    progress: Watch | None = None,
) -> Finding:
    """Find the smallest contradiction of a horizon, or a run.

    Parameters
    ----------
    dha : Dha
    horizon : Horizon
        Of that Dha.
    demands : sequence of Demand
        Those that are part of the horizon.
    seconds : float
        Time limit.
    tolerances : SearchTolerances
    kept_apart : callable, optional
        The same horizon with events kept away from their thresholds, as the argument `apart` of
        :func:`~hysdel_py.analysis.horizon.build_horizon` does it. It is asked for where the simulator does not confirm
        the point of the solver, which then may stand on the wrong side of a threshold.
    progress : callable, optional
        Told the number of searches begun; a true answer ends the work as if its time were over.
    """
    consistency = Consistency(horizon, Clock(seconds, progress), tolerances)
    finding = _settled(dha, consistency, demands)
    if kept_apart is None or consistency.clock.is_over or not finding.message.startswith(_NOT_CONFIRMED):
        return finding
    apart = Consistency(kept_apart(tolerances.apart), consistency.clock, tolerances)
    second = _settled(dha, apart, demands)
    # The first search had a point, which misses what is demanded by no more than the tolerance of the solver.
    return replace(second, borderline=True, violation=tolerances.rows) if second.members or second.ends else second


def _settled(dha: Dha, consistency: Consistency, demands: Sequence[Demand]) -> Finding:
    answer = consistency.search(consistency.members | consistency.ends)
    match answer.status:
        case Status.FOUND:
            return _run(dha, consistency, demands, answer)
        case Status.NONE:
            return _contradiction(consistency)
        case _:
            return _unsettled(consistency, "the search for a run ended without an answer")


def _run(dha: Dha, consistency: Consistency, demands: Sequence[Demand], answer: Answer) -> Finding:
    horizon, tolerances = consistency.horizon, consistency.tolerances
    inside = moved_inside(horizon.problem, answer.w, tolerances)
    for tolerance in (dha.tolerances.range, tolerances.rows):
        for w in (inside, answer.w):
            run, problem = confirmed(dha, horizon, demands, w, tolerance)
            if run is not None:
                return Finding(
                    Verdict.FEASIBLE,
                    run=run,
                    borderline=tolerance > dha.tolerances.range,
                    violation=tolerance,
                    calls=consistency.calls,
                    seconds=consistency.clock.elapsed,
                )
    return _unsettled(consistency, f"{_NOT_CONFIRMED}: {problem}")


def _unsettled(consistency: Consistency, message: str) -> Finding:
    return Finding(Verdict.NOT_SETTLED, message=message, calls=consistency.calls, seconds=consistency.clock.elapsed)


def _contradiction(consistency: Consistency) -> Finding:
    horizon, ends = consistency.horizon, consistency.ends

    def contradicts(members: Set) -> bool:
        return consistency.contradicts(members | ends)

    known = _irreducible_members(consistency)
    settled = not consistency.doubtful
    consistency.clock.hold_back(_HELD_BACK)
    found, proven = smallest(
        contradicts,
        lambda members: consistency.around(members | ends, consistency.members, known - members),
        known,
        lambda: consistency.clock.is_over,
    )
    verdict = _verdict(settled and (not consistency.doubtful or found == known), proven and not consistency.doubtful)
    consistency.clock.hold_back(0.0)
    needed = _needed_ends(consistency, found)
    members = tuple(horizon.members[i] for i in sorted(found))
    violation = least_common_violation(consistency)
    repairs = find_repairs(consistency, (*members, *needed))
    return Finding(
        verdict,
        members,
        needed,
        repairs,
        violation,
        violation <= consistency.tolerances.borderline,
        message=_time_is_up(consistency, verdict),
        calls=consistency.calls,
        seconds=consistency.clock.elapsed,
    )


def _time_is_up(consistency: Consistency, verdict: Verdict) -> str:
    if consistency.clock.is_over:
        return "the time limit ended the search; ranges and remedies may be missing"
    return "" if verdict is Verdict.SMALLEST else "the time limit ended the search for a smaller set"


def _verdict(settled: bool, proven: bool) -> Verdict:
    if not settled:
        return Verdict.NOT_SETTLED
    return Verdict.SMALLEST if proven else Verdict.IRREDUCIBLE


def _irreducible_members(consistency: Consistency) -> Set:
    every = tuple(sorted(consistency.members))
    ends = consistency.ends
    named = consistency.named_by_relaxation(every)
    candidates = named if named and consistency.contradicts(frozenset(named) | ends) else every
    return frozenset(irreducible(consistency.contradicts, ends, candidates))


def _needed_ends(consistency: Consistency, members: Set) -> tuple[End, ...]:
    """Ends of ranges without which the members would not contradict each other; declared ones are preferred.

    There are none where the time is over before they are known.
    """
    first = len(consistency.horizon.members)
    ends = consistency.horizon.ends
    order = sorted(consistency.ends, key=lambda number: ends[number - first].derived)
    needed = irreducible(consistency.contradicts, members, order)
    return () if consistency.clock.is_over else tuple(ends[number - first] for number in sorted(needed))
