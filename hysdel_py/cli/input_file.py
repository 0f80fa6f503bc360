"""Inputs of a simulation from a CSV file."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hysdel_py.cli.arguments import number
from hysdel_py.cli.data_error import DataError
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Variable, as_vector

__all__ = ["read_inputs"]

Line = tuple[int, list[str]]


def read_inputs(path: Path, variables: Sequence[Variable]) -> NDArray[np.float64]:
    """Inputs of a CSV file, one row per step, in the order of the model.

    A first line of names gives the order of the columns, and there may be columns that are no inputs, so that the table
    of an earlier run can be read. Without names the columns are the inputs in the order of the model.

    Returns
    -------
    array of shape (N, nu)

    Raises
    ------
    DataError
        With the file, the line and the column.
    """
    lines = list(_lines(path))
    if not lines:
        raise DataError(f"{path} is empty: one line of inputs per step was expected")
    columns = [v.name for v in variables]
    if any(not _is_number(cell) for cell in lines[0][1]):
        columns = [cell.strip() for cell in lines.pop(0)[1]]
    order = _order(path, columns, variables)
    rows = [_row(path, line, columns, order, variables) for line in lines]
    return np.array(rows, dtype=float).reshape(len(rows), len(variables))


def _lines(path: Path) -> Iterator[Line]:
    """Lines that are not empty, with their numbers; a byte order mark is skipped."""
    with path.open(newline="", encoding="utf-8-sig") as file:
        reader = csv.reader(file)
        try:
            for cells in reader:
                if any(cell.strip() for cell in cells):
                    yield reader.line_num, cells
        except (UnicodeDecodeError, csv.Error):
            raise DataError(f"{path} is not a CSV file: text in UTF-8 with commas was expected") from None


def _is_number(cell: str) -> bool:
    try:
        number(cell, "")
    except ArgumentError:
        return False
    return True


def _order(path: Path, columns: Sequence[str], variables: Sequence[Variable]) -> list[int]:
    missing = [v.name for v in variables if v.name not in columns]
    if missing:
        raise DataError(f"{path}: no column for the input {', '.join(missing)}; the columns are {', '.join(columns)}")
    twice = [v.name for v in variables if columns.count(v.name) > 1]
    if twice:
        raise DataError(f"{path}: there are several columns for the input {', '.join(twice)}")
    return [columns.index(v.name) for v in variables]


def _row(
    path: Path, line: Line, columns: Sequence[str], order: Sequence[int], variables: Sequence[Variable]
) -> NDArray[np.float64]:
    place, cells = f"{path}, line {line[0]}", line[1]
    if len(cells) != len(columns):
        raise DataError(f"{place} has {len(cells)} values: {len(columns)} were expected ({', '.join(columns)})")
    try:
        values = [number(cells[i], v.name) for i, v in zip(order, variables, strict=True)]
        return as_vector(values, variables, "input")
    except ArgumentError as error:
        raise DataError(f"{place}: {error}") from None
