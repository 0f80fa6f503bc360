"""Manners on a terminal: progress, Ctrl-C, colours; and silence where there is none."""

import argparse
import csv
import signal
import sys

import pytest

from hysdel_py.cli.colour import painted
from hysdel_py.cli.interrupt import first_interrupt
from hysdel_py.cli.main import _guarded
from hysdel_py.cli.progress import bar, is_terminal, progress_line, spoken, this_python
from hysdel_py.compiled.listening import compiling

pytest.importorskip("pty", reason="there are no pseudo-terminals on this system")
from cli.conftest import TANK
from cli.terminal import watched

LONG = ("simulate", "tank.hys", "--x0", "1,0", "--input", "0,1", "--steps", "2000000")


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "tank.hys").write_text(TANK, encoding="utf-8")
    (tmp_path / "wrong.hys").write_text(TANK.replace("gain*flow", "gian*flow"), encoding="utf-8")
    return tmp_path


def test_progress_is_drawn_and_taken_away(folder):
    seen = watched(*LONG[:-1], "300", "--csv", "run.csv", folder=folder)
    assert seen.status == 0
    assert "[########################] step 300 of at most 300" in seen.terminal
    assert seen.terminal.endswith("\r\x1b[K")
    assert "\x1b" not in seen.out


def test_ctrl_c_leaves_what_was_computed(folder):
    seen = watched(*LONG, "--csv", "run.csv", folder=folder, interrupt_at="] step")
    assert seen.status == 1
    with (folder / "run.csv").open() as file:
        steps = len(list(csv.reader(file))) - 1
    assert 0 < steps < 2_000_000
    assert f"step {steps}: interrupted" in seen.out
    assert "Traceback" not in seen.terminal


def test_ctrl_c_in_a_loop_leaves_its_steps(folder):
    arguments = (
        "mpc",
        "tank.hys",
        "--x0",
        "1,0",
        "--weight",
        "y=1",
        "--ref",
        "y=3",
        "--horizon",
        "2",
        "--steps",
        "100000",
    )
    seen = watched(*arguments, "--csv", "run.csv", folder=folder, interrupt_at="] step")
    assert seen.status == 1
    assert "interrupted" in seen.out
    assert "the loop ended after" in seen.terminal
    assert len((folder / "run.csv").read_text().splitlines()) > 1


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (("verify", "bist_part2"), 4, "not settled"),
        (("explain-infeasible", "bist_part2", "--x0", "0,0,0,0,0,0,0", "--horizon", "30"), 4, "not settled"),
        (("check", "bist_part2", "--deep"), 0, "not settled"),
    ],
)
def test_an_interrupt_leaves_what_is_settled(folder, arguments, status, words):
    seen = watched(*arguments, folder=folder, interrupt_at="search ")
    assert "interrupted: what was not settled by then is left open" in seen.terminal
    assert words in seen.out
    assert seen.status == status


def test_no_terminal_no_progress(hysdel):
    shown = hysdel(*LONG[:-1], "50", "--json")
    assert shown.err == ""
    assert len(shown.json["t"]) == 51


def test_json_has_no_progress_on_a_terminal_either(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    assert progress_line(True) is not None
    assert progress_line(False) is None


def test_diagnostics_are_coloured(folder):
    seen = watched("check", "wrong.hys", folder=folder)
    assert seen.status == 1
    assert "\x1b[31;1merror[HYS201]\x1b[0m" in seen.terminal
    assert "\x1b[31;1m^^^^\x1b[0m" in seen.terminal
    assert "\x1b[36mhelp:\x1b[0m did you mean gain?" in seen.terminal


def test_no_colour_where_none_is_wanted(folder):
    seen = watched("compile", "wrong.hys", folder=folder, environment={"NO_COLOR": "1"})
    assert "error[HYS201]: gian is not declared" in seen.terminal
    assert "\x1b" not in seen.terminal


@pytest.mark.parametrize(("variable", "value"), [("NO_COLOR", "1"), ("TERM", "dumb")])
def test_variables_that_mean_plain_text(monkeypatch, variable, value):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    assert painted("error: a", Terminal()) != "error: a"
    monkeypatch.setenv(variable, value)
    assert painted("error: a", Terminal()) == "error: a"


class Terminal:
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


def test_a_dumb_terminal_gets_no_bar(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    assert is_terminal()
    monkeypatch.setenv("TERM", "dumb")
    assert not is_terminal()


@pytest.mark.parametrize("is_watched", [True, False])
def test_who_waits_for_the_compiler_is_told_once(monkeypatch, capsys, is_watched):
    def run(options):
        compiling()
        compiling()
        return 0

    monkeypatch.setattr("hysdel_py.cli.progress.is_terminal", lambda: is_watched)
    assert _guarded(argparse.Namespace(run=run)) == 0
    assert capsys.readouterr().err.count("compiling the solvers") == is_watched


@pytest.mark.parametrize(("seconds", "numba", "said"), [(20.0, None, True), (20.0, "there", False), (0.5, None, False)])
def test_who_waited_for_plain_python_is_told_of_the_compiler(monkeypatch, capsys, seconds, numba, said):
    monkeypatch.setattr("hysdel_py.cli.progress.find_spec", lambda name: numba)
    monkeypatch.setattr("hysdel_py.cli.progress.is_terminal", lambda: True)
    clock = iter([100.0, 100.0 + seconds])
    monkeypatch.setattr("hysdel_py.cli.main.perf_counter", lambda: next(clock))
    assert _guarded(argparse.Namespace(run=lambda options: 0, compiles=True)) == 0
    assert (f"the extra `fast` ({sys.executable} -m pip install numba)" in capsys.readouterr().err) is said


@pytest.mark.parametrize(
    ("path", "shown"), [("/v/bin/python", "/v/bin/python"), ("/my v/python", '"/my v/python"'), ("", "python")]
)
def test_advice_names_the_python_that_runs(monkeypatch, path, shown):
    monkeypatch.setattr(sys, "executable", path)
    assert this_python() == shown


def test_the_first_interrupt_is_noted_and_the_second_obeyed():
    with first_interrupt() as interruption:
        assert not interruption.asked
        signal.raise_signal(signal.SIGINT)
        assert interruption.asked
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is not interruption.note


def test_source_lines_keep_their_colour(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    text = "warning[HYS541]: a\n --> f:1:2\n  |\n1 | error: help: ^^^ ---\n  |  ----\n  fix: b\n"
    lines = painted(text, Terminal()).splitlines()
    assert lines[3] == "1 | error: help: ^^^ ---"
    assert "\x1b[33;1mwarning" in lines[0]
    assert lines[4].endswith("----\x1b[0m")
    assert "fix:\x1b[0m b" in lines[5]


@pytest.mark.parametrize(
    ("done", "total", "filled"), [(0, 10, 0), (5, 10, 12), (10, 10, 24), (30, 10, 24), (0, 0, 24), (-1, 4, 0)]
)
def test_bar(done, total, filled):
    assert bar(done, total) == f"[{'#' * filled}{' ' * (24 - filled)}]"


def test_spoken_times():
    assert [spoken(s) for s in (0.4, 119, 150, 7300, 1e4)] == ["0 s", "119 s", "2 min", "2 h", "3 h"]
