"""How long the commands of the tutorial take where nothing has to be compiled any more, most of which is loading.

    python benchmarks/startup.py                        least seconds of CPU of three runs
    python benchmarks/startup.py --beside ../other      the same, with those of another checkout and the ratios

The commands run by turns, and each once before it is timed, so that byte code, kernels and the tables of the parser are
on disk. Each runs in a process of its own, with one thread for linear algebra.
"""

from __future__ import annotations

import argparse
import os
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage

from tutorial import PAGE, ROOT, commands

sys.path.insert(0, str(ROOT / "tests"))

from pages import blocks

FIRST = ("hysdel --version", "hysdel --help", "hysdel completion bash", "hysdel check clutch")


def seconds(command: str, tree: Path, folder: Path) -> float:
    """Seconds of CPU of a command of a checkout."""
    environment = os.environ | {"PYTHONPATH": str(tree), "OPENBLAS_NUM_THREADS": "1"}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    before = getrusage(RUSAGE_CHILDREN)
    words = [sys.executable, "-m", "hysdel_py", *shlex.split(command)[1:]]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    after = getrusage(RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):  # 1: a question that is answered with no
        raise SystemExit(f"{command} failed:\n{done.stdout}{done.stderr}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def prepared(folder: Path) -> list[str]:
    """Commands, whose files are then in the folder."""
    found = list(FIRST)
    for block in blocks(PAGE.read_text(encoding="utf-8")):
        if block.title:
            (folder / block.title).write_text(block.body, encoding="utf-8")
        elif block.language == "console":
            found += [command for command in commands(block.body) if command.startswith("hysdel ")]
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--beside", type=Path, help="another checkout, measured in the same run")
    parser.add_argument("--runs", type=int, default=3, help="timed runs of each command, of which the least counts")
    options = parser.parse_args()
    trees = [ROOT] if options.beside is None else [options.beside.resolve(), ROOT]
    print("  cpu s  command" if options.beside is None else " beside    here  ratio  command")
    with tempfile.TemporaryDirectory() as name:
        for command in prepared(Path(name)):
            runs = [[seconds(command, tree, Path(name)) for tree in trees] for _ in range(1 + options.runs)]
            least = [min(times) for times in zip(*runs[1:], strict=True)]
            ratio = f"  {least[0] / least[1]:5.1f}" if options.beside else ""
            print("  ".join(f"{value:6.2f}" for value in least) + f"{ratio}  {command[:84]}", flush=True)


if __name__ == "__main__":
    main()
