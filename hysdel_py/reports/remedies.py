"""Changes of which each alone would allow a run, in words."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from math import inf

from hysdel_py.analysis.contradiction import Finding
from hysdel_py.analysis.horizon import Demand, End, Member, MemberKind
from hysdel_py.analysis.repairs import Amount, Repair
from hysdel_py.reports.demands import comparison
from hysdel_py.systems.dha import AffineRequirement, Dha

__all__ = ["outwards", "remedies"]

_DIGITS = 6
_NOISE_DIGITS = 9


def remedies(finding: Finding, dha: Dha, demands: Sequence[Demand]) -> tuple[str, ...]:
    """One line for each change; numbers are rounded so that the change is large enough."""
    return tuple(_remedy(repair, dha, demands) for repair in finding.repairs)


def _remedy(repair: Repair, dha: Dha, demands: Sequence[Demand]) -> str:
    part = repair.part
    if isinstance(part, End):
        return _range(part, repair.value)
    match part.kind:
        case MemberKind.START:
            return _start(part, repair)
        case MemberKind.INPUT:
            return f"input {part.name}: free within its range instead of given"
        case MemberKind.LIMIT:
            return _limit(part, repair.value, demands)
        case _:
            return _requirement(part, repair, dha)


def _start(part: Member, repair: Repair) -> str:
    if repair.amount is Amount.ENTIRELY:
        return f"x(0): {part.name} = {1.0 - part.value:g} instead of {part.value:g}"
    value = outwards(part.value + repair.value, up=repair.value > 0)
    return f"x(0): {part.name} = {value} instead of {part.value:.9g}"


def _range(end: End, amount: float) -> str:
    value = outwards(end.value + (amount if end.is_high else -amount), up=end.is_high)
    sign = "<=" if end.is_high else ">="
    return f"range: {end.variable.name} {sign} {value} instead of {end.value:.6g}, at all steps"


def _limit(part: Member, amount: float, demands: Sequence[Demand]) -> str:
    demand = next(d for d in demands if d.what == part.name)
    return f"limit: {_given(demand.terms, demand.low, demand.high, amount)} instead of {part.name}"


def _requirement(part: Member, repair: Repair, dha: Dha) -> str:
    origin = part.origin
    assert origin is not None  # a requirement comes from an item
    text = f"{origin.text} (line {origin.line})" if origin.line else origin.text
    if repair.amount is Amount.ENTIRELY:
        return f"MUST: without {text}, at all steps"
    form = next(item.value for item in dha.items if isinstance(item, AffineRequirement) and item.origin == origin)
    if any(name.startswith("__") for name, _ in form.terms) or not form.terms:
        return f"MUST: {outwards(repair.value, up=True)} more room in {text}, at all steps"
    return f"MUST: {_given(form.terms, -inf, -form.constant, repair.value)} instead of {text}, at all steps"


def _given(terms: tuple[tuple[str, float], ...], low: float, high: float, amount: float) -> str:
    """A comparison that gives by an amount."""
    flipped = all(coefficient <= 0 for _, coefficient in terms)
    is_high = (high < inf) != flipped
    end = (high if high < inf else low) * (-1.0 if flipped else 1.0)
    value = float(outwards(end + (amount if is_high else -amount), up=is_high))
    shown = -value if flipped else value
    return comparison(terms, -inf, shown) if high < inf else comparison(terms, shown, inf)


def outwards(value: float, *, up: bool) -> str:
    """A number with six digits that is not smaller, or not greater, than a value apart from noise."""
    exact = Decimal(f"{value:.{_NOISE_DIGITS}g}")
    if not exact:
        return "0"
    unit = Decimal(1).scaleb(exact.adjusted() - _DIGITS + 1)
    return f"{float(exact.quantize(unit, rounding=ROUND_CEILING if up else ROUND_FLOOR)):.6g}"
