"""Write the outputs in docs/cli.md anew: ``python tests/cli/write_document.py``.

The commands of the page stay, what stands below them is replaced by what they print now. test_document.py compares.
"""

import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "cli.md"
BLOCK = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)
COMMAND = re.compile(r"^\$ ((?:.*\\\n)*.*\n)", re.MULTILINE)


def answer(command, below, folder, status):
    """Text below a command and the exit status after it."""
    words = shlex.split(command.replace("\\\n", ""))
    if words[0] == "cat":
        (folder / words[1]).write_text(below, encoding="utf-8")
        return below, 0
    if words[0] == "echo":
        return f"{status}\n", 0
    done = subprocess.run(
        [sys.executable, "-m", "hysdel_py", *words[1:]], cwd=folder, capture_output=True, text=True, check=False
    )
    return done.stdout + done.stderr, done.returncode


def written(text, folder):
    """The page with fresh outputs."""
    status = 0

    def block(match):
        nonlocal status
        _, *parts = COMMAND.split(match[1])
        lines = ["```console\n"]
        for command, below in zip(parts[::2], parts[1::2], strict=True):
            shown, status = answer(command, below, folder, status)
            lines += [f"$ {command}", shown]
        return "".join(lines) + "```"

    return BLOCK.sub(block, text)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        PAGE.write_text(written(PAGE.read_text(encoding="utf-8"), Path(name)), encoding="utf-8")
