"""Help, exit statuses, and how errors of every kind are told."""

import os
import re
import subprocess
import sys

import pytest

import hysdel_py
from hysdel_py.cli import check, main
from hysdel_py.cli.negative_values import join_negative_values
from hysdel_py.shipped import shipped_models

COMMANDS = ("check", "compile", "simulate", "mpc", "demo", "fmt", "stubs", "lsp")


def test_no_command_shows_the_help_and_says_what_was_expected(hysdel):
    shown = hysdel()
    assert shown.status == 2
    assert all(f"  {command}" in shown.err for command in COMMANDS)
    assert "a COMMAND was expected" in shown.err
    assert shown.out == ""


def test_the_package_runs_as_the_command():
    command = [sys.executable, "-m", "hysdel_py", "--version"]
    shown = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (shown.returncode, shown.stderr) == (0, "")
    assert hysdel_py.__version__ in shown.stdout
    wrong = subprocess.run([*command[:3], "nonsense"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 2


def test_help_of_everything(hysdel):
    shown = hysdel("--help")
    assert shown.status == 0
    assert "exit status: 0 fine, 1" in shown.out
    listed = " ".join(hysdel("check", "--help").out.split())
    assert all(name in listed for name in shipped_models())


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_a_command_has_examples_of_it(hysdel, command):
    shown = hysdel(command, "--help")
    assert shown.status == 0
    assert f"examples:\n  hysdel {command} " in shown.out


def test_help_names_the_shipped_models(hysdel):
    assert ", ".join(shipped_models()) in " ".join(hysdel("check", "--help").out.split())


def test_version(hysdel):
    shown = hysdel("--version")
    assert (shown.status, shown.out) == (0, f"hysdel_py {hysdel_py.__version__}\n")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["fly"], "invalid choice"),
        (["chek", "tank.hys"], "help: did you mean hysdel check?"),
        (["infeasible"], "help: did you mean hysdel explain-infeasible?"),
        (["check"], "FILE"),
        (["check", "tank.hys", "--fast"], "--fast"),
        (["simulate", "tank.hys", "--steps", "few"], "few"),
        (["simulate", "tank.hys", "--input", "1,0", "--inputs", "u.csv"], "not allowed with"),
        (["compile", "tank.hys", "--constants", "none"], "none"),
        (["mpc", "tank.hys", "--on-failure", "pray"], "pray"),
    ],
)
def test_wrong_usage_found_by_the_parser(hysdel, arguments, words):
    shown = hysdel(*arguments)
    assert shown.status == 2
    assert shown.err.startswith("usage: hysdel")
    assert words in shown.err


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (["gain"], "--param gain: NAME=VALUE was expected, as in --param gain=1"),
        (["gain=big"], "--param gain is 'big': a number was expected"),
        (["gain="], "--param gain is '': a number was expected"),
        (["=3"], "--param '=3': NAME=VALUE was expected"),
        (["gain=1", "gain=2"], "--param gain is given twice"),
        (["gain=1,,ts=2"], "--param '': NAME=VALUE was expected"),
    ],
)
def test_wrong_parameters(hysdel, values, words):
    shown = hysdel("check", "tank.hys", *(part for value in values for part in ("--param", value)))
    assert shown.status == 2
    assert words in shown.err
    assert "help: hysdel check --help" in shown.err


def test_unknown_parameter_is_a_diagnostic_with_the_known_ones(hysdel):
    shown = hysdel("check", "tank.hys", "--param", "gian=1")
    assert shown.status == 1
    assert "there is no parameter gian" in shown.err
    assert "gain, ts" in shown.err


def test_file_that_is_not_there(hysdel):
    shown = hysdel("check", "tnak.hys")
    assert shown.status == 1
    assert "cannot read tnak.hys: No such file or directory" in shown.err


def test_fault_of_the_program_is_told_as_one(hysdel, monkeypatch):
    def broken(options):
        raise ZeroDivisionError("a fault")

    monkeypatch.setattr(check, "load_model", broken)
    shown = hysdel("check", "tank.hys")
    assert shown.status == 3
    assert re.search(r"internal fault, ZeroDivisionError: a fault \(\S*test_main, line \d+\)", shown.err)
    assert "mistake of the program, not of the model" in shown.err


def test_interruption_before_a_command_runs(hysdel, monkeypatch):
    def interrupted(_name):
        raise KeyboardInterrupt

    monkeypatch.setattr("hysdel_py.cli.commands.import_module", interrupted)
    run = hysdel("check", "tank.hys")
    assert (run.status, run.err) == (1, "interrupted\n")


def test_interruption(hysdel, monkeypatch):
    def interrupted(options):
        raise KeyboardInterrupt

    monkeypatch.setattr(check, "load_model", interrupted)
    assert hysdel("check", "tank.hys").err == "interrupted\n"


def test_errors_as_json_too(hysdel):
    shown = hysdel("simulate", "tank.hys", "--json")
    assert shown.status == 2
    assert shown.json == {"error": "--x0 is missing: the state is level, was_open, as in --x0 level=0,was_open=0"}


@pytest.mark.parametrize(
    ("given", "joined"),
    [
        (["--x0", "-1,2"], ["--x0=-1,2"]),
        (["--input", "-.5"], ["--input=-.5"]),
        (["--ref", "-inf"], ["--ref=-inf"]),
        (["--x0=1", "-1"], ["--x0=1", "-1"]),
        (["--", "-1.hys"], ["--", "-1.hys"]),
        (["--x0", "a=-1", "-o", "out.json"], ["--x0", "a=-1", "-o", "out.json"]),
        (["-3"], ["-3"]),
    ],
)
def test_negative_values_are_joined_to_their_option(given, joined):
    assert join_negative_values(given) == joined


def run_python(*arguments, **options):
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, check=False, **options)


@pytest.mark.parametrize("module", ["hysdel_py", "hysdel_py.cli.main"])
def test_as_a_module(module):
    shown = run_python("-m", module, "check", "clutch")
    assert (shown.returncode, shown.stderr) == (0, "")
    assert shown.stdout.startswith("clutch.hys: no mistakes found; 5 states")


def test_exit_status_reaches_the_shell(tmp_path):
    assert run_python("-m", "hysdel_py", "check", "nothing.hys", cwd=tmp_path).returncode == 1
    assert run_python("-m", "hysdel_py", "mpc", "clutch", cwd=tmp_path).returncode == 2


@pytest.mark.parametrize("arguments", [["compile", "clutch"], ["--help"]])
def test_reader_that_goes_away_is_no_fault(arguments):
    reading, writing = os.pipe()
    os.close(reading)
    try:
        shown = subprocess.run(
            [sys.executable, "-m", "hysdel_py", *arguments],
            stdout=writing, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    finally:
        os.close(writing)
    assert (shown.returncode, shown.stderr) == (0, "")


def test_main_reads_the_command_line_when_given_nothing(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["hysdel", "check", "two_tanks"])
    assert main.main() == 0
    assert "two_tanks.hys: no mistakes found" in capsys.readouterr().out
