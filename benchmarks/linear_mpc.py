"""Linear controllers: explicit against online answers, back ends against each other, times.

    python benchmarks/linear_mpc.py [--points 2000] [--controllers 200]

Prints the tables of docs/linear-mpc.md. Times are those of this machine at this moment; compare their ratio only.
"""

from __future__ import annotations

import argparse
from collections import Counter
from time import perf_counter

import numpy as np

import hysdel_py as hys
from hysdel_py.control.explicit_certificate import random_points
from hysdel_py.demos.linear_clutch import BOX, linear_clutch_controller

INTEGRATOR = hys.Lti([[1, 1], [0, 1]], [[1], [0.5]])
TANKS = hys.Lti([[0.8, 0.1], [0, 0.6]], [[0.2], [0.5]], [[1, 0]])


def controllers():
    """Name, controller and box."""
    hard = hys.LinearLimits(u=(-1, 1), y=(-5, 5), terminal="invariant", rho=np.inf)
    soft = hys.LinearLimits(u=(-1, 1), y=(-3, 3), rho=50.0, slack="signal")
    rates = hys.LinearLimits(u=(-1, 1), du=(-0.4, 0.4), y=(-1, 1))
    yield "linear clutch, tracking", linear_clutch_controller(), BOX
    yield "double integrator, hard", hys.LinearMpc(INTEGRATOR, "regulator", 5, limits=hard), (-6, 6)
    yield "double integrator, soft", hys.LinearMpc(INTEGRATOR, "regulator", 4, limits=soft), (-6, 6)
    tracking = hys.LinearMpc(TANKS, "track", 6, hys.LinearCost(du=0.05), rates, control_horizon=3)
    yield "two tanks, tracking", tracking, {"x": (-2, 2), "u": (-1, 1), "r": (-1.5, 1.5)}


def arguments(mpc, zeta):
    nx, nu = mpc.lti.nx, mpc.lti.nu * mpc.uses_last_input
    return zeta[:nx], zeta[nx + nu :] if mpc.tracks else None, zeta[nx : nx + nu] if nu else None


def compare(name, mpc, box, points):
    """One line of the table of explicit against online answers."""
    law = hys.explicit(mpc, box)
    worst, both, odd = 0.0, 0, 0
    times = np.zeros(2)
    for zeta in random_points(law, points, np.random.default_rng(0)):
        call = arguments(mpc, zeta)
        begin = perf_counter()
        online = mpc.solve(*call)
        middle = perf_counter()
        own = law.solve(*call)
        times += (middle - begin, perf_counter() - middle)
        if online.ok and own.ok:
            both += 1
            worst = max(worst, float(np.abs(online.u - own.u).max()))
        odd += online.ok != own.ok
    print(f"| {name} | {law.count} | {points} | {both} | {odd} | {worst:.1e} | {times[0] / times[1]:.1f} |", flush=True)


def random_controller(seed, backend):
    """A controller and states near and far from its limits; None where its arguments do not fit."""
    rng = np.random.default_rng(seed)
    nx, nu, ny = (int(n) for n in (rng.integers(1, 5), rng.integers(1, 3), rng.integers(1, 3)))
    A = rng.normal(size=(nx, nx))
    A *= rng.uniform(0.3, 1.3) / np.abs(np.linalg.eigvals(A)).max()
    tracks, N = bool(rng.random() < 0.5), int(rng.integers(1, 8))
    lti = hys.Lti(A, rng.normal(size=(nx, nu)), rng.normal(size=(ny, nx)), rng.normal(size=(ny, nu)) * (seed % 3 == 0))
    limits = hys.LinearLimits(
        u=(-1, 1), du=(-0.5, 0.5), y=(-2, 2), rho=float(rng.choice([10.0, 1e4, 1e6, np.inf])),
        rho_linear=float(rng.choice([0.0, 10.0])), slack=str(rng.choice(["all", "signal", "stage"])),
    )  # fmt: skip
    mpc = hys.LinearMpc(
        lti, "track" if tracks else "regulator", N, limits=limits, control_horizon=int(rng.integers(1, N + 1)),
        output_constraint_horizon=int(rng.integers(0, N + 1)), input_constraint_horizon=int(rng.integers(0, N + 1)),
        backend=backend,
    )  # fmt: skip
    sizes = (0.3, 1.0, 3.0, 10.0)
    calls = [(rng.normal(size=nx) * s, rng.normal(size=ny) if tracks else None, rng.uniform(-1, 1, nu)) for s in sizes]
    return mpc, calls


def back_ends(count):
    """Statuses of the back ends, and the greatest difference of their costs."""
    names, statuses, worst = ("dense", "piqp", "osqp"), Counter(), 0.0
    for seed in range(count):
        made = [random_controller(seed, name) for name in names]
        for call in made[0][1]:
            moves = [mpc.solve(*call) for mpc, _ in made]
            statuses[tuple(move.status.value for move in moves)] += 1
            costs = [move.cost for move in moves if move.ok]
            if costs:
                worst = max(worst, (max(costs) - min(costs)) / max(1.0, abs(costs[0])))
    for status, number in sorted(statuses.items()):
        print(f"| {' / '.join(status)} | {number} |")
    print(f"\nGreatest relative difference of the costs of {', '.join(names)}: {worst:.1e}")


def main() -> None:
    parser = argparse.ArgumentParser(description="Linear controllers: explicit against online, back ends, times.")
    parser.add_argument("--points", type=int, default=2000)
    parser.add_argument("--controllers", type=int, default=200)
    options = parser.parse_args()
    print("| controller | regions | points | with a plan | one answer only | greatest difference of u | time ratio |")
    print("|---|---|---|---|---|---|---|")
    for name, mpc, box in controllers():
        compare(name, mpc, box, options.points)
    print("\n| dense / piqp / osqp | calls |\n|---|---|")
    back_ends(options.controllers)


if __name__ == "__main__":
    main()
