"""Explicit laws of hybrid controllers: sequences tried and given up, regions, seconds, difference from the controller.

    python benchmarks/explicit_hybrid.py [CASE ...] [--samples N] [--seconds S] [--keep-overlaps]

One line per case. `tried` are sequences looked at, partial ones included; `cut` those given up by propagation, by their
rows, and because their parameters fill no volume; `found` the regions before and `kept` those after what is never best
was removed. `cost error` is the greatest distance of the law's value from the interval that the online search proves,
relative; `missing + superfluous` counts points on whose feasibility the two differ.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from time import process_time

import numpy as np

import hysdel_py as hys
from hysdel_py.control.explicit_hybrid import explicit_hybrid
from hysdel_py.optimize.mpmiqp import MpMiqpSettings

TIGHT = {"gap_rel": 1e-8, "gap_abs": 1e-8}
Case = tuple[hys.HybridMpc, dict[str, tuple[float, float]], dict[str, float]]


def two_tanks(horizon: int, norm: float) -> Case:
    cost = hys.Cost(y={"level2": 10}, u={"q": 0.1}, norm=norm)
    mpc = hys.HybridMpc(hys.load("two_tanks"), horizon, cost, references=("level2",), **TIGHT)
    return mpc, {"level2": (0.1, 0.4)}, {}


def two_rooms(horizon: int, norm: float) -> Case:
    cost = hys.Cost(y={"y1": 1, "y2": 1}, u={"ask_heat": 0.1, "ask_cool": 0.1}, norm=norm)
    mpc = hys.HybridMpc(hys.load("two_rooms"), horizon, cost, references=("y1", "y2"), **TIGHT)
    return mpc, {"T1": (10, 30), "T2": (10, 30), "Tout": (0, 20)}, {"r(y1)": 22.0, "r(y2)": 20.0}


def clutch(horizon: int, norm: float) -> Case:
    cost = hys.Cost(y={"y1": 1, "y2": 4, "y3": 4}, norm=norm)
    mpc = hys.HybridMpc(hys.load("clutch"), horizon, cost, references=("y1", "y2", "y3"), **TIGHT)
    fixed = {"lc": 0.0, "r(y1)": 100.0, "r(y2)": 0.0, "r(y3)": 0.0}
    return mpc, {"we": (90, 200), "gamma": (0, 120)}, fixed


CASES: dict[str, tuple[Callable[[int, float], Case], int, float]] = {
    "two_tanks_N1": (two_tanks, 1, 2),
    "two_tanks_N2": (two_tanks, 2, 2),
    "two_tanks_N3": (two_tanks, 3, 2),
    "two_tanks_N2_n1": (two_tanks, 2, 1),
    "two_tanks_N2_inf": (two_tanks, 2, np.inf),
    "two_tanks_N3_n1": (two_tanks, 3, 1),
    "two_rooms_N1": (two_rooms, 1, 2),
    "two_rooms_N2": (two_rooms, 2, 2),
    "two_rooms_N2_n1": (two_rooms, 2, 1),
    "clutch_N1": (clutch, 1, 2),
    "clutch_N2": (clutch, 2, 2),
}

HEAD = (
    "| case | parameters | tried | cut: propagation, rows, flat | solved | sequences | found | kept | search s | "
    "removal s | complete | cost error | missing + superfluous |"
)


def line(name: str, samples: int, settings: MpMiqpSettings, reduce: bool) -> str:
    make, horizon, norm = CASES[name]
    mpc, box, fixed = make(horizon, norm)
    begin = process_time()
    law = explicit_hybrid(mpc, box, fixed=fixed, settings=settings, reduce=False)
    between = process_time()
    if reduce:
        law = law.reduced()
    end = process_time()
    found, r = law.certificate(mpc, samples), law.report
    seconds = f"{between - begin:.2f} | {end - between:.2f}"
    return (
        f"| {name} | {law.p} | {r.tried} | {r.propagated}, {r.infeasible}, {r.flat} | {r.solved} "
        f"| {len(law.sequences)} | {r.found} | {law.count} | {seconds} | {'yes' if law.complete else 'no'} "
        f"| {found.cost_error:.1g} | {found.missing} + {found.superfluous} of {samples} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description="Explicit laws of hybrid controllers.")
    parser.add_argument("cases", nargs="*", help=f"of {', '.join(CASES)}; all by default")
    parser.add_argument("--samples", type=int, default=100)
    parser.add_argument("--seconds", type=float, default=300.0, help="longest search of a case")
    parser.add_argument("--keep-overlaps", action="store_true")
    options = parser.parse_args()
    unknown = [name for name in options.cases if name not in CASES]
    if unknown:
        parser.error(f"no such case: {', '.join(unknown)}")
    print(HEAD)
    print("|" + "---|" * HEAD.count(" | ") + "---|")
    for name in options.cases or CASES:
        print(
            line(name, options.samples, MpMiqpSettings(seconds=options.seconds), not options.keep_overlaps), flush=True
        )


if __name__ == "__main__":
    main()
