"""Trajectories as tables of pandas and xarray."""

import sys

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.errors import HysdelError


@pytest.fixture(scope="module")
def run():
    return hys.load("two_tanks").simulate([0.1, 0.2], [[1e-4, 1.0]] * 6)


def test_pandas(run):
    pytest.importorskip("pandas", reason="pandas is not installed: pip install pandas")
    table = run.to_pandas()
    assert table.index.name == "t"
    assert list(table.columns) == [name for name in run.columns() if name != "t"]
    assert table["h1"].tolist() == run["h1"][:-1].tolist()
    assert table.attrs["units"]["q_pipe"] == "m^3/s"
    assert "valve" not in table.attrs["units"]


def test_xarray(run):
    pytest.importorskip("xarray", reason="xarray is not installed: pip install xarray")
    data = run.to_xarray()
    assert data["h1"].dims == ("t",)
    assert data.sel(t=10.0)["h1"].item() == run["h1"][2]
    assert data["h1"].attrs == {"kind": "x", "units": "m", "description": "level of tank 1"}
    assert data["valve"].attrs["kind"] == "u"


def test_xarray_has_what_a_controller_recorded(run):
    pytest.importorskip("xarray", reason="xarray is not installed: pip install xarray")
    filled = hys.Trajectory(
        run.t, run.x, run.u, run.y, run.d, run.z, run.variables, ("a word",), {"cost": np.arange(6.0)}
    )
    data = filled.to_xarray()
    assert data["cost"].attrs == {"kind": "info"}
    assert data.attrs["messages"] == ["a word"]


@pytest.mark.parametrize("name", ["pandas", "xarray"])
def test_missing_packages_are_named(run, monkeypatch, name):
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(HysdelError, match=f"{name} is not installed: pip install {name}"):
        getattr(run, f"to_{name}")()
