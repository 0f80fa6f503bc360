"""Charts as SVG: lines and steps over a common axis, and bands. Colours are classes, which the page defines."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from hysdel_py.markup.elements import Markup, element

__all__ = ["COLOURS", "Frame", "Line", "band_chart", "line_chart", "room_for", "ticks"]

COLOURS = 7
"""Number of colours, the classes c0, c1 and so on."""
MOST_POINTS = 1500
"""Longer signals are drawn by the least and greatest value of each piece."""

_BAND = 16.0
_ROOM, _MOST_ROOM, _LETTER = 64.0, 260.0, 6.6
_TICK_STEPS = (1.0, 2.0, 5.0, 10.0)


@dataclass(frozen=True, slots=True)
class Line:
    """One signal.

    Attributes
    ----------
    name : str
    t, values : tuple of float
        As long as each other, or values one shorter: then each holds until the next time.
    held : bool
        Whether a value stays until the next time.
    """

    name: str
    t: tuple[float, ...]
    values: tuple[float, ...]
    held: bool


@dataclass(frozen=True, slots=True)
class Frame:
    """The area of a chart in the picture and the values at its ends."""

    t0: float
    t1: float
    low: float = 0.0
    high: float = 1.0
    left: float = _ROOM
    top: float = 8.0
    width: float = 640.0
    height: float = 120.0

    def x(self, t: float) -> float:
        """Place of a time."""
        return self.left + self.width * (t - self.t0) / ((self.t1 - self.t0) or 1.0)

    def y(self, value: float) -> float:
        """Place of a value."""
        return self.top + self.height * (self.high - value) / ((self.high - self.low) or 1.0)


def ticks(low: float, high: float, count: int = 4) -> tuple[float, ...]:
    """Round numbers between two values, about so many."""
    width = (high - low) / max(count, 1)
    if not width > 0 or not math.isfinite(width):
        return (low,)
    power = 10.0 ** math.floor(math.log10(width))
    step = next(power * s for s in _TICK_STEPS if power * s >= width * (1 - 1e-12))
    first = math.ceil(low / step - 1e-9)
    found = []
    while first * step <= high + 1e-9 * step:
        found.append(first * step)
        first += 1
    return tuple(found)


def room_for(names: Iterable[str]) -> float:
    """Width on the left of charts that bands with such names need."""
    return min(_MOST_ROOM, max(_ROOM, _LETTER * max(map(len, names), default=0) + 12.0))


def line_chart(lines: Sequence[Line], label: str, span: tuple[float, float], left: float = _ROOM) -> Markup:
    """Signals of one unit over time.

    Parameters
    ----------
    lines : sequence of Line
    label : str
        What the picture shows, for those who do not see it.
    span : pair of float
        First and last time.
    left : float
        Width on the left, the same for charts below each other.
    """
    values = [v for line in lines for v in line.values if math.isfinite(v)]
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    margin = 0.05 * (high - low) or 0.5 * (abs(high) or 1.0)
    frame = Frame(*span, low - margin, high + margin, left=left)
    drawn = [_path(line, frame, f"line c{k % COLOURS} s{k // COLOURS % 3}") for k, line in enumerate(lines)]
    return _picture(frame, label, [*_grid(frame), *drawn], low=frame.low, high=frame.high)


def band_chart(lines: Sequence[Line], label: str, span: tuple[float, float], left: float = _ROOM) -> Markup:
    """Bands, one below the other: filled while the value is not 0, in the colour of the value."""
    frame = Frame(*span, left=left, height=_BAND * max(1, len(lines)))
    drawn = [band for row, line in enumerate(lines) for band in _bands(line, frame, frame.top + _BAND * row)]
    return _picture(frame, label, [*_times(frame), *drawn])


def _bands(line: Line, frame: Frame, top: float) -> list[Markup]:
    found = [_text(frame.left - 6, top + 0.75 * _BAND, line.name, "end")]
    start = 0
    for value, group in groupby(line.values[: max(1, len(line.t) - 1)]):
        end = start + len(tuple(group))
        if value:
            x0, x1 = frame.x(line.t[start]), frame.x(line.t[min(end, len(line.t) - 1)])
            found.append(
                element(
                    "rect",
                    x=_place(x0),
                    y=_place(top + 2),
                    width=_place(max(x1 - x0, 0.5)),
                    height=_place(_BAND - 4),
                    class_=f"band b{(int(value) - 1) % COLOURS}",
                )
            )
        start = end
    return found


def _path(line: Line, frame: Frame, kind: str) -> Markup:
    points = _thinned(list(zip(line.t, line.values, strict=False)))
    words, pen = [], "M"
    for k, (t, value) in enumerate(points):
        if not math.isfinite(value):
            pen = "M"
            continue
        words.append(f"{pen}{_place(frame.x(t))} {_place(frame.y(value))}")
        if line.held:
            end = points[k + 1][0] if k + 1 < len(points) else line.t[-1]
            words.append(f"H{_place(frame.x(end))}")
        pen = "L"
    return element("path", element("title", line.name), d="".join(words), class_=kind)


def _thinned(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points, or the extremes of each piece of a very long signal."""
    if len(points) <= MOST_POINTS:
        return points
    size = math.ceil(2 * len(points) / MOST_POINTS)
    pieces = (points[k : k + size] for k in range(0, len(points), size))
    kept = [point for piece in pieces for point in sorted({min(piece, key=_value), max(piece, key=_value)})]
    return kept if kept[-1] == points[-1] else [*kept, points[-1]]


def _value(point: tuple[float, float]) -> float:
    return point[1]


def _grid(frame: Frame) -> list[Markup]:
    found = _times(frame)
    for value in ticks(frame.low, frame.high):
        y = _place(frame.y(value))
        found.append(element("line", x1=_place(frame.left), x2=_place(frame.left + frame.width), y1=y, y2=y,
                             class_="grid"))  # fmt: skip
        found.append(_text(frame.left - 6, frame.y(value) + 4, f"{value + 0.0:.4g}", "end"))
    return found


def _times(frame: Frame) -> list[Markup]:
    found, bottom = [], frame.top + frame.height
    for t in ticks(frame.t0, frame.t1, 8):
        x = _place(frame.x(t))
        found.append(element("line", x1=x, x2=x, y1=_place(frame.top), y2=_place(bottom), class_="grid"))
        found.append(_text(frame.x(t), bottom + 14, f"{t + 0.0:.4g}", "middle"))
    return found


def _text(x: float, y: float, text: str, anchor: str) -> Markup:
    return element("text", text, x=_place(x), y=_place(y), text_anchor=anchor)


def _picture(frame: Frame, label: str, inside: Sequence[Markup], **data: float) -> Markup:
    width, height = frame.left + frame.width + 12, frame.top + frame.height + 22
    ends = {"left": frame.left, "right": frame.left + frame.width, "top": frame.top, "bottom": frame.top + frame.height}
    told = {f"data_{name}": f"{value:.9g}" for name, value in (ends | data).items()}
    return element(
        "svg", element("title", label), *inside, viewBox=f"0 0 {width:g} {height:g}", role="img", aria_label=label,
        class_="chart", **told,
    )  # fmt: skip


def _place(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")
