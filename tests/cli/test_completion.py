"""Completions work in their shells; the manual page is one; versions are all there."""

import os
import re
import shutil
import subprocess

import pytest

import hysdel_py
from hysdel_py.cli.command_tree import command_tree
from hysdel_py.cli.commands import COMMANDS
from hysdel_py.cli.completion_scripts import SHELLS
from hysdel_py.cli.main import build_parser
from hysdel_py.cli.manual import manual_page
from hysdel_py.shipped import shipped_models


@pytest.fixture(scope="module")
def tree():
    return command_tree(build_parser())


def needs(command, package=None):
    return pytest.mark.skipif(
        shutil.which(command) is None, reason=f"{command} is not installed (Debian: apt install {package or command})"
    )


def test_the_tree_has_every_command_and_option(tree):
    assert [c.name for c in tree[1]] == list(COMMANDS)
    simulate = next(c for c in tree[1] if c.name == "simulate")
    assert {"--x0", "--inputs", "--form", "-I"} <= set(simulate.flags)
    form = next(o for o in simulate.options if "--form" in o.flags)
    assert (form.metavar, form.choices) == ("dha|mld", ("dha", "mld"))
    assert "%" not in " ".join(o.help for c in tree[1] for o in c.options)


@pytest.fixture(scope="module")
def scripts(tree):
    return {shell: write(*tree, list(shipped_models())) for shell, write in SHELLS.items()}


@pytest.mark.parametrize("shell", list(SHELLS))
def test_scripts_name_every_command_flag_and_model(hysdel, tree, scripts, shell):
    script = hysdel("completion", shell).out
    assert script == scripts[shell]
    assert all(name in script for name in shipped_models())
    for command in tree[1]:
        assert command.name in script
        for flag in command.flags:
            assert (flag if shell != "fish" else flag.lstrip("-")) in script


def complete_in_bash(script, folder, *words):
    """What bash offers for the last word."""
    (folder / "tank.hys").touch()
    (folder / "script.bash").write_text(script, encoding="utf-8")
    listed = " ".join(f"'{word}'" for word in ("hysdel", *words))
    asked = f"COMP_WORDS=({listed}); COMP_CWORD={len(words)}; _hysdel"
    code = f"source script.bash; {asked}; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    done = subprocess.run(["bash", "-c", code], cwd=folder, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout.split()


@needs("bash")
@pytest.mark.parametrize(
    ("words", "found"),
    [
        (["sim"], {"simulate"}),
        (["--v"], {"--version", "--verbose"}),
        (["simulate", "--no"], {"--no-check"}),
        (["simulate", "tank.hys", "--form", ""], {"dha", "mld"}),
        (["simulate", "ta"], {"tank.hys"}),
        (["check", "two_"], {"two_rooms", "two_tanks"}),
        (["demo", "upshift-1"], {"upshift-12", "upshift-12-held"}),
        (["completion", ""], {"bash", "zsh", "fish"}),
        (["mpc", "--steps", ""], set()),
        (["compile", "--output", "ta"], {"tank.hys"}),
    ],
)
def test_bash_completes(scripts, tmp_path, words, found):
    assert set(complete_in_bash(scripts["bash"], tmp_path, *words)) == found


@needs("zsh")
def test_zsh_completes(scripts, tmp_path):
    pexpect = pytest.importorskip("pexpect", reason="pexpect is not installed: pip install pexpect")
    (tmp_path / "_hysdel").write_text(scripts["zsh"], encoding="utf-8")
    assert subprocess.run(["zsh", "-n", "_hysdel"], cwd=tmp_path, check=False).returncode == 0
    environment = os.environ | {"HOME": str(tmp_path), "TERM": "dumb", "PS1": "> "}
    shell = pexpect.spawn("zsh", ["-f", "-i"], cwd=str(tmp_path), env=environment, encoding="utf-8", timeout=20)
    shell.sendline("fpath=($PWD $fpath); autoload -Uz compinit; compinit -u -D; hysdel() { :; }; echo rea''dy")
    shell.expect("ready")
    for typed, expected in (
        ("hysdel simul\t", "simulate"),
        ("hysdel simulate --no\t", "--no-check"),
        ("hysdel check bist_part2\t", "bist_part2"),
    ):
        shell.send(typed)
        shell.expect_exact(expected)
        shell.sendline("")
    shell.close(force=True)


@needs("fish")
def test_fish_completes(scripts, tmp_path):
    (tmp_path / "hysdel.fish").write_text(scripts["fish"], encoding="utf-8")

    def offered(line):
        code = f"source hysdel.fish; complete -C '{line}'"
        environment = os.environ | {"HOME": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path)}
        done = subprocess.run(
            ["fish", "--no-config", "-c", code],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        assert done.stderr == ""
        return {text.split("\t")[0] for text in done.stdout.splitlines()}

    assert offered("hysdel simul") == {"simulate"}
    assert "--no-check" in offered("hysdel simulate --no")
    assert {"dha", "mld"} <= offered("hysdel simulate --form ")
    assert "two_tanks" in offered("hysdel check two_")


def test_manual_names_every_command_and_option(hysdel, tree):
    page = hysdel("manual").out
    assert page.startswith('.TH HYSDEL 1 "" "hysdel_py ')
    for command in tree[1]:
        assert f".SH HYSDEL {command.name.upper().replace('-', chr(92) + '-')}\n" in page
        for flag in command.flags:
            assert flag.replace("-", "\\-") in page
    assert not [line for line in page.splitlines() if re.match(r"\.(?!TH|SH|B |I |TP|PP|nf|fi|ad l)", line)]


@needs("groff")
def test_manual_is_set_without_a_warning(tree):
    done = subprocess.run(
        ["groff", "-man", "-Tutf8", "-ww", "-K", "utf8"], input=manual_page(*tree), capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    assert done.stderr == ""
    text = re.sub(r"\x1b\[[\d;]*m", "", done.stdout)
    assert "hysdel simulate two_tanks --x0 0.1,0.2 --input 1e-4,1 --steps 50" in text.replace("\u2010", "-").replace(
        "\u2212", "-"
    )


def test_versions_for_a_report(hysdel):
    lines = hysdel("--version", "--verbose").out.splitlines()
    assert lines[0] == f"hysdel_py {hysdel_py.__version__}"
    assert lines[1].startswith("Python 3.")
    assert any(re.fullmatch(r"numpy \d[\w.]*", line) for line in lines)
    assert lines[-1].startswith("tools: ")
