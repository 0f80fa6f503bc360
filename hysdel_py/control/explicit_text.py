"""Explicit laws as text."""

from __future__ import annotations

import numpy as np

from hysdel_py.control.explicit_law import ExplicitLaw, Vector

__all__ = ["describe_law"]


def describe_law(law: ExplicitLaw) -> str:
    """Sizes, then for each region its rows and its move."""
    lines = [
        f"explicit law: {law.count} regions, {len(law.b)} rows, {law.p} parameters ({', '.join(law.names)}), "
        f"{law.moves} moves",
        "complete" if law.complete else "incomplete: there may be further regions",
    ]
    for region in range(law.count):
        lines += _region(law, region)
    return "\n".join(lines) + "\n"


def _region(law: ExplicitLaw, region: int) -> list[str]:
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
    text = ""
    for coefficient, name in zip(coefficients, names, strict=True):
        if abs(coefficient) > 1e-12 * size:
            text += f" {'-' if coefficient < 0 else '+'} {abs(coefficient):.6g}*{name}"
    if abs(constant) > 1e-12 * size:
        text += f" {'-' if constant < 0 else '+'} {abs(constant):.6g}"
    text = text.strip() or "0"
    return text.removeprefix("+ ") if text.startswith("+") else text.replace("- ", "-", 1) if text[0] == "-" else text
