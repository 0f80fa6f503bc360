"""One engagement by numerical dynamic programming, analytical dynamic programming and hybrid MPC, on one plant.

The plant is the exact clutch in steps of 0.05 s (hybrid MPC: 0.01 s), once as modelled and once with a clutch that
transmits 5 % less and a drag 20 % higher than every controller believes. Cost is that of section 9.1, at steps of
0.05 s; the rate at lock-up is what the controller's model gives at the speeds before it.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from time import perf_counter

import numpy as np

from hysdel_py.control.costs import Cost
from hysdel_py.control.dynamic_programming.analytical import AnalyticalDp
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.demos.dry_clutch import DryClutch
from hysdel_py.demos.dynamic_programming import STAGES, START, engagement_problem, judged_engagement
from hysdel_py.model import load

RATE = 800.0  # Nm/s
LARGEST = 180.0  # Nm
LESS_TORQUE, MORE_DRAG = 0.95, 1.2


def loop(ask, plant, share, steps=STAGES):
    """Speeds, inputs and seconds per step; the rate and the range of the torque are those of the actuator."""
    x, u, seconds, last = [np.array(START)], [], [], 0.0
    for k in range(steps):
        begin = perf_counter()
        wanted = ask(k, x[-1], last)
        seconds.append(perf_counter() - begin)
        if wanted is None:
            wanted = last
        most = RATE * plant.sample_time
        last = float(np.clip(np.clip(wanted, last - most, last + most), 0.0, LARGEST))
        u.append([last])
        x.append(plant(x[-1][None], np.array([[share * last]]))[0])
    return np.array(x), np.array(u), np.array(seconds)


def numerical():
    begin = perf_counter()
    problem = engagement_problem()
    table = problem.backward()
    offline = perf_counter() - begin
    plan = table.plan(START, [0.0]).trajectory.u[:, 0]
    return {
        "numerical DP, feedforward": (lambda k, _x, _last: plan[k], offline),
        "numerical DP, feedback by lookahead": (lambda k, x, last: first(table(x, k, [last])), offline),
        "numerical DP, feedback by stored inputs": (
            lambda k, x, last: first(table(x, k, [last], "interpolate")), offline,
        ),
    }  # fmt: skip


def first(u):
    return None if u is None else float(u[0])


def analytical():
    """Speeds and last torque as states, its increment as input; the effort grows until all limits are kept."""
    begin = perf_counter()
    for effort in 10.0 ** np.arange(-1, 4, 0.25):
        feedback = slip_program(effort).solve()
        ask = followed(feedback)
        x, _, _ = loop(ask, DryClutch(), 1.0)
        rates = np.abs(np.diff(np.concatenate([[0.0], feedback.simulate([*START, 0.0]).x[1:, 2]])))
        inside = rates.max() <= RATE * 0.05 + 1e-9 and feedback.simulate([*START, 0.0]).x[:, 2].max() <= LARGEST
        if x[:, 0].min() >= 80.0 and inside:
            break
    return {f"analytical DP, effort {effort:.3g}": (ask, perf_counter() - begin)}


def slip_program(effort, stages=17):
    plant = DryClutch()
    J1, J2, b = plant.engine_inertia, plant.vehicle_inertia, plant.drag
    A = np.array([[0, 0, -1 / J1], [0, -b / J2, 1 / J2], [0, 0, 0]])
    held = AnalyticalDp.from_continuous(
        A[:2, :2], A[:2, 2:], 0.05, [plant.engine_torque / J1, 0], stages=1, Q=np.eye(2), R=[[1.0]]
    )
    A = np.block([[held.A, held.B], [np.zeros((1, 2)), np.ones((1, 1))]])
    B = np.vstack([held.B, [[1.0]]])
    slip = np.array([1.0, -1.0, 0.0])
    return AnalyticalDp(
        A, B, stages, d=np.append(held.d, 0.0), Q=10 * np.outer(slip, slip), R=[[effort]], C=slip[None], c=[0.0]
    )  # fmt: skip


def followed(feedback):
    def ask(k, x, last):
        if k >= feedback.stages or abs(x[0] - x[1]) <= 1.0:
            return LARGEST  # stuck: close
        return last + float(feedback([*x, last], k)[0])

    return ask


def hybrid(horizon):
    begin = perf_counter()
    model = load("clutch", we_min=60.0)
    cost = Cost(y={"y2": 5.0, "y3": 4.0})
    limits = Limits(y={"y1": (80.3, None), "y2": (0.0, None)}, u={"Teinc": (0.0, 0.0)}, soft=("y1",), rho=1e5)
    mpc = HybridMpc(model, horizon, cost, limits, references=("y2", "y3"), node_limit=60)
    offline = perf_counter() - begin

    def ask(_k, x, last):
        if x[0] - x[1] <= 1.0:
            return LARGEST
        state = {"we": x[0], "gamma": x[0] - x[1], "Te": 100.0, "Fn": last, "lc": 0.0}
        move = mpc.solve(state, {"y2": 0.0, "y3": 0.0})
        return None if move.u is None else last + float(move.u[1])

    return {f"hybrid MPC, {horizon} steps of 0.01 s": (ask, offline)}


def compared(horizon):
    rows = []
    for name, (ask, offline) in (numerical() | analytical() | hybrid(horizon)).items():
        fine = 5 if "MPC" in name else 1
        plant = DryClutch(sample_time=0.05 / fine)
        for case, share, drag in (("as modelled", 1.0, 1.0), ("different", LESS_TORQUE, MORE_DRAG)):
            other = replace(plant, drag=plant.drag * drag)
            x, u, seconds = loop(ask, other, share, fine * STAGES)
            judged = judged_engagement(x[::fine], u[fine - 1 :: fine])
            judged["least_engine_speed"] = float(x[:, 0].min())
            rows.append({"controller": name, "plant": case, "offline": offline, **judged,
                         "step_median": float(np.median(seconds)), "step_worst": float(seconds.max())})  # fmt: skip
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--horizon", type=int, default=10, help="of the hybrid MPC")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    rows = compared(options.horizon)
    if options.json:
        print(json.dumps(rows))
        return
    print(
        "| controller | plant | cost | least engine speed | locked after | rate at lock-up | off-line | a step, worst |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for r in rows:
        locked = "never" if r["lock_time"] is None else f"{r['lock_time']:.2f} s"
        rate = "-" if r["lock_acceleration"] is None else f"{r['lock_acceleration']:.0f}"
        print(
            f"| {r['controller']} | {r['plant']} | {r['cost']:.0f} | {r['least_engine_speed']:.2f} | {locked} | {rate} "
            f"| {r['offline']:.2f} s | {1e3 * r['step_median']:.2f}, {1e3 * r['step_worst']:.2f} ms |"
        )


if __name__ == "__main__":
    main()
