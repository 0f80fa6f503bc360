"""Multi-parametric quadratic programs: regions, times and solved problems, beside PPOPT on the same machine.

    python benchmarks/mpqp.py [NAME ...] [--largest N] [--repeat 3] [--peers-limit SECONDS] [--check N] [--sweep N]

Without names all problems of tests/data/mpqp with at most --largest regions run. Times are CPU seconds of one process,
the least of --repeat runs after a first one that compiles the kernels where numba is installed and is reported apart.
--count counts the nearest-point problems (LDP) per region, with plain kernels in a process of its own.
--peers-limit runs PPOPT (pip install ppopt) on each problem in a process of its own, with the algorithm that is its
best there, after a small problem that warms it up, and cuts it off after so many CPU seconds (Unix only).
--check N compares law and value with the problem solved online at N parameters, half of them on facets.
--sweep N solves N random degenerate problems of each kind instead, and looks for holes, overlaps and differences.
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
from dataclasses import astuple, fields
from pathlib import Path
from typing import Any

import numpy as np

from hysdel_py.compiled import kernels_are_compiled
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.mpqp import MpQp, ParametricSolution, solve_mpqp

CUT = 77
"""Exit code of a process that has reached its limit."""
DATA = Path(__file__).parents[1] / "tests" / "data" / "mpqp"
EXPECTED = json.loads((DATA / "expected.json").read_text(encoding="utf-8"))
BEST = {"a_di_N10": "geometric", "a_di_N2": "geometric", "a_di_N3": "geometric", "a_di_N5": "geometric",
        "b_ms2_N5": "graph", "b_ms2_N6": "graph", "e_rnd1_z4t2": "geometric", "e_rnd6_z5t5": "combinatorial",
        "g_ahmadi_ex2": "combinatorial"}  # fmt: skip
"""The algorithm of PPOPT that finds most regions, and of several the fastest; elsewhere its combinatorial graph."""


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
        "count, plain = [0], f.nearest_in\n"
        "def nearest(*a):\n    count[0] += 1\n    return plain(*a)\n"
        "f.nearest_in = nearest\n"
        f"regions = len(mpqp.solve_mpqp(mpqp.problem({name!r})[0]).regions)\n"
        "print(count[0] / regions)"
    )
    env = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    answer = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True)
    return float(answer.stdout)


def beside_ppopt(name: str, limit: float) -> tuple[int, float] | None:
    """Regions and CPU seconds of PPOPT in a process of its own; None after the limit."""
    command = [sys.executable, __file__, "--peer", name, "--peers-limit", str(limit)]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    if answer.returncode == CUT:
        return None
    answer.check_returncode()
    regions, seconds = answer.stdout.split()[-2:]
    return int(regions), float(seconds)


def run_ppopt(name: str, limit: float) -> int:
    """What :func:`beside_ppopt` starts."""
    import signal

    with contextlib.redirect_stdout(io.StringIO()):
        with_ppopt("g_bemporad02")
        signal.signal(signal.SIGPROF, lambda *_: os._exit(CUT))
        signal.setitimer(signal.ITIMER_PROF, limit)
        started = time.process_time()
        regions = with_ppopt(name)
        seconds = time.process_time() - started
    print(regions, seconds)
    return 0


def with_ppopt(name: str) -> int:
    """Number of regions that PPOPT finds."""
    from ppopt.mp_solvers.solve_mpqp import mpqp_algorithm
    from ppopt.mp_solvers.solve_mpqp import solve_mpqp as solve
    from ppopt.mpqp_program import MPQP_Program

    mpqp, _ = problem(name)
    theta = mpqp.theta
    column = [np.array(v, dtype=float).reshape(-1, 1) for v in (mpqp.w, mpqp.f, theta.b)]
    G, F, H, A, S = (np.array(a) for a in (mpqp.G, mpqp.F, mpqp.H, theta.A, mpqp.S))
    program = MPQP_Program(G, column[0], column[1], F, H, A, column[2], S, post_process=True)
    return len(solve(program, mpqp_algorithm[BEST.get(name, "combinatorial_graph")]).critical_regions)


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
        found_by = ExplicitLaw.of(solution, moves).certificate(mpqp, options.check)
        text += f" {found_by.feasible} | {found_by.law_error:.0e} | {found_by.value_error:.0e} "
        text += f"| {found_by.missing}, {found_by.superfluous}, {found_by.overlaps}, {found_by.undecided} |"
    ratio = None
    if options.peers_limit:
        answer = beside_ppopt(name, options.peers_limit)
        ratio = (answer[1] if answer else options.peers_limit) / seconds
        text += f" {BEST.get(name, 'combinatorial_graph')} | "
        text += f"{answer[0]} | {answer[1]:.3g} | {ratio:.0f} |" if answer else f"cut | | > {ratio:.0f} |"
    return text, ratio


def header(options: argparse.Namespace) -> list[str]:
    titles = ["problem", "nz/nθ/m", "expected", "regions", "CPU ms", "µs per region", "sets", "points", "complete"]
    titles += ["LDP per region"] * options.count
    titles += ["feasible", "law error", "value error", "missing, superfluous, overlaps, undecided"] * bool(
        options.check
    )
    titles += ["PPOPT's algorithm", "its regions", "its CPU s", "time ratio"] * bool(options.peers_limit)
    return ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]


def sweep(count: int) -> int:
    """Random degenerate problems; prints what was found."""
    from degenerate import KINDS, Counts, swept

    names = [field.name.replace("_", " ") for field in fields(Counts)]
    print("| kind | " + " | ".join(names) + " |\n|" + "---|" * (len(names) + 1))
    found = {kind: swept(kind, range(count)) for kind in KINDS}
    for kind, counts in found.items():
        print(f"| {kind} | " + " | ".join(map(str, astuple(counts))) + " |")
    return 0 if all(counts.clean for counts in found.values()) else 1


def installed(name: str) -> bool:
    from importlib.util import find_spec

    return find_spec(name) is not None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--largest", type=int, default=10_000)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--check", type=int, default=0)
    parser.add_argument("--count", action="store_true")
    parser.add_argument("--peers-limit", type=float, default=0.0)
    parser.add_argument("--peer", help=argparse.SUPPRESS)
    parser.add_argument("--sweep", type=int, default=0)
    options = parser.parse_args()
    if options.peer:
        return run_ppopt(options.peer, options.peers_limit)
    if options.sweep:
        return sweep(options.sweep)
    if options.peers_limit and not installed("ppopt"):
        print("PPOPT is not installed (pip install ppopt): its columns are left out")
        options.peers_limit = 0.0
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
        print(f"\ngeometric mean of the ratios {np.exp(np.mean(np.log(ratios))):.0f}, least {min(ratios):.0f}, "
              f"greatest {max(ratios):.0f}; a problem that was cut counts with the limit")  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())
