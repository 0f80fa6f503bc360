"""The limits of a linear plan as rows over its columns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.bands import Band, Polytope
from hysdel_py.control.linear_columns import Columns
from hysdel_py.control.linear_horizons import Horizons
from hysdel_py.control.linear_limits import SOFT, ResolvedLinearLimits
from hysdel_py.control.linear_prediction import LinearPrediction

__all__ = ["LimitRow", "SlackPlan", "limit_rows", "plan_slacks"]

Vector = NDArray[np.float64]
Key = tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class LimitRow:
    """``low <= form (v, theta, 1) <= high``.

    Attributes
    ----------
    form : array of shape (width,)
    low, high : float
    group : str
        ``"u"``, ``"du"``, ``"y"``, ``"x"``, ``"terminal"`` or ``"slack"``.
    name : str
        Of the signal, or the number of the row of a terminal set.
    time : int
    """

    form: Vector
    low: float
    high: float
    group: str
    name: str
    time: int

    def __str__(self) -> str:
        symbol = {"du": f"increment of {self.name}", "terminal": f"terminal row {self.name}"}.get(self.group, self.name)
        sides = f"{self.low:g} <= " if self.low > -inf else "", f" <= {self.high:g}" if self.high < inf else ""
        return f"{sides[0]}{symbol}{sides[1]} at time {self.time}"


@dataclass(frozen=True, slots=True)
class SlackPlan:
    """Which slack softens which limit.

    Attributes
    ----------
    labels : tuple of str
        What each slack stands for.
    index : mapping
        From the key of a limit at a time to its slack.
    """

    labels: tuple[str, ...]
    sharing: str
    soft: bool
    terminal: bool = False

    def of(self, group: str, name: str, time: int) -> int | None:
        """Index of the slack of a limit at a time, None for a hard one."""
        if not self.soft or (group not in SOFT and not (group == "terminal" and self.terminal)):
            return None
        return self.labels.index(_label(self.sharing, group, name, time))


def plan_slacks(limits: ResolvedLinearLimits, horizons: Horizons, *, soften_terminal: bool = False) -> SlackPlan:
    """Number the slacks of softened limits.

    Parameters
    ----------
    limits : ResolvedLinearLimits
    horizons : Horizons
    soften_terminal : bool
        Whether the terminal set is softened too, as a fallback does.
    """
    soft = limits.rho < inf
    labels = [
        _label(limits.slack, group, band.name, time)
        for group in SOFT
        for band in limits.of(group)
        for time in horizons.output_times
    ]
    if soften_terminal:
        labels.append(_label(limits.slack, "terminal", "set", horizons.steps))
    return SlackPlan(tuple(dict.fromkeys(labels)) if soft else (), limits.slack, soft, soften_terminal)


def _label(sharing: str, group: str, name: str, time: int) -> str:
    signal = "terminal" if group == "terminal" else f"{group}.{name}"
    return {"all": "limits", "signal": signal, "stage": f"{signal}({time})"}[sharing]


def limit_rows(
    limits: ResolvedLinearLimits,
    prediction: LinearPrediction,
    horizons: Horizons,
    slacks: SlackPlan,
    terminal: Polytope | None,
) -> tuple[LimitRow, ...]:
    """All rows, without those that hold whatever the plan is and without repetitions.

    Parameters
    ----------
    limits : ResolvedLinearLimits
    prediction : LinearPrediction
    horizons : Horizons
    slacks : SlackPlan
    terminal : Polytope or None
        The set of the last state.
    """
    columns = prediction.columns
    hard = [*_signal_rows(limits, prediction, horizons), *_terminal_rows(terminal, prediction)]
    rows = [row for one in hard for row in _softened(one, slacks, columns)]
    if limits.rho_linear > 0:
        rows += [LimitRow(columns.slack(i)[0], 0.0, inf, "slack", label, 0) for i, label in enumerate(slacks.labels)]
    return tuple(_distinct(rows))


def _signal_rows(limits: ResolvedLinearLimits, prediction: LinearPrediction, horizons: Horizons) -> Iterator[LimitRow]:
    forms = {"y": prediction.y, "x": prediction.x, "du": prediction.du, "u": prediction.u}
    times = {"y": horizons.output_times, "x": horizons.output_times}
    for band in limits.bands:
        for time in times.get(band.group, horizons.input_times):
            yield _row(band, time, forms[band.group])


def _row(band: Band, time: int, forms: Sequence[Vector]) -> LimitRow:
    return LimitRow(forms[time][band.column], *band.at(time), band.group, band.name, time)


def _terminal_rows(terminal: Polytope | None, prediction: LinearPrediction) -> Iterator[LimitRow]:
    if terminal is None:
        return
    last = len(prediction.x) - 1
    for i, (form, high) in enumerate(zip(terminal.S @ prediction.x[-1], terminal.T.tolist(), strict=True)):
        yield LimitRow(form, -inf, high, "terminal", str(i), last)


def _softened(row: LimitRow, slacks: SlackPlan, columns: Columns) -> Iterator[LimitRow]:
    """One row, or the two sides of a softened limit."""
    name = "set" if row.group == "terminal" else row.name
    i = slacks.of(row.group, name, row.time)
    if i is None:
        yield row
        return
    slack = columns.slack(i)[0]
    labels = row.group, row.name, row.time
    if row.high < inf:
        yield LimitRow(row.form - slack, -inf, row.high, *labels)
    if row.low > -inf:
        yield LimitRow(row.form + slack, row.low, inf, *labels)


def _distinct(rows: list[LimitRow]) -> Iterator[LimitRow]:
    seen = set()
    for row in rows:
        key = row.form.tobytes(), row.low, row.high
        unlimited = row.low == -inf and row.high == inf
        holds = not row.form[:-1].any() and row.low <= row.form[-1] <= row.high
        if key not in seen and not unlimited and not holds:
            seen.add(key)
            yield row
