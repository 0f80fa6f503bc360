"""Rows of the program: what the model and the limits demand at each stage, with their meaning."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.affine import Affine
from hysdel_py.control.layout import Layout
from hysdel_py.control.limits import Band, ResolvedLimits
from hysdel_py.systems.origin import RowOrigin

__all__ = ["Block", "Row", "row_blocks"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Row:
    """Meaning of one row of the program.

    Attributes
    ----------
    kind : str
        ``"update"``, ``"model"`` (an inequality of the MLD form) or ``"limit"``.
    stage : int
        Time to which the row belongs.
    text : str
        What it says, with the line of the source where there is one.
    origin : RowOrigin or None
    """

    kind: str
    stage: int
    text: str
    origin: RowOrigin | None = None

    def __str__(self) -> str:
        return f"{self.kind}[{self.stage}] {self.text}"


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Rows ``low <= value <= high`` with their meaning, before they are put together."""

    value: Affine
    low: Matrix
    high: Matrix
    rows: tuple[Row, ...]


def row_blocks(layout: Layout, limits: ResolvedLimits, unmovable: tuple[Band, ...]) -> Iterator[Block]:
    """Yield all rows, stage by stage; the limits in `unmovable` are left out at time 0."""
    for k in range(layout.horizon):
        yield _update(layout, k)
        yield _model_rows(layout, k)
        for band in limits.bands:
            if band.group == "y" and not (k == 0 and band in unmovable):
                yield from _band_rows(layout, band, limits.slack_of(band), k)
            elif band.group == "x" and limits.slack_of(band) is not None:
                yield from _band_rows(layout, band, limits.slack_of(band), k + 1)
    for band in limits.bands:
        if band.group == "terminal" and limits.slack_of(band) is not None:
            yield from _band_rows(layout, band, limits.slack_of(band), layout.horizon)
    yield from _polytope_rows(layout, limits)


def _update(layout: Layout, k: int) -> Block:
    mld = layout.mld
    value = layout.successor(k) - layout.signal("x", k + 1)
    rows = tuple(
        _row("update", k + 1, v.name, origin) for v, origin in zip(mld.x, _padded(mld.updates, mld.nx), strict=True)
    )
    return Block(value, np.zeros(mld.nx), np.zeros(mld.nx), rows)


def _model_rows(layout: Layout, k: int) -> Block:
    mld = layout.mld
    rows = tuple(_row("model", k, f"row {i}", origin) for i, origin in enumerate(_padded(mld.rows, mld.ne)))
    return Block(layout.inequalities(k), np.full(mld.ne, -inf), np.zeros(mld.ne), rows)


def _padded(origins: tuple[RowOrigin, ...], length: int) -> tuple[RowOrigin | None, ...]:
    """Origins of all rows, None for those of a model that was built without."""
    return (*origins, *([None] * (length - len(origins))))


def _row(kind: str, stage: int, text: str, origin: RowOrigin | None) -> Row:
    if origin is None:
        return Row(kind, stage, text)
    where = f" (line {origin.line})" if origin.line else ""
    return Row(kind, stage, f"{text}: {origin.text}{where}", origin)


def _band_rows(layout: Layout, band: Band, slack: int | None, time: int) -> Iterator[Block]:
    group = "y" if band.group == "y" else "x"
    value = layout.signal(group, time).entry(band.column)
    row = Row("limit", time, f"{group} {band.name} in [{band.low:g}, {band.high:g}]")
    if slack is None:
        yield Block(value, np.array([band.low]), np.array([band.high]), (row,))
        return
    eps = layout.single(layout.slack(slack), 1.0)
    if band.low > -inf:
        yield Block(value + eps, np.array([band.low]), np.array([inf]), (row,))
    if band.high < inf:
        yield Block(value - eps, np.array([-inf]), np.array([band.high]), (row,))


def _polytope_rows(layout: Layout, limits: ResolvedLimits) -> Iterator[Block]:
    if limits.polytope is None:
        return
    S, T = limits.polytope.S, limits.polytope.T
    value = layout.signal("x", layout.horizon).times(S)
    if limits.polytope_slack is not None:
        value = value - layout.single(layout.slack(limits.polytope_slack), 1.0).times(np.ones((len(T), 1)))
    rows = tuple(Row("limit", layout.horizon, f"row {i} of the terminal polytope") for i in range(len(T)))
    yield Block(value, np.full(len(T), -inf), T, rows)
