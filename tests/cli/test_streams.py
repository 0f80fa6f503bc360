"""Standard streams that are closed or full."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a shell and a device that is always full")
BUFFERED = {key: value for key, value in os.environ.items() if key != "PYTHONUNBUFFERED"}


def shell(line):
    command = line.replace("hysdel", f"{sys.executable} -m hysdel_py", 1)
    return subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False, env=BUFFERED)


@pytest.mark.parametrize("command", ["--version", "--help", "check two_tanks", "compile two_tanks"])
def test_a_closed_output_is_no_fault(command):
    run = shell(f"hysdel {command} >&-")
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.parametrize("command", ["--version", "--help", "check two_tanks", "check two_tanks --json"])
def test_a_full_output_is_told(command):
    run = shell(f"hysdel {command} >/dev/full")
    assert run.returncode == 1
    assert run.stderr.startswith("hysdel")
    assert run.stderr.endswith("No space left on device\n")
    assert run.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("command", "status"), [("nonsense", 2), ("check no_such_model", 1), ("check clutch -p a=1", 2)]
)
def test_messages_for_a_closed_error_stream_do_not_stand_on_the_output(command, status):
    run = shell(f"hysdel {command} 2>&-")
    assert (run.returncode, run.stdout) == (status, "")
