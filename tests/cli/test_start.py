"""A command loads what it needs: told by the modules that are there when it ends."""

import subprocess
import sys

import pytest

import hysdel_py
from hysdel_py.cli.commands import COMMANDS
from hysdel_py.compiled import kernels_are_compiled

ARRAYS = {"numpy", "scipy"}
SOLVERS = {"numba", "llvmlite", "osqp", "piqp", "networkx", "matplotlib", "scipy.optimize", "scipy.signal"}
LANGUAGE = {"lark", "hysdel_py.model", "hysdel_py.compiler"}


TELL = """
import sys
from hysdel_py.cli.main import main
try:
    main(sys.argv[1:])
finally:
    print(*sys.modules, file=sys.stderr)
"""


def loaded(*arguments):
    """Modules that are there after a command in a process of its own."""
    run = subprocess.run([sys.executable, "-c", TELL, *arguments], capture_output=True, text=True, check=True)
    return set(run.stderr.split())


def commands_of(modules):
    return {name for name in COMMANDS if f"hysdel_py.cli.{name.replace('-', '_')}" in modules}


@pytest.mark.parametrize("arguments", [("--version",), ("--help",)])
def test_version_and_help_load_no_package_and_no_command(arguments):
    modules = loaded(*arguments)
    assert "hysdel_py.cli.main" in modules
    assert not modules & (ARRAYS | SOLVERS | LANGUAGE)
    assert not commands_of(modules)


def test_all_versions_are_told_without_loading_the_packages():
    assert not loaded("--version", "--verbose") & (ARRAYS | SOLVERS | LANGUAGE)


@pytest.mark.skipif(not kernels_are_compiled(), reason="solvers answer in place of plain loops")
@pytest.mark.parametrize(
    "arguments",
    [
        ("check", "clutch"),
        ("compile", "two_tanks"),
        ("compile", "two_tanks", "--form", "pwa"),
        ("show", "two_tanks", "--form", "dha"),
        ("simulate", "two_tanks", "--x0", "0.1,0.2", "--input", "1e-4,1"),
    ],
)
def test_a_small_model_needs_no_solver_and_no_compiler(arguments):
    modules = loaded(*arguments)
    assert "hysdel_py.model" in modules
    assert not modules & SOLVERS
    assert commands_of(modules) == {arguments[0]}


def test_the_table_has_the_lines_of_the_help(hysdel):
    shown = " ".join(hysdel("--help").out.split())
    assert all(f"{name} {line}" in shown for name, line in COMMANDS.items())


def test_a_command_that_is_unknown_is_told_with_those_that_are_there(hysdel):
    run = hysdel("chekc")
    assert run.status == 2
    assert all(name in run.err for name in COMMANDS)


def test_a_file_may_be_called_as_a_command(hysdel, tmp_path):
    (tmp_path / "report").write_text((tmp_path / "tank.hys").read_text(encoding="utf-8"), encoding="utf-8")
    assert "no mistakes found" in hysdel("check", "report").out


def test_the_versions_are_those_of_the_package(hysdel):
    assert hysdel("--version").out == f"hysdel_py {hysdel_py.__version__}\n"
