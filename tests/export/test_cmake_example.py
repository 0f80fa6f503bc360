"""The example of a CMake project whose sources are written while it builds."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from export.compiled_c import needs_gcc

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "cmake"
needs_cmake = pytest.mark.skipif(shutil.which("cmake") is None, reason="cmake is not installed: pip install cmake")


@needs_gcc
@needs_cmake
def test_example_builds_and_reaches_its_level(tmp_path):
    environment = os.environ | {"PYTHONPATH": str(ROOT), "CC": "gcc"}
    folder = shutil.copytree(EXAMPLE, tmp_path / "example")
    for command in (
        ["cmake", "-S", ".", "-B", "build", f"-DPython3_EXECUTABLE={sys.executable}"],
        ["cmake", "--build", "build"],
        ["cmake", "--build", "build", "--target", "test"],
    ):
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    lines = subprocess.run([str(folder / "build" / "tanks")], capture_output=True, text=True, check=True).stdout
    assert abs(float(lines.splitlines()[-1].split()[4]) - 0.3) < 0.05
