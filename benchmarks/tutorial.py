"""How long the tutorial takes on a fresh machine: a new environment, the plain installation, each step of the page.

    python benchmarks/tutorial.py                               as on the page
    python benchmarks/tutorial.py --demos 1                     the first command of README.md, then the page
    python benchmarks/tutorial.py --demos 2 --extra plot,fast   the same with kernels that are compiled on the way

Wall seconds include what other programs of the machine take; seconds of CPU are those of the commands alone. `ours` is
all but making the environment and installing. Pip's downloads count in the wall time.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from time import perf_counter

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from pages import blocks  # noqa: E402

PAGE = ROOT / "docs" / "tutorial.md"
DEMO = "hysdel demo clutch"


@dataclass(frozen=True)
class Step:
    name: str
    wall: float
    cpu: float


def timed(name: str, command: list[str], folder: Path) -> Step:
    before, started = getrusage(RUSAGE_CHILDREN), perf_counter()
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    after = getrusage(RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):  # 1: a question that is answered with no
        raise SystemExit(f"{name} failed:\n{done.stdout}{done.stderr}")
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    step = Step(name, perf_counter() - started, cpu)
    print(f"{step.wall:8.1f} {step.cpu:8.1f}  {name[:90]}", flush=True)
    return step


def installation(folder: Path, extra: str) -> list[Step]:
    python = str(folder / "venv" / "bin" / "python")
    target = f"{ROOT}[{extra}]"
    return [
        timed("python3 -m venv", [sys.executable, "-m", "venv", "venv"], folder),
        timed(f"pip install .[{extra}]", [python, "-m", "pip", "install", "-q", target], folder),
    ]


def page(folder: Path) -> list[Step]:
    """The commands of the page one by one, and its Python blocks as one program at the end."""
    steps, program = [], []
    for block in blocks(PAGE.read_text(encoding="utf-8")):
        if block.title:
            (folder / block.title).write_text(block.body, encoding="utf-8")
        elif block.language == "python":
            program.append(block.body)
        elif block.language == "console":
            steps += [timed(command, ["bash", "-c", command], folder) for command in commands(block.body)]
    (folder / "tutorial.py").write_text("\n".join(program), encoding="utf-8")
    return [*steps, timed("all Python blocks", [str(folder / "venv" / "bin" / "python"), "tutorial.py"], folder)]


def commands(body: str) -> list[str]:
    joined = body.replace("\\\n", " ")
    return [line.removeprefix("$ ") for line in joined.splitlines() if line.startswith("$ ")]


def summary(title: str, steps: list[Step]) -> None:
    print(f"{sum(s.wall for s in steps):8.1f} {sum(s.cpu for s in steps):8.1f}  = {title}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--extra", default="plot", help="extras that are installed (default: plot)")
    parser.add_argument("--demos", type=int, default=0, help="so many times `hysdel demo clutch` before the page")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        os.environ |= {"PATH": f"{folder}/venv/bin:{os.environ['PATH']}", "MPLBACKEND": "agg"}
        os.environ.pop("PYTHONPATH", None)
        print("  wall s    cpu s  step")
        installed = installation(folder, options.extra)
        demos = [timed(DEMO, DEMO.split(), folder) for _ in range(options.demos)]
        ours = [*demos, *page(folder)]
        summary("installation", installed)
        summary("ours", ours)
        summary("all", installed + ours)


if __name__ == "__main__":
    main()
