"""``hysdel demo``: the figures, the files, the exit status."""

import csv
import sys
from dataclasses import replace

import pytest

from hysdel_py.cli import demo
from hysdel_py.demos.clutch import STEPS, engage


@pytest.fixture(scope="module")
def engagement():
    """One run with a short horizon, shared: what is tested here is what is made of it."""
    return engage(horizon=3, node_limit=10)


@pytest.fixture
def quick(monkeypatch, engagement):
    asked = {}

    def run(**options):
        asked.update(options)
        return engagement

    monkeypatch.setattr(demo, "engage", run)
    return asked


def test_figures_and_files(hysdel, quick, tmp_path, engagement):
    shown = hysdel("demo", "clutch", "--horizon", "3", "--output", "results/here")
    assert (shown.status, shown.err) == (0, "")
    assert quick["horizon"] == 3
    assert f"clutch locked after                          {engagement.lockup_time:.3f} s" in shown.out
    assert shown.out.endswith("wrote results/here/clutch.csv\nwrote results/here/clutch.png\n")
    rows = list(csv.DictReader((tmp_path / "results/here/clutch.csv").open(encoding="utf-8")))
    assert len(rows) == STEPS
    assert float(rows[0]["we"]) == 100
    assert (tmp_path / "results/here/clutch.png").stat().st_size > 20_000


def test_json_writes_no_files(hysdel, quick, tmp_path):
    data = hysdel("demo", "clutch", "--json").json
    assert data["engaged"] is True
    assert data["steps"] == STEPS == len(data["trajectory"]["u"])
    assert None in data["trajectory"]["info"]["status"], "the lock-up law has no status, and JSON no NaN"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["tank.hys"]


def test_default_folder_horizon_and_solver(hysdel, quick, tmp_path):
    hysdel("demo", "clutch")
    assert (tmp_path / "hysdel-demo" / "clutch.csv").exists()
    assert (quick["horizon"], quick["backend"]) == (10, "auto")


def test_without_matplotlib_it_says_so_and_writes_the_table(hysdel, quick, tmp_path, monkeypatch):
    for name in [name for name in sys.modules if name.startswith("matplotlib")] or ["matplotlib"]:
        monkeypatch.setitem(sys.modules, name, None)
    shown = hysdel("demo", "clutch", "--output", "out")
    assert shown.status == 0
    assert "no picture: matplotlib is not installed (pip install matplotlib)" in shown.out
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["clutch.csv"]


def test_clutch_that_does_not_engage_is_exit_status_one(hysdel, quick, engagement, monkeypatch):
    open_still = replace(engagement, lockup_time=None, slip_after_lockup=None, lockup_acceleration=None)
    monkeypatch.setattr(demo, "engage", lambda **options: open_still)
    shown = hysdel("demo", "clutch")
    assert shown.status == 1
    assert "clutch locked after                          never" in shown.out
    assert hysdel("demo", "clutch", "--json").json["lockup_time"] is None


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (["brake"], 2, "invalid choice: 'brake'"),
        (["clutch", "--horizon", "0"], 2, "horizon is 0: a whole number of at least 1 was expected"),
        (["clutch", "--backend", "cplex"], 2, "there is no QP back end 'cplex'"),
        (["clutch", "--output", "tank.hys"], 1, "tank.hys: File exists"),
    ],
)
def test_wrong_usage(hysdel, arguments, status, words):
    shown = hysdel("demo", *arguments)
    assert shown.status == status
    assert words in shown.err
