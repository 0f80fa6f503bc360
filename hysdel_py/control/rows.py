"""Rows of the program: what the model and the limits demand at each stage, with their meaning."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.affine import Affine
from hysdel_py.control.bands import Band, ResolvedLimits
from hysdel_py.control.layout import Layout
from hysdel_py.control.shape import Shape
from hysdel_py.systems.origin import RowOrigin

__all__ = ["Block", "Row", "model_rows", "row_blocks"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Row:
    """Meaning of one row of the program.

    Attributes
    ----------
    kind : str
        ``"update"``, ``"model"`` (an inequality of the MLD form), ``"limit"``, ``"held"`` (an input that a block of
        equal inputs holds) or ``"cost"`` (a term of a cost with absolute values).
    stage : int
        Time to which the row belongs.
    text : str
        What it says, with the line of the source where there is one.
    origin : RowOrigin or None
    band : pair of str and int, or None
        Group and column of the signal that a limit limits.
    """

    kind: str
    stage: int
    text: str
    origin: RowOrigin | None = None
    band: tuple[str, int] | None = None

    @classmethod
    def of_band(cls, band: Band, time: int) -> Row:
        """The row of a limit at a time."""
        return cls("limit", time, f"{band.group} {band.name} in {band.text(time)}", band=(band.group, band.column))

    def __str__(self) -> str:
        return f"{self.kind}[{self.stage}] {self.text}"


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Rows ``low <= value <= high`` with their meaning, before they are put together."""

    value: Affine
    low: Matrix
    high: Matrix
    rows: tuple[Row, ...]


def row_blocks(layout: Layout, limits: ResolvedLimits, shape: Shape, unmovable: tuple[Band, ...]) -> Iterator[Block]:
    """Yield all rows, stage by stage; the limits in `unmovable` are left out at time 0."""
    for k in range(layout.horizon):
        yield _update(layout, k)
        yield model_rows(layout, k)
        if shape.is_held(k):
            yield _held(layout, k)
        for band in limits.bands:
            yield from _stage_rows(layout, band, limits, unmovable, k)
    for band in limits.bands:
        if band.group == "final" or (band.group == "terminal" and limits.slack_of(band) is not None):
            yield from _band_rows(layout, band, limits, layout.horizon)
    yield from _polytope_rows(layout, limits)


def _stage_rows(
    layout: Layout, band: Band, limits: ResolvedLimits, unmovable: tuple[Band, ...], k: int
) -> Iterator[Block]:
    """Rows of one limit that belong to a stage; what is a bound of a variable has none."""
    if band.group == "du" or (band.group == "y" and not (k == 0 and band in unmovable)):
        yield from _band_rows(layout, band, limits, k)
    elif band.group == "x" and limits.slack_of(band) is not None:
        yield from _band_rows(layout, band, limits, k + 1)


def _held(layout: Layout, k: int) -> Block:
    """Inputs that stay as they were at the stage before."""
    names = tuple(v.name for v in layout.mld.u)
    rows = tuple(Row("held", k, f"{name} as before, by the blocks of the plan") for name in names)
    return Block(layout.signal("du", k), np.zeros(len(names)), np.zeros(len(names)), rows)


def _update(layout: Layout, k: int) -> Block:
    mld = layout.mld
    value = layout.successor(k) - layout.signal("x", k + 1)
    rows = tuple(
        _row("update", k + 1, v.name, origin) for v, origin in zip(mld.x, _padded(mld.updates, mld.nx), strict=True)
    )
    return Block(value, np.zeros(mld.nx), np.zeros(mld.nx), rows)


def model_rows(layout: Layout, k: int) -> Block:
    """Inequalities of the MLD form at one stage."""
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


def _band_rows(layout: Layout, band: Band, limits: ResolvedLimits, time: int) -> Iterator[Block]:
    value, slack = _limited(layout, band, time), limits.slack_of(band)
    low, high = limits.ends(band, time)
    row = Row.of_band(band, time)
    if slack is None:
        if low > -inf or high < inf:
            yield Block(value, np.array([low]), np.array([high]), (row,))
        return
    eps = layout.single(layout.slack(slack), 1.0)
    if low > -inf:
        yield Block(value + eps, np.array([low]), np.array([inf]), (row,))
    if high < inf:
        yield Block(value - eps, np.array([-inf]), np.array([high]), (row,))


def _limited(layout: Layout, band: Band, time: int) -> Affine:
    """The signal of a limit."""
    if band.group == "final":
        return layout.final_output().entry(band.column)
    return layout.signal("x" if band.group == "terminal" else band.group, time).entry(band.column)


def _polytope_rows(layout: Layout, limits: ResolvedLimits) -> Iterator[Block]:
    if limits.polytope is None:
        return
    S, T = limits.polytope.S, limits.polytope.T
    value = layout.signal("x", layout.horizon).times(S)
    if limits.polytope_slack is not None:
        value = value - layout.single(layout.slack(limits.polytope_slack), 1.0).times(np.ones((len(T), 1)))
    rows = tuple(Row("limit", layout.horizon, f"row {i} of the terminal polytope") for i in range(len(T)))
    yield Block(value, np.full(len(T), -inf), T, rows)
