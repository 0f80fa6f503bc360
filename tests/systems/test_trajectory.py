"""Trajectories: shapes, names, tables, and names that occur twice."""

import csv
import io
import json

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.systems.signals import Kind, Type, Variable


def real(name, kind):
    return Variable(name, Type.REAL, kind)


def make(steps=2, **changes):
    """A state and an output that are both called level, an input, a Boolean and an auxiliary called cost."""
    n = np.arange(steps, dtype=float)
    parts = {
        "t": 0.5 * np.arange(steps + 1.0),
        "x": np.arange(steps + 1.0)[:, None],
        "u": n[:, None] + 10,
        "y": n[:, None] + 20,
        "d": (n[:, None] % 2),
        "z": n[:, None] + 30,
        "variables": {
            "x": (real("level", Kind.STATE),),
            "u": (real("pump", Kind.INPUT),),
            "y": (real("level", Kind.OUTPUT),),
            "d": (Variable("full", Type.BOOL, Kind.BOOLEAN_AUX),),
            "z": (real("cost", Kind.REAL_AUX),),
        },
        "info": {"cost": n + 40, "nodes": n + 50},
    }
    return hys.Trajectory(**{**parts, **changes})


def test_sizes_modes_and_names():
    trajectory = make(3)
    assert trajectory.steps == 3
    assert trajectory.modes == ("0", "1", "0")
    assert trajectory.names == {"x": ("level",), "u": ("pump",), "y": ("level",), "d": ("full",), "z": ("cost",)}


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("level", [0, 1, 2]),
        ("x.level", [0, 1, 2]),
        ("y.level", [20, 21]),
        ("pump", [10, 11]),
        ("full", [0, 1]),
        ("cost", [30, 31]),
        ("info.cost", [40, 41]),
        ("nodes", [50, 51]),
    ],
)
def test_signals_by_name(name, values):
    assert make()[name].tolist() == values


@pytest.mark.parametrize("name", ["speed", "u.level", "level.x", "q.level", "", "x."])
def test_unknown_signal_lists_the_known_ones(name):
    with pytest.raises(hys.ArgumentError, match=r"no signal .*: it has level, pump, level, full, cost, cost, nodes"):
        make()[name]


def test_no_column_of_the_table_hides_another():
    columns = make().columns()
    assert list(columns) == ["t", "x.level", "pump", "y.level", "full", "cost", "info.cost", "nodes"]
    assert columns["cost"].tolist() == [30, 31]
    assert columns["info.cost"].tolist() == [40, 41]
    assert {len(values) for values in columns.values()} == {2}


def test_every_column_but_the_time_is_a_signal_of_that_name():
    trajectory = make()
    for name, values in trajectory.columns().items():
        if name != "t":
            assert trajectory[name][:2].tolist() == values.tolist()


def test_a_signal_called_t_does_not_hide_the_time():
    trajectory = make(variables=make().variables | {"u": (real("t", Kind.INPUT),)})
    assert trajectory.columns()["t"].tolist() == [0, 0.5]
    assert trajectory.columns()["u.t"].tolist() == [10, 11]


def test_csv_can_be_read_back():
    rows = list(csv.DictReader(io.StringIO(make().to_csv())))
    assert [float(row["y.level"]) for row in rows] == [20, 21]
    assert [float(row["t"]) for row in rows] == [0, 0.5]


def test_csv_keeps_twelve_digits():
    third = make(u=np.full((2, 1), 1 / 3))
    assert float(third.to_csv().splitlines()[1].split(",")[2]) == pytest.approx(1 / 3, rel=1e-11)


def test_plain_data_is_json():
    data = json.loads(json.dumps(make().to_dict()))
    assert data["x"] == [[0], [1], [2]]
    assert data["info"]["nodes"] == [50, 51]
    assert data["names"]["d"] == ["full"]


def test_no_steps():
    trajectory = make(0)
    assert trajectory.steps == 0
    assert trajectory.modes == ()
    assert trajectory.to_csv() == "t,x.level,pump,y.level,full,cost,info.cost,nodes\n"
    assert trajectory["level"].tolist() == [0]


def test_pandas_table():
    pd = pytest.importorskip("pandas")
    table = make().to_pandas()
    assert isinstance(table, pd.DataFrame)
    assert table.index.tolist() == [0, 0.5]
    assert table["y.level"].tolist() == [20, 21]
