"""What compiled code prints is kept back, what Python prints is not."""

import subprocess
import sys
from pathlib import Path

CODE = """
import ctypes
from hysdel_py.analysis.quiet import quiet
print("before")
with quiet():
    ctypes.CDLL(None).printf(b"hidden\\n")
ctypes.CDLL(None).printf(b"shown\\n")
"""


def test_only_compiled_code_is_silenced():
    shown = subprocess.run(
        [sys.executable, "-c", CODE], capture_output=True, text=True, check=True, cwd=Path(__file__).parents[2]
    ).stdout
    assert sorted(shown.split()) == ["before", "shown"]
