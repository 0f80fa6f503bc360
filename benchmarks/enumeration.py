"""Random small control problems against full enumeration and SCIP.

    python benchmarks/enumeration.py [--count 500] [--first 0] [--norms 1,2,inf] [--no-scip]

Each problem is solved by the controller, by trying every sequence of modes and Boolean inputs with one dense program
each, and by SCIP (extra `compare`). The planned inputs are then run through the modes, and the states compared. One
line is printed per disagreement, then one per norm; the exit status is 1 if there was a disagreement.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[1] / "tests"), str(Path(__file__).parent)]

import scip  # noqa: E402 -- beside this file, and the tests' problems beside them
from pwa_enumeration import Problem, optimum, random_problem  # noqa: E402

from hysdel_py.control.hybrid_mpc import HybridMpc  # noqa: E402
from hysdel_py.control.move import Move, MoveStatus  # noqa: E402

TOLERANCE = 1e-5
"""Relative to the size of the cost, and at least absolute."""
EDGE = 1e-5
"""A state this close to the line between the modes may be in either."""


def same(a: float, b: float) -> bool:
    if not (np.isfinite(a) and np.isfinite(b)):
        return a == b
    return abs(a - b) <= TOLERANCE * max(1.0, abs(a), abs(b))


def run_differs(problem: Problem, move: Move) -> bool:
    """Whether the modes, run under the planned inputs, leave the planned states."""
    plan = move.predicted
    for k, u in enumerate(plan.u):
        x = plan.x[k]
        nexts = [
            mode.A @ x + mode.B @ u + mode.f
            for mode in problem.modes
            if (mode.G @ x + mode.H @ u <= mode.g + EDGE).all()
        ]
        if not any(np.abs(x1 - plan.x[k + 1]).max() <= 1e-4 for x1 in nexts):
            return True
    return False


def scip_cost(mpc: HybridMpc, problem: Problem) -> float:
    answer = scip.solve(mpc.problem(problem.x0), gap_rel=1e-7, time_limit=60.0)
    return answer.cost if answer.status in ("optimal", "gaplimit") else np.inf


def compare(seed: int, norm: float, with_scip: bool) -> tuple[list[str], str, float]:
    """Disagreements of one problem, the status, and the seconds of the controller."""
    problem = random_problem(seed, norm)
    mpc = problem.controller()
    start = time.perf_counter()
    move = mpc.solve(problem.x0)
    seconds = time.perf_counter() - start
    found = []
    if move.status not in (MoveStatus.OPTIMAL, MoveStatus.INFEASIBLE):
        found.append(f"no verdict: {move.message}")
    expected = optimum(problem)
    if not same(move.cost, expected):
        found.append(f"cost {move.cost:.9g}, by enumeration {expected:.9g}")
    if move.bound > expected + TOLERANCE * max(1.0, abs(expected)):
        found.append(f"bound {move.bound:.9g} above the optimum {expected:.9g}")
    if move.ok and run_differs(problem, move):
        found.append("the plan is no run of the modes")
    if with_scip and not same(other := scip_cost(mpc, problem), expected):
        found.append(f"SCIP says {other:.9g}, enumeration {expected:.9g}")
    return found, move.status.value, seconds


def main() -> int:
    parser = argparse.ArgumentParser(description="Compare the controller with enumeration and SCIP.")
    parser.add_argument("--count", type=int, default=500, help="problems per norm")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--norms", default="1,2,inf")
    parser.add_argument("--no-scip", action="store_true")
    options = parser.parse_args()
    with_scip = not options.no_scip and scip.available()
    wrong = 0
    for norm in map(float, options.norms.split(",")):
        count: Counter[str] = Counter()
        seconds = []
        for seed in range(options.first, options.first + options.count):
            found, status, duration = compare(seed, norm, with_scip)
            for line in found:
                print(f"norm {norm:g}, seed {seed}: {line}", flush=True)
            wrong += bool(found)
            count[status] += 1
            seconds.append(duration)
        verdicts = ", ".join(f"{number} {status}" for status, number in sorted(count.items()))
        print(
            f"norm {norm:g}: {options.count} problems, {verdicts}; median {1e3 * np.median(seconds):.1f} ms, "
            f"longest {1e3 * max(seconds):.1f} ms",
            flush=True,
        )
    print(f"{wrong} problems with a disagreement; compared with enumeration{' and SCIP' if with_scip else ''}")
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
