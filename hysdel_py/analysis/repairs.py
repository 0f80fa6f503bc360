"""By how much one requirement, limit, range or given value would have to give, at all steps alike."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from math import inf

from hysdel_py.analysis.consistency import Consistency
from hysdel_py.analysis.horizon import End, Horizon, Member, MemberKind
from hysdel_py.analysis.milp import Milp, Row, Status

__all__ = ["Amount", "Repair", "find_repairs", "least_common_violation"]

Part = Member | End


class Amount(Enum):
    """How far something has to give."""

    BY = "by an amount"
    ENTIRELY = "entirely"


@dataclass(frozen=True, slots=True)
class Repair:
    """One thing that alone would make the problem feasible.

    Attributes
    ----------
    part : Member or End
        The first place of what gives; it gives at all steps alike.
    amount : Amount
    value : float
        By how much; the change of the value, with its sign, for a first state.
    """

    part: Part
    amount: Amount
    value: float = 0.0


def find_repairs(consistency: Consistency, parts: Iterable[Part]) -> tuple[Repair, ...]:
    """Repairs by one thing each, for the things that some parts belong to."""
    found = []
    for part in _once_each(parts):
        if consistency.clock.is_over:
            break
        repair = _amount(consistency, part) if _gives_by_amount(part) else _without(consistency, part)
        if repair is not None:
            found.append(repair)
    return tuple(found)


def least_common_violation(consistency: Consistency) -> float:
    """Least number by which all requirements, limits and ranges must give at once; infinite if that is not enough."""
    horizon = consistency.horizon
    soft: list[Part] = [m for m in horizon.members if m.kind in _INEQUALITIES and m.numeric]
    soft += [end for end in horizon.ends if not end.derived]
    problem, t = _softened(consistency, soft)
    answer = problem.search({t: 1.0}, seconds=consistency.clock.allowance())
    return max(0.0, answer.value) if answer.status is Status.FOUND else inf


_INEQUALITIES = (MemberKind.REQUIREMENT, MemberKind.LIMIT)


def _once_each(parts: Iterable[Part]) -> list[Part]:
    first: dict[object, Part] = {}
    for part in parts:
        if not (isinstance(part, Member) and part.kind is MemberKind.DEFINITION):
            first.setdefault(_thing(part), part)
    return list(first.values())


def _thing(part: Part) -> object:
    """What is the same at all steps."""
    if isinstance(part, End):
        return (part.variable.name, part.is_high)
    return (part.kind, part.name, part.origin.group if part.origin else 0)


def _gives_by_amount(part: Part) -> bool:
    return isinstance(part, End) or (part.numeric and part.kind is not MemberKind.INPUT)


def _whole(horizon: Horizon, part: Part) -> list[Part]:
    """The same thing at all steps."""
    kin: list[Part] = [*horizon.members] if isinstance(part, Member) else [*horizon.ends]
    return [other for other in kin if _thing(other) == _thing(part)]


def _without(consistency: Consistency, part: Part) -> Repair | None:
    gone = {consistency.horizon.members.index(m) for m in _whole(consistency.horizon, part) if isinstance(m, Member)}
    rest = (consistency.members | consistency.ends) - gone
    answer = consistency.search(rest)
    return Repair(part, Amount.ENTIRELY) if answer.status is Status.FOUND else None


def _amount(consistency: Consistency, part: Part) -> Repair | None:
    problem, t = _softened(consistency, _whole(consistency.horizon, part))
    answer = problem.search({t: 1.0}, seconds=consistency.clock.allowance())
    if answer.status is not Status.FOUND:
        return None
    if isinstance(part, Member) and part.kind is MemberKind.START:
        return Repair(part, Amount.BY, float(answer.w[consistency.horizon.states[0][part.name]] - part.value))
    return Repair(part, Amount.BY, float(answer.w[t]))


def _softened(consistency: Consistency, soft: list[Part]) -> tuple[Milp, int]:
    """The whole problem in which some parts may give by a common amount, and where that amount is."""
    horizon = consistency.horizon
    first = len(horizon.members)
    ends = {first + horizon.ends.index(part) for part in soft if isinstance(part, End)}
    chosen = [number for number, m in enumerate(horizon.members) if m in soft]
    problem = consistency.problem((consistency.members | consistency.ends) - ends - frozenset(chosen))
    t = problem.real(0.0)
    for number in chosen:
        for row in (horizon.problem.rows[index] for index in horizon.rows[number]):
            if _is_generated(row):
                problem.rows.append(row)
            else:
                _give(problem, dict(row.terms), row.low, row.high, t)
    for part in soft:
        if isinstance(part, End):
            low, high = (-inf, part.value) if part.is_high else (part.value, inf)
            _give(problem, {part.place: 1.0}, low, high, t)
    return problem, t


def _is_generated(row: Row) -> bool:
    """Whether a row defines what an item needs, such as a cast, and is not what the item demands."""
    return row.source is not None and row.source.origin is not None and row.source.origin.subgroup > 1


def _give(problem: Milp, terms: dict[int, float], low: float, high: float, t: int) -> None:
    if low > -inf:
        problem.row({**terms, t: 1.0}, low=low)
    if high < inf:
        problem.row({**terms, t: -1.0}, high=high)
