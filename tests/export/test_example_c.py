"""The example of a closed loop in C."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from export.compiled_c import build, needs_gcc, replay

EXAMPLE = Path(__file__).parents[2] / "examples" / "closed_loop_c"


@needs_gcc
def test_plant_and_law_run_together(tmp_path):
    subprocess.run([sys.executable, str(EXAMPLE / "generate.py"), str(tmp_path)], check=True, cwd=EXAMPLE.parents[1])
    sources = [EXAMPLE / "loop.c", tmp_path / "plant.c", tmp_path / "law.c"]
    program = build(*sources, output=tmp_path / "loop", options=("-O1", f"-I{tmp_path}"))
    lines = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout.splitlines()
    assert len(lines) == 30
    assert lines[0].split()[2] == "-5.0000"
    assert abs(float(lines[-1].split()[2])) < 1e-3
    for part in ("plant", "law"):
        assert replay(tmp_path / f"{part}.c", part).returncode == 0
