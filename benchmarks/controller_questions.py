"""What is proven, and what is only tested, about the controllers of the clutch and of the gear shift.

python benchmarks/controller_questions.py            as in docs/reachability.md
python benchmarks/controller_questions.py --runs N   closed loops of the predictive controller (default 12)

Three kinds of answers stand apart: of the lock-up law, which is affine with limits and so closes the loop as a model
of its own, whose queries are proven; of the model of a gear shift under any inputs; and of the predictive controller of
the clutch, which solves a mixed-integer program at each sample and is only run from random starts.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import hysdel_py as hys
from hysdel_py.demos.clutch import LEAST_ENGINE_SPEED, engage
from hysdel_py.shipped import locate

STALL = 80.0
STARTS = {"we": (90.0, 110.0), "gamma": (50.0, 80.0), "Te": (10.0, 30.0)}
"""Random starts of the predictive controller, clutch open."""

LAW_AUX = "REAL wanted, rate;  BOOL open, below, above;"
LAW = """
    AD { open = gamma > 0.4;  below = wanted - Fn <= -8;  above = wanted - Fn >= 8; }
    DA { wanted = {IF open THEN (Te*Jv + b*(we - gamma)*Je)/(Je + Jv)/mu + 3/mu ELSE 180};
         rate = {IF below THEN -8 ELSE {IF above THEN 8 ELSE wanted - Fn}}; }
"""
QUERIES = """
    QUERIES {
      NEVER we <= 80 WITHIN 10 FROM %(start)s;
      EVENTUALLY gamma <= 0.2 WITHIN 10 FROM %(start)s;
      EVENTUALLY gamma <= 0.2 WITHIN 3 FROM %(start)s;
    }
"""
START = (
    "we >= 95 & we <= 110 & gamma >= 0.2 & gamma <= 1 & Te >= 15 & Te <= 25 & Fn >= 30 & Fn <= 45 & lc <= 0 & lc >= 0"
)


def closed_clutch() -> hys.Model:
    """The clutch near lock-up under the law that takes over from the predictive controller.

    The law keeps the engine torque and holds the clutch 3 Nm tighter than sticking needs, or closes it once the slip is
    at most 0.4 rad/s; its force changes by at most 8 N in a sample of 10 ms. The stick window is 0.2 rad/s.
    """
    text = Path(locate("clutch")).read_text(encoding="utf-8")
    begin, end = text.index("    INPUT {"), text.index("    OUTPUT {")
    text = text[:begin] + text[end:]
    text = text.replace("BOOL stick,", LAW_AUX + "\n      BOOL stick,").replace("    AD {", LAW + "    AD {", 1)
    text = text.replace("Te = Te + Teinc;", "Te = Te;").replace("Fn = Fn + Fninc;", "Fn = Fn + rate;")
    closing = text.rstrip().removesuffix("}").rstrip().removesuffix("}")
    front = "/* extension: queries */\n"
    return hys.load(front + closing + QUERIES % {"start": START} + "  }\n}\n", reltol=0.2, we_min=60.0)


def of_law() -> Iterator[str]:
    """Queries of the closed loop, proven or contradicted."""
    yield "lock-up law of the clutch, closed loop, all states of the set:"
    for found in hys.answer_queries(closed_clutch(), seconds=200.0):
        asked = found.query.text.partition(" FROM ")[0]
        extra = "" if found.answer.message == "" else f" ({found.answer.message})"
        yield f"  {asked:34} {found.verdict:12} {found.answer.verdict:12} {found.answer.seconds:7.2f} s{extra}"


def of_gear_shift() -> Iterator[str]:
    """How hard may the brake hold the flywheel in a sample in which it comes to stand still? Under any inputs."""
    text = Path(locate("bist_part2")).read_text(encoding="utf-8")
    text = text.replace("    STATE {", "    STATE {\n      REAL before [0, F_max];", 1)
    text = text.replace("    CONTINUOUS {", "    CONTINUOUS {\n      before = Fnb;", 1)
    model = hys.load(text)
    yield "gear shift, any state in range, any inputs; the brake one sample before the flywheel turns forwards:"
    for force in (5.02, 4.9):
        found = hys.can_reach(model, {"before": 0.0}, f"before >= {force} & wf >= 0", 2)
        yield f"  at least {force:g} N                       {found.verdict:12} {found.seconds:20.2f} s"


def of_predictive_controller(runs: int) -> Iterator[str]:
    """Closed loops from random starts: tested, not proven."""
    draw = np.random.default_rng(0)
    begin, lowest, times, failed = time.perf_counter(), np.inf, [], 0
    for _ in range(runs):
        start = {name: float(draw.uniform(*ends)) for name, ends in STARTS.items()} | {"Fn": 0.0, "lc": 0.0}
        found = engage(start=start, node_limit=20)
        lowest = min(lowest, found.least_engine_speed)
        failed += not found.engaged
        times.append(np.nan if found.lockup_time is None else found.lockup_time)
    yield f"predictive controller of the clutch, {runs} closed loops of 1 s from random starts, tested only:"
    yield f"  least engine speed {lowest:.2f} rad/s (stall {STALL:g}, limit {LEAST_ENGINE_SPEED:g})"
    yield f"  not locked: {failed}; locked after {np.nanmin(times):.3f} to {np.nanmax(times):.3f} s"
    yield f"  {time.perf_counter() - begin:.0f} s"


def main() -> None:
    """Print all answers."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=12, metavar="N", help="closed loops of the predictive controller")
    runs = parser.parse_args().runs
    for part in (of_law(), of_gear_shift(), of_predictive_controller(runs) if runs else ()):
        for line in part:
            print(line, flush=True)


if __name__ == "__main__":
    main()
