"""Run what a page of the documents shows, and compare what it prints.

A page is one session in one empty folder, from top to bottom:

* a block with ``title="NAME"`` is the file NAME;
* a ``python`` block is run; a ``text`` block right below it is what it prints;
* in a ``console`` block each ``$ ...`` line is a command of a shell, and what stands below it is what it prints.

A comment ``<!-- not run: WHY -->`` right above a block leaves it out. ``python tests/pages.py PAGE ...`` writes the
outputs of pages anew.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

FENCE = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```$', re.MULTILINE | re.DOTALL)
COMMAND = re.compile(r"^\$ ((?:.*\\\n)*.*\n)", re.MULTILINE)
NOT_RUN = re.compile(r"<!-- not run: [^>]* -->\n\Z")
UNSTEADY = ("bound", "gap", "nodes", "qps", "seconds")
UNSTEADY_LINES = ("search:", "solve time", "nodes and quadratic programs", "moves by the predictive controller")


@dataclass(frozen=True)
class Block:
    """A fenced block of a page; `start` is where its text begins."""

    language: str
    title: str
    body: str
    start: int
    line: int
    is_below_python: bool


@dataclass(frozen=True)
class Output:
    """What a page shows below a command or a program, from `start` to `end`, and what came out."""

    source: str
    shown: str
    found: str
    start: int
    end: int


@dataclass
class Session:
    """One folder, one Python and one shell for a whole page."""

    folder: Path
    namespace: dict[str, Any] = field(default_factory=lambda: {"__name__": "__docs__"})
    status: int = 0

    def python(self, block: Block, page: str) -> str:
        """What a block prints, which is run as if it began in its line of the page."""
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("\n" * (block.line - 1) + block.body, page, "exec"), self.namespace)
        return printed.getvalue()

    def shell(self, command: str) -> str:
        """What a command prints, both streams in turn."""
        command = re.sub(r"\\\n\s*", "", command).strip()
        if command == "echo $?":
            return f"{self.status}\n"
        done = subprocess.run(
            [*_program(command)], cwd=self.folder, capture_output=True, text=True, check=False, env=_environment()
        )
        self.status = done.returncode
        return done.stdout + done.stderr


def _program(command: str) -> list[str]:
    """Words of a command; the package and Python are those that run this."""
    words = shlex.split(command)
    match words:
        case ["hysdel", *rest]:
            return [sys.executable, "-m", "hysdel_py", *rest]
        case ["python", *rest]:
            return [sys.executable, *rest]
    return ["bash", "-c", command]


def _environment() -> dict[str, str]:
    root = str(Path(__file__).parents[1])
    return {**os.environ, "MPLBACKEND": "agg", "PYTHONPATH": os.pathsep.join([root, os.environ.get("PYTHONPATH", "")])}


def blocks(text: str) -> Iterator[Block]:
    """The blocks of a page that are run, in order."""
    below, end = "", 0
    for match in FENCE.finditer(text):
        language, title, body = match[1], match[2] or "", match[3]
        follows = below == "python" and not text[end : match.start()].strip()
        below, end = (language if not title else ""), match.end()
        if not NOT_RUN.search(text[: match.start()]):
            yield Block(language, title, body, match.start(3), text.count("\n", 0, match.start(3)) + 1, follows)


def outputs(text: str, session: Session, page: str = "page") -> Iterator[Output]:
    """Run a page; what it shows and what was printed."""
    printed, source = "", ""
    for block in blocks(text):
        if block.title:
            (session.folder / block.title).write_text(block.body, encoding="utf-8")
        elif block.language == "python":
            source, printed = block.body, session.python(block, page)
        elif block.language == "text" and block.is_below_python:
            yield Output(source, block.body, printed, block.start, block.start + len(block.body))
        elif block.language == "console":
            yield from _console(block, session)


def _console(block: Block, session: Session) -> Iterator[Output]:
    _, *parts = COMMAND.split(block.body)
    place = block.body.index("$ ")
    for command, shown in zip(parts[::2], parts[1::2], strict=True):
        start = block.start + place + 2 + len(command)
        yield Output(command, shown, session.shell(command), start, start + len(shown))
        place += 2 + len(command) + len(shown)


def written(text: str, folder: Path) -> str:
    """The page with fresh outputs."""
    fresh, done = [], 0
    for output in outputs(text, Session(folder)):
        fresh += [text[done : output.start], output.found]
        done = output.end
    return "".join([*fresh, text[done:]])


def steady(lines: list[str]) -> list[list[str]]:
    """Words of the lines without what changes from run to run."""
    kept, hidden = [], set()
    for line in lines:
        words = line.split()
        if words and words[0] == "t":
            hidden = {i for i, word in enumerate(words) if word in UNSTEADY}
        elif not words or not re.fullmatch(r"[\d.]+", words[0]):
            hidden = set()
        if not line.strip().startswith(UNSTEADY_LINES):
            kept.append([word for i, word in enumerate(words) if i not in hidden])
    return kept


def same(shown: str, found: str) -> bool:
    """Whether two words are equal, numbers nearly so."""
    try:
        left, right = float(shown.strip("[](),:")), float(found.strip("[](),:"))
    except ValueError:
        return shown == found
    return left == right or abs(left - right) <= max(1e-6, 0.02 * abs(right))


def alike(shown: str, found: str) -> bool:
    """Whether two outputs have the same words, and nearly the same numbers."""
    left, right = steady(shown.splitlines()), steady(found.splitlines())
    if [len(line) for line in left] != [len(line) for line in right]:
        return False
    return all(same(a, b) for one, other in zip(left, right, strict=True) for a, b in zip(one, other, strict=True))


def main(pages: list[str]) -> None:
    """Write the outputs of pages anew."""
    for page in map(Path, pages):
        path, before = page.resolve(), Path.cwd()
        with tempfile.TemporaryDirectory() as name:
            os.chdir(name)
            fresh = written(path.read_text(encoding="utf-8"), Path(name))
            os.chdir(before)
        path.write_text(fresh, encoding="utf-8")


if __name__ == "__main__":
    os.environ["MPLBACKEND"] = "agg"
    sys.path.insert(0, str(Path(__file__).parents[1]))
    main(sys.argv[1:])
