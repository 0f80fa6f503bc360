"""A move or the value of a law as a surface over two parameters."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.plotting.law_pieces import Piece, pieces_of, values_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot_surface"]

Array = NDArray[np.float64]

_PARTS = 8
"""A triangle is cut into so many parts along each side, so that a curved value looks curved."""

_MAP = "cividis"  # the same to all kinds of sight
_LABEL_ROOM = 12
_VIEW = -125.0
_ASIDE = 35.0
_OBLIQUE = 28.0
"""Degrees; seen along an axis, labels would hide each other."""


def plot_surface(law: ExplicitLaw, move: int | None, by: str, labels: tuple[str, str, str], title: str) -> Figure:
    """Draw a move, or the value where `move` is None; a move is affine on each region, which keeps its colour."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 6.0), dpi=120)
    FigureCanvasAgg(figure)
    axes: Any = figure.add_axes((0.02, 0.06, 0.9, 0.88), projection="3d")
    pieces = pieces_of(law, by)
    heights = _draw_value(axes, law, pieces) if move is None else _draw_move(axes, law, pieces, move)
    low, high = law.domain.bounding_box
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=_limits(heights))
    for axis, label in zip("xyz", (*labels[:2], "value" if move is None else labels[2]), strict=True):
        getattr(axes, f"set_{axis}label")(label, labelpad=_LABEL_ROOM)
    axes.view_init(elev=28, azim=_VIEW if move is None else _downhill(law, pieces, move, high - low))
    axes.set_title(title, fontsize=9, loc="left")
    return figure


def _downhill(law: ExplicitLaw, pieces: list[Piece], move: int, spans: Array) -> float:
    """Angle from which the greatest slope is seen, a little from the side."""
    steepest = max(pieces, key=lambda piece: float(np.abs(law.K[piece.region, move] * spans).sum()) * piece.area)
    across, upwards = -law.K[steepest.region, move] * spans
    quarter, rest = divmod(float(np.degrees(np.arctan2(upwards, across))) + _ASIDE, 90.0)
    return 90.0 * quarter + min(max(rest, _OBLIQUE), 90.0 - _OBLIQUE)


def _limits(heights: Array) -> tuple[float, float]:
    low, high = float(heights.min()), float(heights.max())
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def _draw_move(axes: Any, law: ExplicitLaw, pieces: list[Piece], move: int) -> Array:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    faces = []
    for piece in pieces:
        height = piece.corners @ law.K[piece.region, move] + law.k[piece.region, move]
        faces.append(np.column_stack([piece.corners, height]))
    colours = [piece.colour for piece in pieces]
    axes.add_collection3d(Poly3DCollection(faces, facecolors=colours, edgecolors="white", linewidths=0.4))
    return np.concatenate([face[:, 2] for face in faces])


def _draw_value(axes: Any, law: ExplicitLaw, pieces: list[Piece]) -> Array:
    from matplotlib import colormaps
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    triangles, borders = [], []
    for piece in pieces:
        flat = _triangles(piece.corners)
        triangles.append(np.concatenate([flat, values_of(law, piece.region, flat)[..., None]], axis=-1))
        edge = _finer(np.vstack([piece.corners, piece.corners[:1]]))
        borders.append(np.column_stack([edge, values_of(law, piece.region, edge)]))
    faces = np.concatenate(triangles)
    low, high = _limits(faces[..., 2])
    colours = colormaps[_MAP]((faces[..., 2].mean(axis=1) - low) / (high - low))
    axes.add_collection3d(Poly3DCollection(faces, facecolors=colours, edgecolors=colours, linewidths=0.2))
    axes.add_collection3d(Line3DCollection(borders, colors="white", linewidths=0.5))
    return np.asarray(faces[..., 2])


def _triangles(corners: Array) -> Array:
    """A convex polygon as small triangles, shape (n, 3, 2)."""
    whole = [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    return np.array([small for a, b, c in whole for small in _parts(a, b, c)])


def _parts(a: Array, b: Array, c: Array) -> list[tuple[Array, Array, Array]]:
    along, across = (b - a) / _PARTS, (c - a) / _PARTS

    def at(i: int, j: int) -> Array:
        return np.asarray(a + i * along + j * across)

    cells = [(i, j) for i in range(_PARTS) for j in range(_PARTS - i)]
    up = [(at(i, j), at(i + 1, j), at(i, j + 1)) for i, j in cells]
    return up + [(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for i, j in cells if i + j < _PARTS - 1]


def _finer(line: Array) -> Array:
    steps = np.linspace(0.0, 1.0, _PARTS, endpoint=False)[:, None]
    parts = [start + steps * (end - start) for start, end in pairwise(line)]
    return np.vstack([*parts, line[-1:]])
