"""docs/cli.md shows what the commands print.

Each ``$ hysdel ...`` line of a console block is run, in one empty folder for the whole page, and compared with the
lines below it: words must be the same, numbers nearly so. ``$ cat FILE`` makes that file from the lines below it, and
``$ echo $?`` is the exit status of the command before. Figures of the search and the clock may differ. Where the page
is behind, ``python tests/cli/write_document.py`` writes it anew.
"""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from pages import same, steady

from hysdel_py.cli.main import build_parser

PAGE = Path(__file__).parents[2] / "docs" / "cli.md"
BLOCK = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass
class Shell:
    """The little that the page needs of a shell."""

    hysdel: object
    folder: Path
    status: int = 0

    def run(self, command, shown):
        words = shlex.split(command)
        match words:
            case ["cat", name]:
                (self.folder / name).write_text("\n".join(shown) + "\n", encoding="utf-8")
                return shown
            case ["echo", "$?"]:
                return [str(self.status)]
            case ["hysdel", *arguments]:
                outcome = self.hysdel(*arguments)
                self.status = outcome.status
                return (outcome.out + outcome.err).splitlines()
        raise AssertionError(f"the page shows a command that no test can run: {command}")


def sessions(text):
    """(command, lines below it) of each block, in order."""
    found = []
    for block in BLOCK.findall(text):
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            command, _, shown = re.sub(r"\\\n\s*", "", part).partition("\n")
            found.append((command, shown.splitlines()))
    return found


def test_page_shows_what_the_commands_print(hysdel, tmp_path):
    (tmp_path / "tank.hys").unlink()
    shell = Shell(hysdel, tmp_path)
    for command, shown in sessions(PAGE.read_text(encoding="utf-8")):
        found = shell.run(command, shown)
        expected, actual = steady(shown), steady(found)
        message = f"$ {command}\n" + "\n".join(found)
        assert [len(line) for line in expected] == [len(line) for line in actual], message
        for left, right in zip(expected, actual, strict=True):
            assert all(same(a, b) for a, b in zip(left, right, strict=True)), message


def test_page_speaks_of_every_command_and_every_option():
    text = PAGE.read_text(encoding="utf-8")
    commands = next(action for action in build_parser()._actions if action.dest == "command").choices
    for name, parser in commands.items():
        section = re.search(rf"^## `hysdel {name}`$(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
        assert section, f"no section on {name}"
        options = [
            o for action in parser._actions for o in action.option_strings if o.startswith("--") and o != "--help"
        ]
        assert [option for option in options if option not in section[1] and option not in shared(text)] == []


def shared(text):
    """The section on what all commands share."""
    return re.search(r"^## What all commands share$(.*?)(?=^## )", text, re.MULTILINE | re.DOTALL)[1]


def test_blocks_are_found_and_compared():
    page = "```console\n$ hysdel a \\\n    b\n t  x  seconds\n0  1  9\n$ cat f\n1\n```\n"
    assert sessions(page) == [("hysdel a b", [" t  x  seconds", "0  1  9"]), ("cat f", ["1"])]
    assert steady([" t  x  seconds", "0  1  9", "a b c"]) == [["t", "x"], ["0", "1"], ["a", "b", "c"]]
    assert same("1.0", "1.001")
    assert not same("1.0", "1.1")
    assert not same("a", "b")
