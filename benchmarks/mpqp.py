"""Multi-parametric quadratic programs: regions, times and solved problems, beside PPOPT on the same machine.

    python benchmarks/mpqp.py [NAME ...] [--largest 700] [--ppopt] [--check 0] [--repeat 3]

Without names all problems of tests/data/mpqp with at most --largest regions run. Times are CPU seconds of one process,
the least of --repeat runs after a first one that compiles the kernels where numba is installed. --count counts the
nearest-point problems (LDP) per region, with plain kernels in a process of its own. --ppopt runs the combinatorial
graph and the geometric algorithm of PPOPT (pip install ppopt) and prints what each finds. --check N compares law
and value with the problem solved online at N parameters.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.compiled import kernels_are_compiled
from hysdel_py.optimize.mpqp import MpQp, ParametricSolution, solve_mpqp

DATA = Path(__file__).parents[1] / "tests" / "data" / "mpqp"
EXPECTED = json.loads((DATA / "expected.json").read_text(encoding="utf-8"))
ALGORITHMS = ("combinatorial_graph", "geometric")


def problem(name: str) -> tuple[MpQp, int]:
    data = np.load(DATA / f"{name}.npz")
    fields = (data[key] for key in ("H", "f", "F_theta", "G", "w", "S"))
    return MpQp(*fields, Polyhedron.box(data["lb"], data["ub"])), int(data["nu"])


def cpu(run: Callable[[], Any], repeat: int) -> tuple[Any, float]:
    """Result and least CPU time of several runs."""
    least, result = np.inf, None
    for _ in range(repeat):
        started = time.process_time()
        result = run()
        least = min(least, time.process_time() - started)
    return result, least


def counted(name: str) -> float:
    """Nearest-point problems per region, counted in a process of its own with plain kernels."""
    code = (
        "import sys; sys.path.insert(0, 'benchmarks'); import mpqp, hysdel_py.optimize.parametric.facets as f\n"
        "count, plain = [0], f.nearest\n"
        "def nearest(*a):\n    count[0] += 1\n    return plain(*a)\n"
        "f.nearest = nearest\n"
        f"regions = len(mpqp.solve_mpqp(mpqp.problem({name!r})[0]).regions)\n"
        "print(count[0] / regions)"
    )
    env = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    answer = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True)
    return float(answer.stdout)


def with_ppopt(mpqp: MpQp, algorithm: str) -> tuple[int, float] | None:
    """Regions and CPU seconds of PPOPT; None where it is not installed or fails."""
    try:
        from ppopt.mp_solvers.solve_mpqp import mpqp_algorithm
        from ppopt.mp_solvers.solve_mpqp import solve_mpqp as solve
        from ppopt.mpqp_program import MPQP_Program
    except ImportError:
        return None
    theta = mpqp.theta
    column = [np.array(v, dtype=float).reshape(-1, 1) for v in (mpqp.w, mpqp.f, theta.b)]
    arrays = [np.array(a) for a in (mpqp.G, mpqp.F, mpqp.H, theta.A, mpqp.S)]
    G, F, H, A, S = arrays
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            started = time.process_time()
            program = MPQP_Program(G, column[0], column[1], F, H, A, column[2], S, post_process=True)
            found = solve(program, mpqp_algorithm[algorithm])
            return len(found.critical_regions), time.process_time() - started
    except Exception as error:
        print(f"  PPOPT's {algorithm}: {type(error).__name__}: {error}", file=sys.stderr)
        return None


def line(name: str, options: argparse.Namespace) -> tuple[str, float | None]:
    mpqp, moves = problem(name)
    solution: ParametricSolution
    solution, seconds = cpu(lambda: solve_mpqp(mpqp), options.repeat)
    found = len(solution.regions)
    mark = "" if found == EXPECTED[name] else " !"
    text = f"| {name} | {mpqp.n}/{mpqp.p}/{mpqp.m} | {EXPECTED[name]} | {found}{mark} | {1e3 * seconds:.3g} "
    text += f"| {1e6 * seconds / max(found, 1):.0f} | {solution.explored} | {solution.points} "
    text += f"| {'yes' if solution.complete else 'no'} |"
    if options.count:
        text += f" {counted(name):.0f} |"
    if options.check:
        certificate = ExplicitLaw.of(solution, moves).certificate(mpqp, options.check)
        text += f" {certificate.value_error:.0e}, {certificate.missing + certificate.overlaps} |"
    ratio = None
    if options.ppopt:
        answers = [with_ppopt(mpqp, algorithm) for algorithm in ALGORITHMS]
        text += "".join(" - |" if a is None else f" {a[0]} in {a[1]:.3g} s |" for a in answers)
        times = [a[1] for a in answers if a is not None]
        ratio = min(times) / seconds if times else None
        text += f" {ratio:.0f} |" if ratio else " - |"
    return text, ratio


def header(options: argparse.Namespace) -> list[str]:
    titles = ["problem", "nz/nθ/m", "expected", "regions", "CPU ms", "µs per region", "sets", "points", "complete"]
    titles += ["LDP per region"] * options.count
    titles += ["value error, missing + overlaps"] * bool(options.check)
    titles += ["PPOPT graph", "PPOPT geometric", "its best / ours"] * options.ppopt
    return ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]


def installed(name: str) -> bool:
    from importlib.util import find_spec

    return find_spec(name) is not None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--largest", type=int, default=700)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--check", type=int, default=0)
    parser.add_argument("--count", action="store_true")
    parser.add_argument("--ppopt", action="store_true")
    options = parser.parse_args()
    if options.ppopt and not installed("ppopt"):
        print("PPOPT is not installed (pip install ppopt): its columns are left out")
        options.ppopt = False
    names = options.names or [name for name in sorted(EXPECTED) if EXPECTED[name] <= options.largest]
    started = time.process_time()
    solve_mpqp(problem("g_bemporad02")[0])
    print(f"kernels {'compiled' if kernels_are_compiled() else 'in plain Python'}, "
          f"first run {time.process_time() - started:.1f} s CPU\n")  # fmt: skip
    print("\n".join(header(options)))
    ratios = []
    for name in names:
        text, ratio = line(name, options)
        print(text, flush=True)
        ratios += [ratio] if ratio else []
    if ratios:
        print(f"\ngeometric mean of the ratios {np.exp(np.mean(np.log(ratios))):.0f}, "
              f"least {min(ratios):.0f}, greatest {max(ratios):.0f}")  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())
