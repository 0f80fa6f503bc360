"""Clutch engagement in closed loop: our branch and bound beside SCIP on the same problems in the same run.

    python benchmarks/clutch_loop.py [--horizons 5 10 15] [--backend auto] [--node-limit 60] [--no-scip] [--json FILE]

The loop follows our controller (warm start as in use). SCIP solves each step's problem from scratch, as its users do.
Both stop at a relative gap of 1e-4; SCIP also after --scip-seconds, ours after --node-limit nodes. Read ratios: both
columns come from one run on one machine.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import scip

from hysdel_py.control.move import Move
from hysdel_py.demos import clutch

GAP = 1e-4


def run_loop(horizon: int, options: argparse.Namespace) -> dict[str, Any]:
    """One engagement; figures of both solvers over the steps that the predictive controller made."""
    ours: list[Move] = []
    theirs: list[scip.ScipAnswer] = []
    with_scip = scip.available() and not options.no_scip

    class Recorded:
        def __init__(self, controller: Any) -> None:
            self.inner = controller

        def solve(self, x: Any, ref: Any) -> Move:
            move = self.inner.solve(x, ref)
            ours.append(move)
            if with_scip and len(theirs) < options.scip_steps:
                theirs.append(scip.solve(self.inner.problem(x, ref), gap_rel=GAP, time_limit=options.scip_seconds))
            return move

    def progress(k: int, steps: int) -> None:
        print(f"\rhorizon {horizon}: step {k} of at most {steps}", end="", file=sys.stderr)

    result = clutch.engage(
        horizon=horizon,
        backend=options.backend,
        node_limit=options.node_limit,
        wrap=Recorded,
        progress=progress,
    )
    print(file=sys.stderr)
    return {
        "horizon": horizon,
        "engaged": result.engaged,
        "ours": our_figures(ours),
        "scip": scip_figures(theirs, ours) if theirs else None,
    }


def our_figures(moves: list[Move]) -> dict[str, float]:
    return times([m.seconds for m in moves]) | {
        "nodes": float(np.mean([m.nodes for m in moves])),
        "qps": float(np.mean([m.qps for m in moves])),
        "proven": sum(m.gap <= max(1e-5, GAP * abs(m.cost)) for m in moves),
        "worst_gap": max(m.gap / max(abs(m.cost), 1e-9) for m in moves),
    }


def scip_figures(answers: list[scip.ScipAnswer], moves: list[Move]) -> dict[str, float]:
    excess = [(m.cost - a.cost) / max(abs(a.cost), 1e-9) for m, a in zip(moves, answers, strict=False)]
    return times([a.seconds for a in answers]) | {
        "nodes": float(np.mean([a.nodes for a in answers])),
        "proven": sum(a.status in ("optimal", "gaplimit") for a in answers),
        "our_cost_above": max(excess),
        "our_cost_below": -min(excess),
    }


def times(seconds: list[float]) -> dict[str, float]:
    ms = 1e3 * np.array(seconds)
    return {
        "steps": len(ms),
        "median": float(np.median(ms)),
        "mean": float(ms.mean()),
        "p95": float(np.percentile(ms, 95)),
        "worst": float(ms.max()),
    }


def report(results: list[dict[str, Any]]) -> str:
    lines = [
        "times in ms per step",
        f"{'horizon':>7} {'solver':>9} {'steps':>5} {'median':>8} {'mean':>8} {'p95':>8} {'worst':>8}"
        f" {'nodes':>7} {'QPs':>6} {'proven':>6}",
    ]
    for result in results:
        for name in ("ours", "scip"):
            f = result[name]
            if f is None:
                lines.append(f"{result['horizon']:>7} {name:>9}   not run (pyscipopt is not installed, or --no-scip)")
                continue
            qps = f"{f['qps']:6.1f}" if "qps" in f else "     -"
            lines.append(
                f"{result['horizon']:>7} {name:>9} {f['steps']:>5} {f['median']:8.1f} {f['mean']:8.1f} {f['p95']:8.1f} "
                f"{f['worst']:8.1f} {f['nodes']:7.1f} {qps} {f['proven']:>6}"
            )
        if result["scip"]:
            f = result["scip"]
            lines.append(
                f"{'':>7} our cost is above SCIP's by {100 * f['our_cost_above']:.3g} % at most, and below by "
                f"{100 * f['our_cost_below']:.3g} % at most"
            )
            lines.append(f"{'':>7} our worst certified gap is {100 * result['ours']['worst_gap']:.3g} %")
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--horizons", type=int, nargs="+", default=[5, 10, 15])
    parser.add_argument("--backend", default="auto")
    parser.add_argument("--node-limit", type=int, default=60)
    parser.add_argument("--no-scip", action="store_true")
    parser.add_argument("--scip-seconds", type=float, default=3.0)
    parser.add_argument("--scip-steps", type=int, default=1000, help="compare only the first steps")
    parser.add_argument("--json", metavar="FILE")
    options = parser.parse_args()
    results = [run_loop(horizon, options) for horizon in options.horizons]
    print(report(results))
    if options.json:
        Path(options.json).write_text(json.dumps(results, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
