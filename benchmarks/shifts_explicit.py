"""Explicit laws of the controllers of the gear shifts: how many regions, how long, and where it ends.

    python benchmarks/shifts_explicit.py
    python benchmarks/shifts_explicit.py --seconds 300

Weights and limits are those of the 2-3 upshift; the horizon is short. The parameters are all seven states, or four of
them with the rest fixed at the begin of part 2; references are fixed. A row whose law is not complete shows what had
been found when the time was over.
"""

from __future__ import annotations

import argparse
import time

import hysdel_py as hys
from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.controllers import part_model, part_of, shift_cost, shift_limits
from hysdel_py.demos.shifts.fixed_modes import linear_model
from hysdel_py.demos.shifts.transmission import Transmission

BOX = {"Te": (60.0, 140.0), "Fnb": (0.0, 150.0), "Fnc": (0.1, 190.0), "we": (380.0, 460.0)}
MORE = {"dphi": (0.09, 0.11), "ws": (275.0, 285.0), "wv": (74.0, 76.0)}
FIXED = {"dphi": 0.1, "ws": 278.0, "wv": 74.4}
REFERENCES = {1: {"r(torque)": 600.0, "r(wf)": -50.0, "r(Fnb)": 0.0, "r(Fnc)": 0.0},
              2: {"r(torque)": 600.0, "r(rel)": 0.0, "r(Fnb)": 0.0}}  # fmt: skip
CASES = (
    ("fixed modes", 1, 1, False), ("fixed modes", 1, 2, False), ("fixed modes", 2, 1, False),
    ("fixed modes", 2, 2, False), ("fixed modes", 2, 3, False), ("fixed modes", 2, 4, False),
    ("fixed modes", 2, 2, True), ("hybrid", 1, 1, False), ("hybrid", 2, 1, False), ("hybrid", 2, 2, False),
    ("hybrid", 2, 1, True),
)  # fmt: skip


def controller(kind: str, part: int, horizon: int) -> hys.HybridMpc:
    shift, data = SHIFTS["upshift-23"], Transmission()
    model = linear_model(shift, part, data) if kind == "fixed modes" else part_model(shift, part, data)
    return hys.HybridMpc(model, horizon, shift_cost(part_of(shift, part), part), shift_limits(shift, part, data))


def row_of(kind: str, part: int, horizon: int, whole: bool, seconds: float) -> str:
    box, fixed = (BOX | MORE, {}) if whole else (BOX, FIXED)
    mpc = controller(kind, part, horizon)
    names = {f"r({name})" for name in mpc.references.names} if hasattr(mpc.references, "names") else set()
    held = {name: value for name, value in REFERENCES[part].items() if not names or name in names}
    begin = time.process_time()
    try:
        law = hys.explicit(mpc, box, fixed=fixed | held, settings=hys.MpMiqpSettings(seconds=seconds))
    except hys.HysdelError as error:
        return f"| {kind} | {part} | {horizon} | {len(box)} | - | - | {time.process_time() - begin:.1f} | {error} |"
    took = time.process_time() - begin
    found, complete = f"{len(law.sequences)} | {law.count}", "yes" if law.complete else "no"
    return f"| {kind} | {part} | {horizon} | {len(box)} | {found} | {took:.1f} | {complete} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0, help="limit of the search of each law")
    options = parser.parse_args()
    print("| controller | part | horizon | parameters | sequences with a region | regions | CPU s | complete |")
    print("|---|---|---|---|---|---|---|---|")
    for kind, part, horizon, whole in CASES:
        print(row_of(kind, part, horizon, whole, options.seconds), flush=True)


if __name__ == "__main__":
    main()
