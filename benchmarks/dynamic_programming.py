"""Numerical dynamic programming: convergence with the grid, scaling in nodes, inputs and processes."""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from time import perf_counter, process_time

import numpy as np

from hysdel_py.control.dynamic_programming.analytical import AnalyticalDp
from hysdel_py.control.dynamic_programming.grids import Axis
from hysdel_py.control.dynamic_programming.problem import DynamicProgram
from hysdel_py.demos.dynamic_programming import START, engagement_problem

A, B = np.array([[1.0, 0.5], [0.0, 1.0]]), np.array([[0.125], [0.5]])


def regulator(cells):
    return DynamicProgram(
        lambda x, u: x @ A.T + u @ B.T, (Axis("s", -2, 2, cells + 1), Axis("v", -2, 2, cells + 1)),
        Axis("a", -4, 4, 4 * cells + 1), 4, lambda x, u, _x1: 0.5 * (x**2).sum(axis=1) + 0.1 * u[:, 0] ** 2,
        end_cost=lambda x: 2 * (x**2).sum(axis=1),
    )  # fmt: skip


def least_time(steps):
    """The double integrator to the origin in steps of ``1 / steps``, on a grid on which every step ends on a node."""
    dt = 1.0 / steps

    def step(x, u):
        return np.stack([x[:, 0] + dt * x[:, 1] + dt**2 / 2 * u[:, 0], x[:, 1] + dt * u[:, 0]], axis=1)

    def away(x):
        return np.abs(x).max(axis=1) > 1e-9

    return DynamicProgram(
        step, (Axis.spaced("s", -1.5, 1.5, dt**2 / 2), Axis.spaced("v", -1.5, 1.5, dt)), Axis("a", -1, 1, 3),
        round(4 / dt), lambda x, _u, _x1: dt * away(x), end_set=lambda x: ~away(x),
    )  # fmt: skip


def exact_time(x):
    """Least time of the double integrator with an input of at most 1."""
    s, v = x if x[0] > -x[1] * abs(x[1]) / 2 else -np.asarray(x)
    return v + 2 * np.sqrt(v**2 / 2 + s)


def convergence(finest):
    exact = AnalyticalDp(A, B, 4, Q=np.eye(2), R=[[0.2]], P=4 * np.eye(2)).solve()
    points = np.random.default_rng(0).uniform(-0.8, 0.8, (20, 2))
    nodes = np.array([(s, v) for s in np.arange(-1, 1.01, 0.25) for v in (-0.5, 0.0, 0.5) if s or v])
    cases = (
        ("quadratic cost, cells per axis", regulator, exact.value, (8, 16, 32, 64), points),
        ("least time, steps per second", least_time, exact_time, (4, 8, 16), nodes),
    )
    print("| problem | size | mean error | order |\n|---|---|---|---|")
    for name, make, truth, sizes, states in cases:
        before = None
        for size in sizes[:finest]:
            table = make(size).backward()
            error = np.mean([abs(table.value(x) - truth(x)) for x in states])
            order = "" if before is None else f"{np.log2(before / error):.2f}"
            print(f"| {name} | {size} | {error:.4f} | {order} |", flush=True)
            before = error


def scaling():
    print("\n| grid [rad/s] | torque step [Nm] | engine torques | transitions | table [MB] | CPU s | planned | cost |")
    print("|---|---|---|---|---|---|---|---|")
    for grid, torque, engine in ((2, 10, 0), (1, 10, 0), (0.5, 10, 0), (1, 5, 0), (1, 2.5, 0), (1, 10, 4), (1, 10, 8)):
        problem = engagement_problem(grid, torque, engine_torques=engine)
        begin = process_time()
        table = problem.backward()
        seconds = process_time() - begin
        plan = table.plan(START, [0.0, 100.0][: len(problem.inputs)])
        stage = problem.schedule[0]
        count = stage.mesh.size * len(stage.inputs)
        cells = [grid, torque, engine or "fixed", count, f"{problem.memory()['table'] / 1e6:.0f}", f"{seconds:.2f}"]
        print("|", " | ".join(map(str, cells)), f"| {plan.planned:.0f} | {plan.cost:.0f} |", flush=True)


def processes():
    print("\n| processes | s | same table |\n|---|---|---|")
    problem = engagement_problem(1.0, 5.0)
    begin = perf_counter()
    alone = problem.backward()
    print(f"| none | {perf_counter() - begin:.2f} | |")
    for workers in (1, 2):
        with ProcessPoolExecutor(workers) as pool:
            list(pool.map(abs, range(workers)))
            begin = perf_counter()
            table = problem.backward(executor=pool)
            seconds = perf_counter() - begin
        same = all(np.array_equal(a, b) for a, b in zip(alone.values, table.values, strict=True))
        print(f"| {workers} | {seconds:.2f} | {same} |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--finest", type=int, default=4, help="how many sizes the study of convergence takes")
    parser.add_argument("--part", choices=["convergence", "scaling", "processes"], help="only this part")
    options = parser.parse_args()
    parts = {"convergence": lambda: convergence(options.finest), "scaling": scaling, "processes": processes}
    for name, part in parts.items():
        if options.part in (None, name):
            part()
