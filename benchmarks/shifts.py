"""Gear shifts beside other controllers, what can be done at all, and what the document left open.

    python benchmarks/shifts.py --compare                    # hybrid, fixed modes, ramps
    python benchmarks/shifts.py --compare --shifts upshift-23
    python benchmarks/shifts.py --variants                   # one parameter of the plant off at a time
    python benchmarks/shifts.py --feasible                   # the best that any controller could do in part 1
    python benchmarks/shifts.py --open                       # effects of what is odd in the document
    python benchmarks/shifts.py --tune-ramps 60              # so many steps of the search that tuned the ramps

Many random plants: benchmarks/shift_study.py.
"""

# ruff: noqa: E501  (rows of printed tables read better unbroken)
from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import asdict, replace
from math import log

import numpy as np

from hysdel_py.demos.shifts.cases import SHIFTS
from hysdel_py.demos.shifts.controllers import part_model
from hysdel_py.demos.shifts.judgement import Judgement
from hysdel_py.demos.shifts.methods import METHODS, first_state
from hysdel_py.demos.shifts.plant import FINE, Deviation, ShiftPlant
from hysdel_py.demos.shifts.ramps import RampTuning
from hysdel_py.demos.shifts.release_program import greatest_held, least_deviation
from hysdel_py.demos.shifts.sensors import NOISE
from hysdel_py.demos.shifts.shift import run_shift
from hysdel_py.demos.shifts.traction import sustained, traction
from hysdel_py.demos.shifts.transmission import Transmission

VARIANTS = {
    "nominal": (Deviation(), None),
    "friction -20 %": (Deviation(friction=0.8), None),
    "friction +20 %": (Deviation(friction=1.2), None),
    "inertia -20 %": (Deviation(inertia=0.8), None),
    "inertia +20 %": (Deviation(inertia=1.2), None),
    "load +20 %, mass +20 %": (Deviation(load=1.2, mass=1.2), None),
    "delay 5 ms": (Deviation(delay=0.005), None),
    "noise": (Deviation(), NOISE),
}
COLUMNS = "locked after | torque off, part 1 | part 2 | slope at lock-up | jerk at lock-up | heat in brake, clutch | brake at reversal | limits broken | limits touched | by fallback, without |"


def row_of(j: Judgement) -> str:
    locked = "never" if j.shift_time is None else f"{j.shift_time:.2f} s"
    slope, jerk = ("-" if value is None else f"{value:.1f}" for value in (j.lockup_slope, j.jerk))
    return (
        f"{locked} | {j.deviation_release:.0f} Nm ({100 * j.relative_release:.1f} %) | {j.deviation_engage:.0f} Nm "
        f"| {slope} rad/s^2 | {jerk} rad/s^3 | {j.brake_energy / 1e3:.1f}, {j.clutch_energy / 1e3:.1f} kJ "
        f"| {j.brake_at_reversal:.2f} N | {', '.join(j.broken) or 'none'} | {', '.join(j.touched) or 'none'} "
        f"| {j.fallbacks}, {j.without} |"
    )


def compare(names: list[str]) -> None:
    print(f"| shift | controller | {COLUMNS}\n|{'---|' * 12}")
    for name in names:
        for controller in METHODS:
            print(
                f"| {name} | {controller} | {row_of(run_shift(SHIFTS[name], controller=controller).judgement)}",
                flush=True,
            )


def variants(names: list[str]) -> None:
    print(f"| shift | plant | observer | {COLUMNS}\n|{'---|' * 13}")
    for name in names:
        for variant, (deviation, noise) in VARIANTS.items():
            for observed in (True, False):
                run = run_shift(SHIFTS[name], deviation=deviation, noise=noise, seed=1, observed=observed)
                print(f"| {name} | {variant} | {'yes' if observed else 'no'} | {row_of(run.judgement)}", flush=True)


def feasible(data: Transmission) -> None:
    for gear, speed in ((1, 40.0), (2, 40.0), (2, 75.0), (3, 75.0)):
        held = [greatest_held(data, gear, speed, seconds) for seconds in (0.1, 0.5)]
        print(f"gear {gear} at {speed:g} rad/s: held for 0.1 s {held[0]:.0f} Nm, for 0.5 s {held[1]:.0f} Nm; "
              f"while the vehicle speeds up {sustained(data, gear, speed):.0f} Nm, at rest {traction(data, gear, speed):.0f} Nm")  # fmt: skip
    first = SHIFTS["upshift-12"]
    for fall in (0.15, 0.2, 0.25, 0.3, 0.4, 0.5):
        show_plan(f"1600 to 850 Nm within {fall:g} s", replace(first, fall=fall, guard=None), data)
    for name in ("upshift-12", "upshift-12-held"):
        show_plan(name, SHIFTS[name], data)


def show_plan(title: str, shift, data: Transmission) -> None:
    plan = least_deviation(shift, data, first_state(shift, data), 0.45)
    print(f"{title}: torque off by {100 * plan.deviation:.2f} % at least, proven {100 * plan.proven:.2f} %")


def tune_ramps(steps: int, seed: int = 0) -> None:
    """A random walk from the present tuning that keeps what is better on the nominal 2-3 upshift."""
    rng, best = np.random.default_rng(seed), RampTuning()
    cost = price(best)
    print(f"start: {cost:.1f} {best}")
    for _ in range(steps):
        factors = np.exp(0.2 * rng.standard_normal(len(asdict(best))))
        tried = RampTuning(
            **{name: float(value * f) for (name, value), f in zip(asdict(best).items(), factors, strict=True)}
        )
        found = price(tried)
        if found < cost:
            best, cost = tried, found
            print(f"{cost:.1f} {best}", flush=True)


def price(tuning: RampTuning) -> float:
    j = run_shift(SHIFTS["upshift-23"], controller="ramps", tuning=tuning).judgement
    late = 100.0 * ((3.0 if j.shift_time is None else j.shift_time) - 1.2)
    slope = 300.0 if j.lockup_slope is None else abs(j.lockup_slope)
    rule = 50.0 * j.brake_at_reversal + 100.0 * sum("brake rule" in text for text in j.broken)
    return j.deviation_release + j.deviation_engage + 0.3 * slope + late + rule


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
    parser.add_argument("--compare", action="store_true", help="hybrid controllers, fixed modes and ramps")
    parser.add_argument("--variants", action="store_true", help="plants with one parameter off")
    parser.add_argument("--feasible", action="store_true", help="the best that any controller could do in part 1")
    parser.add_argument("--open", action="store_true", help="effects of what is odd in the document")
    parser.add_argument("--tune-ramps", type=int, metavar="STEPS", help="search for a better tuning of the ramps")
    options = parser.parse_args()
    if options.open:
        left_open(Transmission())
    elif options.feasible:
        feasible(Transmission())
    elif options.tune_ramps is not None:
        tune_ramps(options.tune_ramps)
    elif options.variants:
        variants(options.shifts)
    else:
        compare(options.shifts)


if __name__ == "__main__":
    main()
