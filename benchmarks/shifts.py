"""Gear shifts on plants that differ from the model, under noise, and what the document left open.

    python benchmarks/shifts.py                    # robustness of the three shifts
    python benchmarks/shifts.py --shifts upshift-23
    python benchmarks/shifts.py --open             # effects of what is odd in the document

Noise: standard deviations of 0.2 rad/s for engine and secondary shaft, 0.02 rad/s for the wheels, 0.5 Nm and 0.5 N.
"""

# ruff: noqa: E501  (rows of printed tables read better unbroken)
from __future__ import annotations

import argparse
from collections.abc import Callable
from math import log

import numpy as np

from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.controllers import part_model
from hysdel_py.demos.shifts.plant import FINE, Deviation, ShiftPlant
from hysdel_py.demos.shifts.shift import run_shift
from hysdel_py.demos.shifts.traction import sustained, traction
from hysdel_py.demos.shifts.transmission import Transmission

NOISE = {"we": 0.2, "ws": 0.2, "wv": 0.02, "Te": 0.5, "Fnb": 0.5, "Fnc": 0.5}
VARIANTS = {
    "nominal": (Deviation(), None),
    "friction -20 %": (Deviation(friction=0.8), None),
    "friction +20 %": (Deviation(friction=1.2), None),
    "mass -10 %": (Deviation(mass=0.9), None),
    "mass +10 %": (Deviation(mass=1.1), None),
    "noise": (Deviation(), NOISE),
}


def robustness(names: list[str]) -> None:
    print(
        "| shift | plant | locked after | torque off, part 1 | part 2 | brake at reversal | limits broken | by fallback, without |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for name in names:
        for variant, (deviation, noise) in VARIANTS.items():
            j = run_shift(SHIFTS[name], deviation=deviation, noise=noise, seed=1).judgement
            locked = "never" if j.shift_time is None else f"{j.shift_time:.2f} s"
            off = f"{j.deviation_release:.0f} Nm ({100 * j.relative_release:.1f} %) | {j.deviation_engage:.0f} Nm"
            rest = f"{j.brake_at_reversal:.2f} N | {', '.join(j.broken) or 'none'} | {j.fallbacks}, {j.without}"
            print(f"| {name} | {variant} | {locked} | {off} | {rest} |", flush=True)


def left_open(data: Transmission) -> None:
    for name, shift in SHIFTS.items():
        ratio, x = data.gears[shift.gears[0]], data.stationary(shift.gears[0], shift.torques[0], shift.speed)
        listed, physical = x["we"] - ratio * x["ws"], x["we"] - x["ws"] / ratio
        print(f"{name}: slip at the start {physical:.3g} rad/s, as the listing has it {listed:.3g} rad/s")
    for beyond in ("line", "range"):
        print(
            f"traction in gear 2 at 95 rad/s, curve beyond 628 rad/s by {beyond}: {traction(data, 2, 95.0, beyond=beyond):.0f} Nm"
        )
    print(
        f"gear 1 at 40 rad/s: {traction(data, 1, 40.0):.0f} Nm at rest, {sustained(data, 1, 40.0):.0f} Nm while the vehicle speeds up"
    )
    _powers(data)
    _primary_shaft(data)


def _powers(data: Transmission) -> None:
    """The original compiler takes a^b in a constant for ln(a) + b."""
    for gear in data.gears:

        def constants(square: Callable[[float], float], gear: int = gear) -> tuple[float, float]:
            shafts = data.J_s + data.J_p / square(data.gears[gear])
            return shafts, (data.J_f * data.J_e + square(data.r_gn) * shafts * data.J_f
                            + square(data.r_gn / data.z) * shafts * data.J_e)  # fmt: skip

        (shafts, all_), (faulty, faulty_all) = constants(lambda a: a * a), constants(lambda a: log(a) + 2)
        print(f"gear {gear}: J_ps {shafts:.5f}, with the faulty power {faulty:.5f}; "
              f"J_L {all_:.5f}, {faulty_all:.5f}: accelerations {all_ / faulty_all:.3f} times as large")  # fmt: skip


def _primary_shaft(data: Transmission) -> None:
    """The gear change of the document leaves the secondary shaft its speed; an ideal synchroniser does not."""
    shift = SHIFTS["upshift-23"]
    old, new = (data.gears[g] for g in shift.gears)
    a = data.z / data.r_gn
    inertia = np.array([[data.J_e + data.z**2 * data.J_f, -a * data.z * data.J_f],
                        [-a * data.z * data.J_f, data.J_s + data.J_p / new**2 + a * a * data.J_f]])  # fmt: skip
    ws = shift.speed / data.r_d
    impulse = data.J_p * (1 / old - 1 / new) * ws / new
    jump = np.linalg.solve(inertia, [0.0, impulse])[1]
    plant = ShiftPlant(part_model(shift, 2, data), data, 3)
    x = np.array([100.0, 62.0, 0.0, 600.0 / data.k, 433.0, ws + jump, shift.speed])
    for _ in range(15):
        x = plant.step(x, np.zeros(3))
    fine = np.vstack(plant.fine)
    torque = data.k * fine[:, FINE.index("dphi")] + data.d * (
        data.r_d * fine[:, FINE.index("ws")] - fine[:, FINE.index("wv")]
    )
    print(
        f"ideal synchroniser, 2-3: secondary shaft jumps by {jump:.2f} rad/s, torque at the wheels peaks at {torque.max():.0f} Nm of 600"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shifts", nargs="+", default=list(SHIFTS), choices=list(SHIFTS))
    parser.add_argument("--open", action="store_true", help="effects of what is odd in the document")
    options = parser.parse_args()
    if options.open:
        left_open(Transmission())
    else:
        robustness(options.shifts)


if __name__ == "__main__":
    main()
