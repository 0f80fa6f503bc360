"""Trajectories as tables of pandas and xarray, with the units that are known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hysdel_py.errors import HysdelError

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

    from hysdel_py.systems.trajectory import Trajectory

__all__ = ["to_pandas", "to_xarray"]


def to_pandas(run: Trajectory) -> DataFrame:
    """A table with one row per step; see :meth:`Trajectory.to_pandas`."""
    pandas = _package("pandas")
    table: DataFrame = pandas.DataFrame(run.columns()).set_index("t")
    table.attrs["units"] = {name: told["units"] for name, told in _told(run).items() if "units" in told}
    return table


def to_xarray(run: Trajectory) -> Dataset:
    """A data set over the time; see :meth:`Trajectory.to_xarray`."""
    xarray = _package("xarray")
    columns, told = run.columns(), _told(run)
    t = columns.pop("t")
    signals = {name: ("t", values, told[name]) for name, values in columns.items()}
    found: Dataset = xarray.Dataset(signals, coords={"t": t}, attrs={"messages": list(run.messages)})
    return found


def _package(name: str) -> Any:
    """A package that need not be installed.

    Raises
    ------
    HysdelError
        It is not.
    """
    from importlib import import_module

    try:
        return import_module(name)
    except ModuleNotFoundError:
        raise HysdelError(f"{name} is not installed: pip install {name}") from None


def _told(run: Trajectory) -> dict[str, dict[str, str]]:
    """What is known of each column but the time, in their order."""
    signals = [(key, v) for key, group in run.variables.items() for v in group]
    known = [
        {"kind": key} | {word: text for word, text in (("units", v.unit), ("description", v.description)) if text}
        for key, v in signals
    ]
    names = [name for name in run.columns() if name != "t"]
    return dict(zip(names, [*known, *({"kind": "info"} for _ in run.info)], strict=True))
