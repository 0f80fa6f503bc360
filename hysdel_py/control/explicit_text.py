"""Explicit laws as text."""

from __future__ import annotations

import numpy as np

from hysdel_py.control.explicit_law import ExplicitLaw, Vector

__all__ = ["describe_law", "region_text"]

_ROUNDING = 1e-12
"""Share of the greatest number of a sum below which a number is rounding."""


def describe_law(law: ExplicitLaw) -> str:
    """Sizes, then for each region its rows and its move."""
    lines = [
        f"explicit law: {law.count} regions, {len(law.b)} rows, {law.p} parameters ({', '.join(law.names)}), "
        f"{law.moves} moves",
        "complete" if law.complete else "incomplete: there may be further regions",
    ]
    for region in range(law.count):
        lines += region_text(law, region)
    return "\n".join(lines) + "\n"


def region_text(law: ExplicitLaw, region: int) -> list[str]:
    """Lines of one region: active rows, rows over the parameters, moves."""
    A, b = law.rows(region)
    rows = ", ".join(str(row) for row in law.active[region]) or "none"
    lines = [f"region {region}, active rows: {rows}"]
    lines += [f"  {_sum(row, 0.0, law.names)} <= {side:.6g}" for row, side in zip(A, b, strict=True)]
    for move in range(law.moves):
        lines.append(f"  move {move} = {_sum(law.K[region, move], law.k[region, move], law.names)}")
    return lines


def _sum(coefficients: Vector, constant: float, names: tuple[str, ...]) -> str:
    """A sum of terms; what rounding leaves of a zero is left out."""
    size = max(float(np.abs(coefficients).max(initial=0.0)), abs(constant))
    numbers = [*coefficients.tolist(), float(constant)]
    terms = [
        _term(number, name)
        for number, name in zip(numbers, [*names, ""], strict=True)
        if abs(number) > _ROUNDING * size
    ]
    text = " ".join(terms) or "+ 0"
    return text[2:] if text.startswith("+") else "-" + text[2:]


def _term(number: float, name: str) -> str:
    """One term with its sign in front; a coefficient of one is not written."""
    size = f"{abs(number):.6g}"
    factor = name if name and size == "1" else f"{size}*{name}" if name else size
    return f"{'-' if number < 0 else '+'} {factor}"
