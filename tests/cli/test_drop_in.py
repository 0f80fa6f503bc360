"""The command line of the original compiler."""

import io
import subprocess
import sys

import pytest
from export.matlab_reader import read_matlab

LOOP = (
    "SYSTEM s { INTERFACE { STATE { BOOL b; } } IMPLEMENTATION { AUX { BOOL d, e; } "
    "LOGIC { d = e; e = d; } AUTOMATA { b = d; } } }"
)
OPEN = (
    "SYSTEM s { INTERFACE { STATE { REAL x [0, 1]; } PARAMETER { REAL a; } } "
    "IMPLEMENTATION { CONTINUOUS { x = a*x; } } }"
)


def test_writes_the_files_with_their_ends(hysdel, tmp_path):
    outcome = hysdel("-i", "tank.hys", "-m", "out", "-s", "sim", "-5")
    assert (outcome.status, outcome.out) == (0, "")
    assert read_matlab((tmp_path / "out.m").read_text())["name"] == "tank"
    assert (tmp_path / "sim.m").read_text().startswith("function [xn, d, z, y] = sim(x, u, params)\n")


def test_without_names_reads_and_writes_the_standard_streams(hysdel, tmp_path, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO((tmp_path / "tank.hys").read_text()))
    outcome = hysdel("-5", "ignored")
    assert outcome.status == 0
    assert read_matlab(outcome.out)["nx"] == 2
    assert "S.B5 = [" in outcome.out


def test_constants_need_a_switch(hysdel, tmp_path):
    path = tmp_path / "offset.hys"
    path.write_text(OPEN.replace("a*x", "0.5*x + 0.25").replace("PARAMETER { REAL a; }", ""))
    assert "HYS403" in hysdel("-i", path).err
    assert "S.B5" not in hysdel("-i", path, "-a").out
    assert read_matlab(hysdel("-i", path, "-a").out)["nz"] == 1
    assert read_matlab(hysdel("-i", path, "-5").out)["B5"] == 0.25
    assert read_matlab(hysdel("-i", path, "-a", "-5").out)["nz"] == 0


def test_failure_leaves_no_stale_file(hysdel, tmp_path):
    (tmp_path / "out.m").write_text("S.name = 'old';")
    (tmp_path / "sim.m").write_text("old")
    (tmp_path / "bad.hys").write_text("SYSTEM s {")
    outcome = hysdel("-i", "bad.hys", "-m", "out", "-s", "sim.m", "-5")
    assert outcome.status == 1
    assert "bad.hys" in outcome.err
    assert not list(tmp_path.glob("*.m"))


def test_refused_simulator_leaves_the_matrices(hysdel, tmp_path):
    (tmp_path / "loop.hys").write_text(LOOP)
    (tmp_path / "sim.m").write_text("old")
    outcome = hysdel("-i", "loop.hys", "-m", "out", "-s", "sim", "-v0")
    assert outcome.status == 1
    assert "HYS505" in outcome.err
    assert "d -> e -> d" in outcome.err or "e -> d -> e" in outcome.err
    assert read_matlab((tmp_path / "out.m").read_text())["nd"] == 2
    assert not (tmp_path / "sim.m").exists()


def test_switches_of_the_text(hysdel, tmp_path):
    (tmp_path / "open.hys").write_text(OPEN)
    full = hysdel("-i", "open.hys").out
    assert "if ~isfield(params, 'a')" in full
    assert read_matlab(full, {"a": 0.5})["A"] == 0.5
    bare = hysdel("-i", "open.hys", "--no-symbol-table", "--no-row-info", "--no-params-checks").out
    assert "isfield" not in bare
    assert "symtable{" not in bare
    assert "rowinfo." not in bare
    assert "params.gain" not in hysdel("-i", "tank.hys").out
    assert "params.gain" in hysdel("-i", "tank.hys", "-p").out
    assert "maple('min'" in hysdel("-i", "tank.hys", "-p", "--matlab-symbolic").out


@pytest.mark.parametrize(("switch", "count"), [((), 2), (("-v", "2"), 2), (("-v1",), 1), (("-v0",), 0)])
def test_verbosity(hysdel, tmp_path, switch, count):
    text = (
        "SYSTEM s { INTERFACE { STATE { REAL x [0, 1]; BOOL b; } } IMPLEMENTATION { AUX { BOOL d; } "
        "AD { d = x <= 0 [-9, 9, 1e-6]; } CONTINUOUS { x = 0.5*x + (REAL d); } } }"
    )
    (tmp_path / "warn.hys").write_text(text)
    outcome = hysdel("-i", "warn.hys", *switch)
    assert outcome.status == 0
    assert outcome.err.count("warning[") == count


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-i", "tank.hys", "-5", "-5"], "-5 is given twice"),
        (["-i"], "-i needs a value"),
        (["-i", "tank.hys", "--nonsense"], "unknown option --nonsense"),
        (["-i", "tank.hys", "-v", "7"], "-v 7"),
        (["-i", "tank.hys", "-m", "a", "-s", "a"], "both name a"),
        (["-i", "nothing.hys"], "nothing.hys"),
        (["-5", "-i", "tank.hys", "-m", "nowhere/out"], "No such file"),
    ],
)
def test_mistakes_end_with_one(hysdel, arguments, words):
    outcome = hysdel(*arguments)
    assert outcome.status == 1
    assert words in outcome.err


def test_own_commands_are_not_taken_for_the_original(hysdel):
    assert hysdel("--version").out.startswith("hysdel_py")
    assert hysdel("check", "tank.hys").status == 0


def test_standard_input_of_a_process(tmp_path):
    text = b"/* gr\xfc\xdfe */ " + OPEN.replace("REAL a;", "REAL a = 0.5;").encode()
    command = [sys.executable, "-m", "hysdel_py", "-5"]
    done = subprocess.run(command, input=text, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert read_matlab(done.stdout.decode())["A"] == 0.5
    empty = subprocess.run(command, input=b"", capture_output=True, check=False)
    assert empty.returncode == 0
    assert read_matlab(empty.stdout.decode())["nx"] == 0
