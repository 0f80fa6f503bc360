"""Compiling written C with the warnings that it must not raise."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

FLAGS = ("-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic")
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")


def build(*sources: Path, output: Path, options: tuple[str, ...] = ("-O1",)) -> Path:
    subprocess.run(["gcc", *FLAGS, *options, *map(str, sources), "-o", str(output)], check=True)
    return output


def replay(source: Path, prefix: str) -> subprocess.CompletedProcess[str]:
    """Run the self-test of a source."""
    program = build(source, output=source.with_suffix(".out"), options=("-O1", f"-D{prefix.upper()}_SELF_TEST"))
    return subprocess.run([str(program)], capture_output=True, text=True, check=False)


def shared(source: Path) -> Path:
    """A library that ctypes can load."""
    return build(source, output=source.with_suffix(".so"), options=("-O1", "-shared", "-fPIC"))
