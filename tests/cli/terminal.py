"""Running the command on a pseudo-terminal, as somebody who watches it would."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
SECONDS = 300
START = """import runpy, signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in what a shell runs in the background
runpy.run_module("hysdel_py", run_name="__main__", alter_sys=True)"""


@dataclass(frozen=True)
class Seen:
    """What stood on the standard output, and what the terminal got from the error stream."""

    status: int
    out: str
    terminal: str


def watched(*arguments, folder, interrupt_at="", environment=None):
    """Run the command with its error stream on a terminal; Ctrl-C once a text is seen there."""
    ours, theirs = os.openpty()
    variables = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "TERM")}
    variables |= {"PYTHONPATH": str(ROOT), "TERM": "xterm", "COLUMNS": "100"} | (environment or {})
    with (folder / "out.txt").open("w") as out:
        process = subprocess.Popen(
            [sys.executable, "-c", START, *map(str, arguments)], cwd=folder, stdout=out, stderr=theirs,
            stdin=subprocess.DEVNULL, env=variables, start_new_session=True,
        )  # fmt: skip
        os.close(theirs)
        terminal = _read(process, ours, interrupt_at)
        status = process.wait(SECONDS)
    os.close(ours)
    return Seen(status, (folder / "out.txt").read_text(), terminal)


def _read(process, ours, interrupt_at):
    seen, end = "", time.monotonic() + SECONDS
    while time.monotonic() < end:
        if select.select([ours], [], [], 0.05)[0]:
            try:
                piece = os.read(ours, 65536)
            except OSError:  # the other end is closed
                return seen
            if not piece:
                return seen
            seen += piece.decode()
        if interrupt_at and interrupt_at in seen:
            process.send_signal(signal.SIGINT)
            interrupt_at = ""
    process.kill()
    raise AssertionError(f"the command did not end: {seen}")
