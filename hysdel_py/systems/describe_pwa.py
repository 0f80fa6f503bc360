"""Readable text of a Pwa: its modes with their words, conditions and maps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.systems.affine import Affine
from hysdel_py.systems.describe import variable_lines
from hysdel_py.systems.mode import Mode

if TYPE_CHECKING:
    from hysdel_py.systems.pwa import Pwa

__all__ = ["describe_pwa", "map_texts"]


def describe_pwa(pwa: Pwa) -> str:
    """Variables, groups of equal dynamics, and each mode; ``'`` marks the next value of a state."""
    lines = [f"{pwa.name}: piecewise affine form, {_counts(pwa)}"]
    lines += variable_lines({"x": pwa.x, "u": pwa.u, "y": pwa.y, "d": pwa.d, "z": pwa.z})
    if pwa.modes and pwa.modes[0].word:
        lines.append(f"  word: {', '.join(name for name, _ in pwa.modes[0].word)}")
    lines += [f"  equal dynamics: modes {', '.join(map(str, group))}" for group in pwa.dynamics if len(group) > 1]
    for mode in pwa.modes:
        lines += _mode_lines(pwa, mode)
    return "\n".join(lines) + "\n"


def _counts(pwa: Pwa) -> str:
    flat = sum(mode.is_flat for mode in pwa.modes)
    count = f"{len(pwa.modes)} mode{'s' * (len(pwa.modes) != 1)}"
    ways = f"{len(pwa.dynamics)} different dynamics"
    notes = [f"{flat} of them flat"] * bool(flat) + ["not complete: the search was stopped"] * (not pwa.is_complete)
    return ", ".join([count, *notes, ways])


def _mode_lines(pwa: Pwa, mode: Mode) -> list[str]:
    flat = ", flat" * mode.is_flat
    word = f" {mode.bits}" if mode.bits else ""
    lines = [f"  mode {mode.index}{word}, {mode.region.m} rows{flat}"]
    lines += [f"    if {condition}" for condition in mode.conditions]
    names = [*(f"{v.name}'" for v in pwa.x), *(v.name for v in pwa.y)]
    return [*lines, *(f"    {name} = {text}" for name, text in zip(names, map_texts(mode), strict=True))]


def map_texts(mode: Mode) -> tuple[str, ...]:
    """Right sides of the next states and outputs."""
    return tuple(str(_affine(row, mode)) for row in mode.dynamics)


def _affine(row: NDArray[np.float64], mode: Mode) -> Affine:
    terms = tuple((name, float(c)) for name, c in zip(mode.names, row[:-1], strict=True) if c)
    return Affine(float(row[-1]), terms)
