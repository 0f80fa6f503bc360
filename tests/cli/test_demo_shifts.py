"""``hysdel demo`` with gear shifts: figures, files, JSON, who runs them, the exit status."""

import csv
from dataclasses import replace

import pytest

from hysdel_py.cli import demo_shifts
from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.drive import drive
from hysdel_py.demos.shifts.plant import FINE
from hysdel_py.demos.shifts.shift import run_shift


@pytest.fixture(scope="module")
def run():
    """One run by ramps, the cheapest, shared: what is tested here is what is made of it."""
    return run_shift(SHIFTS["upshift-23"], controller="ramps")


@pytest.fixture
def quick(monkeypatch, run):
    asked = {}

    def instead(shift, **options):
        asked.update(options, shift=shift.name)
        return replace(run, shift=shift, controller=options["controller"])

    monkeypatch.setattr(demo_shifts, "run_shift", instead)
    return asked


@pytest.mark.parametrize("name", list(SHIFTS))
def test_every_shift_prints_figures_and_writes_files(hysdel, quick, tmp_path, name):
    shown = hysdel("demo", name, "--output", "out")
    assert (shown.status, shown.err) == (0, "")
    assert quick["shift"] == name
    assert quick["controller"] == "hybrid"
    assert shown.out.splitlines()[0].lower() == SHIFTS[name].title
    assert "slope of the relative speed at lock-up" in shown.out
    assert shown.out.endswith(f"wrote out/{name}.csv\nwrote out/{name}.png\n")
    rows = list(csv.DictReader((tmp_path / f"out/{name}.csv").open(encoding="utf-8")))
    assert list(rows[0]) == ["t", *FINE]
    assert (tmp_path / f"out/{name}.png").stat().st_size > 20_000


def test_json_has_figures_and_samples(hysdel, quick, tmp_path):
    data = hysdel("demo", "upshift-23", "--controller", "ramps", "--json").json
    assert (data["shift"], data["controller"], data["done"]) == ("upshift-23", "ramps", True)
    assert data["columns"] == ["t", *FINE]
    assert len(data["rows"][0]) == len(data["columns"])
    assert data["rows"][1][0] == pytest.approx(0.0055)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["tank.hys"]


def test_files_tell_the_controller(hysdel, quick):
    assert "wrote hysdel-demo/upshift-23-ramps.csv" in hysdel("demo", "upshift-23", "--controller", "ramps").out


def test_a_clutch_that_stays_open_is_exit_status_one(hysdel, monkeypatch, run):
    still = replace(run, judgement=replace(run.judgement, done=False, shift_time=None, lockup_slope=None, jerk=None))
    monkeypatch.setattr(demo_shifts, "run_shift", lambda shift, **options: still)
    shown = hysdel("demo", "upshift-23")
    assert shown.status == 1
    assert "clutch of the new gear locked after          never s" not in shown.out
    assert "locked after          never" in shown.out


def test_drive(hysdel, monkeypatch):
    """Half a second with the clutch closed, for the table, the picture and the JSON."""
    short = drive([(0.0, 0.3), (0.5, 0.4)], 20.0)
    monkeypatch.setattr(demo_shifts, "drive", lambda **options: short)
    shown = hysdel("demo", "drive")
    assert shown.status == 0
    assert "speed of the wheels: first, greatest, last" in shown.out
    assert shown.out.endswith("wrote hysdel-demo/drive.csv\nwrote hysdel-demo/drive.png\n")
    data = hysdel("demo", "drive", "--json").json
    assert data["shifts"] == []
    assert data["seconds"] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["drive", "--controller", "ramps"], "--controller belongs to the shifts (upshift-23, "),
        (["upshift-23", "--controller", "pid"], "invalid choice: 'pid'"),
        (["upshift-23", "--grid", "2"], "--grid belongs to the demo dp, not to upshift-23"),
    ],
)
def test_wrong_usage(hysdel, arguments, words):
    shown = hysdel("demo", *arguments)
    assert shown.status == 2
    assert words in shown.err
