"""A run on the page: traces, bands of Booleans and modes, what the controller needed, and the numbers behind it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.move import MoveStatus
from hysdel_py.markup.charts import COLOURS, Line, band_chart, line_chart, room_for
from hysdel_py.markup.elements import Child, Markup, as_json, element, fragment, table

if TYPE_CHECKING:
    from hysdel_py.reports.run_file import RecordedRun, RecordedSignal
    from hysdel_py.systems.pwa import Pwa

__all__ = ["modes_of", "run_section"]

Vector = NDArray[np.float64]

MOST_STEPS = 20_000
"""Of a longer run the page holds every second, third and so on step."""

_WORDS = {"x": "states", "u": "inputs", "y": "outputs", "z": "auxiliaries"}
_DIGITS = 9
_STATISTICS = (("seconds", "ms", 1e3), ("nodes", "", 1.0), ("qps", "", 1.0), ("cost", "", 1.0), ("gap", "", 1.0))


def run_section(run: RecordedRun, pwa: Pwa) -> Markup:
    """All about a run."""
    every = max(1, -(-len(run.t) // MOST_STEPS))
    t = run.t[::every]
    modes = modes_of(run, pwa)[::every]
    shown = _Shown(run, t, every, room_for(s.name for s in run.signals if s.is_bool))
    charts = [*_charts(shown), *_bands(shown, modes)]
    readout = element("p", "Point at a chart, or use the arrow keys in it, to read the numbers.", id="readout",
                      role="status", aria_live="polite")  # fmt: skip
    data = element("script", as_json(_data(run, t, every, modes)), type="application/json", id="run-data")
    messages = element("ul", [element("li", text) for text in run.messages]) if run.messages else None
    thinned = element("p", f"One of {every} steps is shown.", class_="remark") if every > 1 else None
    return fragment(messages, thinned, readout, charts, data, _statistics(run))


def modes_of(run: RecordedRun, pwa: Pwa) -> Vector:
    """Number of the mode of each step plus one, 0 where none has the Booleans of the step."""
    booleans = {s.name: s.values > 0.5 for s in run.group("x", "u", "d") if s.is_bool or s.group == "d"}
    steps = min((len(values) for values in booleans.values()), default=0)
    found = np.zeros(steps)
    for mode in reversed(pwa.modes):
        holds = np.ones(steps, dtype=bool)
        for name, value in mode.word:
            if value is not None and name in booleans:
                holds &= booleans[name][:steps] == value
        found[holds] = mode.index + 1
    return found


@dataclass(frozen=True, eq=False, slots=True)
class _Shown:
    """What of a run is drawn, and how much room is left of it."""

    run: RecordedRun
    t: Vector
    every: int
    left: float

    @property
    def span(self) -> tuple[float, float]:
        """First and last time."""
        return (float(self.t[0]), float(self.t[-1])) if len(self.t) else (0.0, 1.0)

    def line(self, name: str, values: Vector, *, held: bool) -> Line:
        """A signal at the times that are drawn."""
        return Line(name, tuple(self.t.tolist()), tuple(values.tolist()), held)


def _charts(shown: _Shown) -> Iterator[Markup]:
    """One chart for each vector and unit."""
    groups: dict[tuple[str, str], list[RecordedSignal]] = {}
    for signal in shown.run.group("x", "u", "y", "z"):
        if not signal.is_bool:
            groups.setdefault((signal.group, signal.unit), []).append(signal)
    for (key, unit), signals in groups.items():
        title = f"{_WORDS[key]} [{unit}]" if unit else _WORDS[key]
        lines = [shown.line(s.name, s.values[:: shown.every], held=s.group != "x") for s in signals]
        chart = line_chart(lines, f"{title} over time", shown.span, shown.left)
        yield _figure(title, chart, [s.name for s in signals])


def _bands(shown: _Shown, modes: Vector) -> Iterator[Markup]:
    signals = [s for s in shown.run.group("x", "u", "y", "d") if s.is_bool]
    if signals:
        lines = [shown.line(s.name, np.where(s.values[:: shown.every] > 0.5, 1.0, 0.0), held=True) for s in signals]
        chart = band_chart(lines, "Booleans over time", shown.span, shown.left)
        yield _figure("Booleans, filled where true", chart, [])
    if len(modes) and np.any(modes):
        used = sorted({int(v) - 1 for v in modes if v})
        chart = band_chart([shown.line("mode", modes, held=True)], "mode over time", shown.span, shown.left)
        yield _figure("modes", chart, [f"mode {k}" for k in used], used)


def _figure(title: str, chart: Markup, names: list[str], colours: list[int] | None = None) -> Markup:
    shown = colours if colours is not None else list(range(len(names)))
    kind = "b" if colours is not None else "c"
    keys = [
        element("li", element("span", "", class_=f"key {kind}{k % COLOURS} s{k // COLOURS % 3}"), name)
        for k, name in zip(shown, names, strict=True)
    ]
    legend = element("ul", keys, class_="legend") if keys else None
    framed = element("div", chart, class_="frame", tabindex="0", role="group", aria_label=f"{title}: arrow keys move")
    return element("figure", element("figcaption", title), framed, legend)


def _data(run: RecordedRun, t: Vector, every: int, modes: Vector) -> dict[str, object]:
    """Times and values for the readout."""
    signals = [{"name": s.name, "unit": s.unit, "values": _rounded(s.values[::every])} for s in run.signals]
    signals += (
        [{"name": "mode", "unit": "", "values": [int(v) - 1 if v else None for v in modes]}] if len(modes) else []
    )
    return {"t": _rounded(t), "signals": signals}


def _rounded(values: Vector) -> list[float | None]:
    return [float(f"{value:.{_DIGITS}g}") if np.isfinite(value) else None for value in values.tolist()]


def _statistics(run: RecordedRun) -> Markup | None:
    """What the controller needed, from what it recorded."""
    info = {signal.name: signal.values[np.isfinite(signal.values)] for signal in run.group("info")}
    if not len(info.get("status", ())):
        return None
    rows = [row for name, unit, scale in _STATISTICS for row in _summary(name, unit, scale, info)]
    head = ("record", "mean", "median", "95th percentile", "largest")
    return fragment(element("h3", "Controller"), element("p", _verdict(info)), table(head, rows, id="controller"))


def _summary(name: str, unit: str, scale: float, info: Mapping[str, Vector]) -> Iterator[tuple[Child, ...]]:
    values = info.get(name)
    if values is not None and len(values):
        v = scale * values
        label = f"{name} [{unit}]" if unit else name
        yield label, float(v.mean()), float(np.median(v)), float(np.percentile(v, 95)), float(v.max())


def _verdict(info: Mapping[str, Vector]) -> str:
    codes = info["status"].astype(int).tolist()
    words = [status.value for status in MoveStatus]
    counted = {word: codes.count(code) for code, word in enumerate(words) if code in codes}
    parts = ", ".join(f"{count} {word}" for word, count in counted.items())
    return f"{len(codes)} moves: {parts}."
