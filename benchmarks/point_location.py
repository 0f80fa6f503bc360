"""What an evaluation of an explicit law costs: search tree, regions in turn, with the last region kept, online QP.

    python benchmarks/point_location.py [--points 20000] [NAME ...]

Points are those of a walk inside the map, so that keeping the last region has a meaning: forty steps each from one
random point of the map to the next. Times are the least of five passes, per call; those of Python are of a thousand
points, those of the verified QP of two hundred. C is compiled with gcc -O2, in double and float, and called in a loop.
`tables` is what the constant tables take, `code` the sections of the object for gcc -Os (text and data, tables
included) as `size` counts them on this machine.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
from c_driver import FLAGS, CompiledLaw
from mpqp import problem
from numpy.typing import NDArray

from hysdel_py.control.explicit_certificate import random_points
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.online_problem import OnlineProblem
from hysdel_py.optimize.mpqp import MpQp, solve_mpqp

NAMES = ("a_di_N3", "a_di_N10", "f_thesis", "c_pend_N3", "b_ms2_N3", "d_aftisoft_N2")
PASSES = 5
STEPS = 40


def walk(law: ExplicitLaw, count: int, seed: int) -> NDArray[np.float64]:
    """Points near each other, all in the map, which is convex: straight ways between random points."""
    rng = np.random.default_rng(seed)
    inside = [p for p in random_points(law, 500, rng) if law.locate(p) >= 0]
    ends = [inside[number] for number in rng.integers(len(inside), size=count // STEPS + 2)]
    ways = [np.linspace(start, end, STEPS, endpoint=False) for start, end in pairwise(ends)]
    return np.concatenate(ways)[:count]


def least(run: Callable[[], object], calls: int) -> float:
    """Microseconds per call."""
    times = []
    for _ in range(PASSES):
        started = time.perf_counter()
        run()
        times.append(time.perf_counter() - started)
    return 1e6 * min(times) / calls


def in_python(law: ExplicitLaw, mpqp: MpQp, points: NDArray[np.float64]) -> list[float]:
    """Microseconds per call: tree, all regions, last region kept, online."""
    some, few = points[:1000], points[:200]
    online = OnlineProblem(mpqp)
    _ = law.tree

    def kept() -> None:
        last = None
        for point in some:
            last = law.locate(point, last)

    return [
        least(lambda: [law.locate(point, tree=True) for point in some], len(some)),
        least(lambda: [law.locate(point) for point in some], len(some)),
        least(kept, len(some)),
        least(lambda: [online.solve(point) for point in few], len(few)),
    ]


def object_bytes(source: Path) -> int:
    """Text and data of the object."""
    target = source.with_suffix(".o")
    subprocess.run(["gcc", *FLAGS, "-Os", "-fno-asynchronous-unwind-tables", "-c", source, "-o", target], check=True)
    sizes = subprocess.run(["size", target], capture_output=True, text=True, check=True).stdout.splitlines()[1].split()
    return int(sizes[0]) + int(sizes[1])


def in_c(law: ExplicitLaw, points: NDArray[np.float64], folder: Path, name: str) -> list[str]:
    """Nanoseconds and bytes of each method and number."""
    texts = []
    for number in ("double", "float"):
        for method, keeps in (("tree", False), ("sequential", False), ("sequential", True)):
            code = law.to_c(folder / f"{name}_{method}_{number}.c", number=number, method=method)
            compiled = CompiledLaw(law, code, keeps)
            times = [compiled(points)[2] for _ in range(PASSES)]
            sizes = "" if keeps else f"{code.table_bytes} | {object_bytes(code.files[0])} | "
            texts.append(f"{sizes}{1e9 * min(times):.0f}")
    return texts


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--points", type=int, default=20_000)
    options = parser.parse_args()
    has_gcc = shutil.which("gcc") is not None
    python_lines, c_lines = [], []
    with tempfile.TemporaryDirectory() as folder:
        for name in options.names or NAMES:
            mpqp, moves = problem(name)
            law = ExplicitLaw.of(solve_mpqp(mpqp), moves)
            points = walk(law, options.points, 0)
            numbers = " | ".join(f"{value:.1f}" for value in in_python(law, mpqp, points))
            python_lines.append(f"| {name} | {law.p} | {law.count} | {law.tree.tree.depth} | {numbers} |")
            print(python_lines[-1], file=sys.stderr, flush=True)
            if has_gcc:
                texts = in_c(law, points, Path(folder), name)
                c_lines += [f"| {name} | double | {' | '.join(texts[:3])} |",
                            f"| {name} | float | {' | '.join(texts[3:])} |"]  # fmt: skip
                print("\n".join(c_lines[-2:]), file=sys.stderr, flush=True)
    print("Python, µs per call\n")
    print("| problem | parameters | regions | depth | tree | all regions | last region kept | online QP |")
    print("|---" * 8 + "|", *python_lines, sep="\n")
    print("\nC" if has_gcc else "\ngcc is not installed: no times of C")
    if has_gcc:
        print("\n| problem | numbers | tree: tables | code | ns | in turn: tables | code | ns | last kept: ns |")
        print("|---" * 9 + "|", *c_lines, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
