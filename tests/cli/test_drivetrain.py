"""``hysdel drivetrain``."""

import json

import pytest

from hysdel_py.cli import drivetrain
from hysdel_py.cli import main as command
from hysdel_py.drivetrain import comparison


@pytest.fixture
def few_methods(monkeypatch):
    """Three methods instead of all, so that the test is fast."""
    names = ("SWITCH", "LCPTS", "AUGLAGR p=1 tol=1e-4")
    monkeypatch.setattr(comparison, "FIXED", {name: comparison.FIXED[name] for name in names})
    monkeypatch.setattr(comparison, "_SAMPLE", 5e-3)
    monkeypatch.setattr(comparison, "VARIABLE", {})
    monkeypatch.setattr(comparison, "LONGEST_STEP_ONLY", {})
    pairs = [pair for pair in comparison.PAIRS if set(pair[:2]) <= set(names)]
    monkeypatch.setattr(comparison, "PAIRS", tuple(pairs))


@pytest.mark.usefixtures("few_methods")
def test_compare_prints_tables(capsys, tmp_path):
    picture = tmp_path / "precision.png"
    assert command.main(["drivetrain", "compare", "--quick", "--case", "b", "--plot", str(picture)]) == 0
    out = capsys.readouterr().out
    assert "Dual-clutch, case b" in out
    assert "LCPTS and AUGLAGR p=1 tol=1e-4" in out
    assert picture.stat().st_size > 1000


@pytest.mark.usefixtures("few_methods")
def test_compare_as_json(capsys):
    assert command.main(["drivetrain", "compare", "--quick", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    rows = {row["method"]: row for row in found["rows"]}
    assert rows["SWITCH"]["ratio"] == 1.0
    assert rows["LCPTS"]["error"] < 0.1 < rows["SWITCH"]["error"]
    assert [pair["printed"] for pair in found["pairs"]] == ["1e-3", "1e-1", "1e-1"]


def test_what_a_run_says_stands_behind_its_line(capsys, monkeypatch):
    said = "the torques of c1, c2 are not unique in 3 of 9 samples"
    row = comparison.Row("SWITCH", 1e-3, 0.1, 0.2, 1.0, 4, 0.5, (said,))
    monkeypatch.setattr(drivetrain, "compare", lambda *_, **__: comparison.Comparison("a", (row,), (), {}))
    assert command.main(["drivetrain", "compare"]) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("SWITCH")]
    assert line.endswith(f"({said})")
