"""``hysdel demo dp``: figures, files, options."""

import csv

from hysdel_py.cli import demo
from hysdel_py.demos.dynamic_programming import engage_by_dp


def test_figures_files_and_exit_status(hysdel, tmp_path):
    shown = hysdel("demo", "dp", "--grid", "5", "--output", "here")
    assert (shown.status, shown.err) == (0, "")
    assert "cost of the run under the table" in shown.out
    assert shown.out.endswith("wrote here/dp.csv\nwrote here/dp.png\n")
    rows = list(csv.DictReader((tmp_path / "here/dp.csv").open(encoding="utf-8")))
    assert len(rows) == 20
    assert float(rows[0]["we"]) == 120
    assert (tmp_path / "here/dp.png").stat().st_size > 20_000


def test_json(hysdel, monkeypatch, tmp_path):
    asked = {}

    def run(grid, **options):
        asked.update(options, grid=grid)
        return engage_by_dp(10.0, 20.0)

    monkeypatch.setattr(demo, "engage_by_dp", run)
    data = hysdel("demo", "dp", "--json", "--two-inputs", "--grid", "2").json
    assert (asked["grid"], asked["engine_torques"]) == (2.0, 8)
    assert data["engaged"] is True
    assert data["trajectory"]["u"]
    assert not (tmp_path / "hysdel-demo").exists()


def test_options_of_the_other_demo_are_refused(hysdel):
    shown = hysdel("demo", "dp", "--hard")
    assert shown.status == 2
    assert "--hard belongs to the demo clutch" in shown.err
    assert hysdel("demo", "clutch", "--two-inputs").status == 2
    assert hysdel("demo", "dp", "--grid", "3").status == 2
