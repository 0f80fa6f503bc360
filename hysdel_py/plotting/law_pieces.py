"""Regions of a law over two parameters as coloured polygons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.explicit_tree import same_moves
from hysdel_py.plotting.modes import clip
from hysdel_py.plotting.style import COLOURS

__all__ = ["Piece", "area_of", "colour_of", "kinds_of", "law_text", "pieces_of", "ranked", "values_of"]

Array = NDArray[np.float64]

_CONSTANT = 1e-9
"""Gains below this share of the greatest one are zero: the move is constant."""

_SHADES = (0.0, 0.45, 0.7)
"""Share of white in the colours of the first, second and third round."""


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """One region.

    Attributes
    ----------
    region, kind : int
        Number of the region, and of its colour.
    corners : array of shape (n, 2)
    colour, text : str
        `text` is the move as a formula.
    """

    region: int
    kind: int
    corners: Array
    colour: str
    text: str

    @property
    def area(self) -> float:
        """Area of the polygon."""
        return area_of(self.corners)


def kinds_of(law: ExplicitLaw, by: str) -> list[int]:
    """Number of the colour of each region."""
    keys = same_moves(law) if by == "law" else tuple(range(law.count))
    numbers = {key: number for number, key in enumerate(dict.fromkeys(keys))}
    return [numbers[key] for key in keys]


def colour_of(kind: int) -> str:
    """Colour of a kind: the first ones full, further rounds lighter."""
    from matplotlib.colors import to_hex, to_rgb

    palette = COLOURS[:-1]  # black is for the run
    white = _SHADES[kind // len(palette) % len(_SHADES)]
    red, green, blue = ((1 - white) * part + white for part in to_rgb(palette[kind % len(palette)]))
    return to_hex((red, green, blue))


def pieces_of(law: ExplicitLaw, by: str) -> list[Piece]:
    """Polygons of all regions that have inner points; of moves, the most frequent have the first colours."""
    polygons = {region: _polygon(law, region) for region in range(law.count)}
    shown = {region: corners for region, corners in polygons.items() if len(corners) > 2}
    kinds = kinds_of(law, by)
    if by == "law":
        rank = ranked([kinds[region] for region in shown], [area_of(corners) for corners in shown.values()])
        kinds = [rank.get(kind, kind) for kind in kinds]
    return [
        Piece(region, kinds[region], corners, colour_of(kinds[region]), law_text(law, region))
        for region, corners in shown.items()
    ]


def ranked(kinds: Sequence[int], areas: Sequence[float]) -> dict[int, int]:
    """New numbers of the kinds, those first that cover most: the named ones so have colours of their own."""
    total: dict[int, float] = {}
    for kind, area in zip(kinds, areas, strict=True):
        total[kind] = total.get(kind, 0.0) + area
    order = sorted(total, key=lambda kind: (-total[kind], kind))
    return {kind: number for number, kind in enumerate(order)}


def area_of(corners: Array) -> float:
    """Area of a polygon."""
    x, y = corners.T
    return 0.5 * abs(float(np.sum(np.roll(x, 1) * y - x * np.roll(y, 1))))


def _polygon(law: ExplicitLaw, region: int) -> Array:
    """The box of the domain cut by the rows of a region."""
    (left, low), (right, high) = law.domain.bounding_box
    corners = np.array([[left, low], [right, low], [right, high], [left, high]])
    for row, side in zip(*law.rows(region), strict=True):
        corners = clip(corners, row, float(side))
    return corners


def values_of(law: ExplicitLaw, region: int, points: Array) -> Array:
    """Value of a region at points, the last axis of which is that of the parameters."""
    quadratic = np.einsum("...i,ij,...j->...", points, law.P[region], points)
    return np.asarray(0.5 * quadratic + points @ law.q[region] + law.r[region])


def law_text(law: ExplicitLaw, region: int) -> str:
    """The move of a region as a formula, one line for each entry."""
    return "\n".join(_sum(law, region, move) for move in range(law.moves))


def _sum(law: ExplicitLaw, region: int, move: int) -> str:
    gains, constant = law.K[region, move], float(law.k[region, move])
    greatest = max(float(np.abs(law.K[:, move]).max(initial=0.0)), 1e-300)
    terms = [
        _term(gain, f"{abs(gain):.3g} {name}")
        for gain, name in zip(gains.tolist(), law.names, strict=True)
        if abs(gain) > _CONSTANT * greatest
    ]
    if abs(constant) > _CONSTANT * max(1.0, float(np.abs(law.k[:, move]).max())) or not terms:
        terms.append(_term(constant, f"{abs(constant):.4g}"))
    text = " ".join(terms)
    return text[2:] if text.startswith("+") else "−" + text[2:]


def _term(number: float, size: str) -> str:
    return f"{'−' if number < 0 else '+'} {size}"
