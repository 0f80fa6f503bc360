"""Errors of every simulation method on drivetrains with known motion; the table of docs/drivetrain.md.

The error is the greatest over the known signals at the end, relative to the size of the speeds; behind it stands
the greatest error of an event time [s]. A dash is a case that a method does not claim to solve.

    python benchmarks/drivetrain.py [--dt 1e-3]
    python benchmarks/drivetrain.py --stribeck
    NUMBA_CACHE_DIR=$(mktemp -d) python benchmarks/drivetrain.py --first-use
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from time import process_time

import numpy as np

import hysdel_py as hys

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "drivetrain"))
from analytic_cases import CASES, Case


def schemes(dt: float) -> dict[str, tuple[object, set[str]]]:
    """Method with its options, and the kinds of cases that it is not meant for."""
    return {
        "exact": (hys.Exact(look=2e-2), set()),
        "event-driven": (hys.EventDriven(max_step=0.1), set()),
        "theta=1/2": (hys.Moreau(dt=dt), set()),
        "Moreau": (hys.Moreau(dt=dt, theta=None), set()),
        "aug. Lagr.": (hys.AugmentedLagrangian(dt=dt), set()),
        "wait state": (hys.WaitState(dt=dt), set()),
        "variable": (hys.VariableStepMoreau(max_step=5e-3), set()),
        "Switch": (hys.SwitchModel(dt=dt), {"static"}),
        "Karnopp": (hys.Karnopp(dt=dt), {"static"}),
        "fixed LCP": (hys.FixedStepLcp(dt=dt, solver="active-set"), {"static"}),
        "smooth 1e4": (hys.Smoothing(steepness=1e4), {"static"}),
    }


def entry(case: Case, scheme: object, not_meant: set[str]) -> str:
    """Error of the end and of the event times."""
    if case.tags & not_meant or (isinstance(scheme, hys.Exact) and not case.linear):
        return "-"
    run = case.line.simulate(case.start, case.until, scheme)
    error = max(abs(run[signal][-1] - value) for signal, value in case.ends.items()) / case.scale
    times = np.array([event.time for event in run.events])
    if not case.events or not len(times):
        return f"{error:.0e}"
    late = max(float(np.min(np.abs(times - t))) for t in case.events)
    return f"{error:.0e}, {late:.0e}"


def first_use() -> None:
    """Processor time of the first short run of each family of methods, which compiles its kernels."""
    line = CASES["V4 viscous load"]().line
    families = {
        "time-stepping": hys.Moreau(),
        "Runge-Kutta, event-driven": hys.WaitState(),
        "explicit LCP (Lemke)": hys.Moreau(solver="lemke"),
        "explicit LCP (Gauss-Seidel)": hys.Moreau(solver="pgs", decomposition="boxed"),
        "time-stepping again": hys.Moreau(),
    }
    for family, scheme in families.items():
        start = process_time()
        line.simulate({"engine": 120, "vehicle": 0}, 0.01, scheme)
        print(f"{family:<30}{process_time() - start:6.1f} s", flush=True)


def stribeck_cases() -> dict[str, tuple[hys.Drivetrain, dict[str, float], float]]:
    """Drivetrains whose friction falls with the slip, with starts and ends."""

    def belt(friction: object) -> hys.Drivetrain:
        return hys.Drivetrain(
            hys.Inertia("m", 1), hys.SpringDamper("x", "m", hys.GROUND, 1), hys.SpeedSource("belt", 0.2),
            hys.Clutch("contact", "belt", "m", 1, friction),
        )  # fmt: skip

    slide = hys.Drivetrain(hys.Inertia("m", 1), hys.Brake("brake", "m", 10, hys.Stribeck(1, 0.5, 2)))
    clutch = hys.Drivetrain(
        hys.Inertia("a", 0.2), hys.Inertia("b", 0.8), hys.TorqueSource("T", "a", 30), hys.Load("road", "b", 0.67),
        hys.Clutch("clutch", "a", "b", [(0, 60), (1, 60), (2, 0)], hys.Stribeck(1, 0.7, 5)),
    )  # fmt: skip
    start = {"m": 0.2, "x": 0.9}
    return {
        "Stribeck, slide to rest": (slide, {"m": 4}, 0.9),
        "Stribeck, stick-slip": (belt(hys.Stribeck(1, 0.5, 0.1)), start, 5.0),
        "Stribeck, clutch under load": (clutch, {"a": 120, "b": 20}, 1.9),
        "Coulomb 1, 0.5, stick-slip": (belt(hys.Coulomb(1, 0.5)), start, 5.0),
    }


def stribeck_orders() -> None:
    """Mean errors of theta = 1/2 against an event-driven run, and their order."""
    steps = (2e-2, 1e-2, 5e-3, 2.5e-3)
    for name, (line, start, until) in stribeck_cases().items():
        precise = hys.EventDriven(rtol=1e-11, atol=1e-11, solver="active-set")
        reference = line.simulate(start, until, precise, sample=until / 10)
        runs = [line.simulate(start, until, hys.Moreau(dt=dt), sample=until / 10) for dt in steps]
        errors = [float(np.abs(run.speeds - reference.speeds).mean()) for run in runs]
        order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
        print(f"{name:<30}{'  '.join(f'{error:.1e}' for error in errors)}   order {order:.2f}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dt", type=float, default=1e-3)
    parser.add_argument("--stribeck", action="store_true", help="print orders with falling friction instead")
    parser.add_argument("--first-use", action="store_true", help="print processor times of first runs instead")
    options = parser.parse_args()
    if options.first_use:
        first_use()
        return
    if options.stribeck:
        stribeck_orders()
        return
    methods = schemes(options.dt)
    print(f"| case | {' | '.join(methods)} |")
    print("|---" * (len(methods) + 1) + "|")
    for name, make in CASES.items():
        print(f"| {name} | {' | '.join(entry(make(), *method) for method in methods.values())} |", flush=True)


if __name__ == "__main__":
    main()
