"""What makes the bounds of a branch and bound stronger, and what does not, on programs of the closed loops.

    python benchmarks/strengthening.py [--cases clutch ...] [--node-limit 3000]

The programs are those that ``loops.py`` meets at some steps, the clutch shortly before lock-up. The first table is
about searches without a plan from before: nodes and milliseconds with means of the solver switched off; a + says that
there is no proof, since the limit of nodes was reached. The second is about the relaxation of the whole problem: which
share of the distance from its plain bound to the optimum each means closes, each in addition to those left of it; the
last one begins again at the changed rows and has the optimum as its incumbent. Read ratios: all columns come from one
run.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any
from unittest import mock

import numpy as np
from loop_cases import cases
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, vstack

from hysdel_py.optimize import miqp as engine
from hysdel_py.optimize.binary_squares import without_binary_squares
from hysdel_py.optimize.compiled_propagation import propagator
from hysdel_py.optimize.kernels.cutoff import narrow_by_cost
from hysdel_py.optimize.kernels.probing import probe
from hysdel_py.optimize.miqp import Miqp, MiqpResult, MiqpSettings, MiqpSolver
from hysdel_py.optimize.propagation import PropagationSettings
from hysdel_py.optimize.qp import Qp
from hysdel_py.optimize.verified import VerifiedSolver

Vector = NDArray[np.float64]
Row = tuple[dict[int, float], float]
"""Coefficients and upper side."""

GAP_ABS, GAP_REL = 1e-5, 1e-4
VIOLATED = 1e-4
"""A cut is added if it is missed by this much, relative to the range of its variable."""
ROUNDS, CUTS = 6, 40
"""Rounds of cuts, and cuts per round."""


@dataclass(frozen=True, slots=True)
class Task:
    """A case, its horizon, the steps whose programs are looked at, and nodes per step on the way there."""

    case: str
    horizon: int
    steps: tuple[int, ...]
    nodes: int


TASKS = (
    Task("clutch", 10, (50, 60, 66, 70, 72, 75), 60),
    Task("clutch", 20, (40, 50), 60),
    Task("two_tanks", 10, (0, 1, 2), 300),
    Task("three_tanks", 5, (0, 1, 2, 3), 300),
    Task("supply_chain", 4, (0, 1), 300),
    Task("heat_and_cool", 5, (0, 1), 300),
    Task("pendulum_wall", 10, (0, 2), 300),
    Task("bist2_23_constant", 10, (0, 10), 300),
)

Programs = list[tuple[int, Miqp]]


def programs(task: Task) -> Programs:
    """Programs of the steps of a task, and the steps."""
    case, found = cases()[task.case], []
    mpc, x = case.controller(task.horizon, node_limit=task.nodes), case.first()
    for k in range(max(task.steps) + 1):
        if k in task.steps:
            found.append((k, mpc.problem(x, case.reference(k))))
        move = mpc.solve(x, case.reference(k))
        if not move.ok or case.is_over(x):
            break
        x = case.advance(x, move.u)
    return found


# ---- the relaxation of the whole problem ----------------------------------------------------------------------------


def settings(**others: Any) -> MiqpSettings:
    return MiqpSettings(gap_abs=GAP_ABS, gap_rel=GAP_REL, **others)


def relaxed(miqp: Miqp) -> tuple[Vector, Vector, float]:
    """Point, multipliers and certified bound of the relaxation in the propagated box."""
    box = propagator(miqp.qp.A, miqp.binaries, PropagationSettings()).propagate(
        miqp.qp.lb, miqp.qp.ub, miqp.qp.l, miqp.qp.u
    )  # fmt: skip
    within = miqp.qp.with_vectors(lb=box.lb, ub=box.ub)
    verdict = VerifiedSolver(within, "piqp", settings().qp).solve(within, (box.lb, box.ub), None, thorough=False)
    return verdict.answer.x, verdict.answer.y, verdict.bound


def kernel_view(miqp: Miqp) -> tuple[Any, Any, tuple[Vector, Vector]]:
    """What the kernels are told, and a propagated box of the whole problem."""
    solver = MiqpSolver(miqp, settings(backend="dense"))
    assert solver.workspace is not None
    qp = miqp.qp
    box = solver.propagator.propagate(qp.lb, qp.ub, qp.l, qp.u)
    return solver.workspace.data(qp, None), solver.workspace.settings[2], (box.lb.copy(), box.ub.copy())


def with_box(miqp: Miqp, box: tuple[Vector, Vector]) -> Miqp:
    return replace(miqp, qp=replace(miqp.qp, lb=box[0], ub=box[1]))


def with_rows(miqp: Miqp, rows: list[Row]) -> Miqp:
    """The program with further rows."""
    qp = miqp.qp
    extra = csr_array((len(rows), qp.n)).tolil()
    for i, (row, _) in enumerate(rows):
        for j, a in row.items():
            extra[i, j] = a
    A = csc_array(vstack([qp.A, extra]))
    l, u = np.append(qp.l, np.full(len(rows), -np.inf)), np.append(qp.u, [side for _, side in rows])  # noqa: E741
    return replace(miqp, qp=Qp(qp.P, qp.q, A, l, u, qp.lb, qp.ub, qp.constant))


def probed(miqp: Miqp, rows: bool) -> Miqp:
    """The program after one probing: its box, and on demand the changed rows."""
    data, rules, box = kernel_view(miqp)
    left, _ = probe(data, box, rules)
    assert left
    narrow = with_box(miqp, box)
    if not rows:
        return narrow
    (start, column, value), l, u = data[0][2], data[0][3], data[0][4]  # noqa: E741
    A = csc_array(csr_array((value, column, start), shape=miqp.qp.A.shape))
    return replace(narrow, qp=replace(narrow.qp, A=A, l=l, u=u))


def branches(miqp: Miqp) -> Iterator[tuple[int, list[Any]]]:
    """Each open binary with the boxes of its values."""
    qp = miqp.qp
    rows = propagator(qp.A, miqp.binaries, PropagationSettings())
    for j in miqp.binaries[qp.lb[miqp.binaries] < qp.ub[miqp.binaries]]:
        boxes = []
        for value in (0.0, 1.0):
            lb, ub = qp.lb.copy(), qp.ub.copy()
            lb[j] = ub[j] = value
            boxes.append(rows.propagate(lb, ub, qp.l, qp.u, np.array([j])))
        if all(box.conflict is None for box in boxes):
            yield int(j), boxes


def implied_bounds(miqp: Miqp, x: Vector) -> list[Row]:
    """Violated rows ``v <= u0 + (u1 - u0) d`` and ``v >= l0 + (l1 - l0) d``, the worst first."""
    found: list[tuple[float, Row]] = []
    width = np.maximum(miqp.qp.ub - miqp.qp.lb, 1e-9)
    for j, (zero, one) in branches(miqp):
        for sign, first, second in ((1.0, zero.ub, one.ub), (-1.0, -zero.lb, -one.lb)):
            missed = (sign * x - first - (second - first) * x[j]) / width
            for v in np.flatnonzero(missed > VIOLATED):
                if v != j:
                    row = {int(v): sign, j: float(first[v] - second[v])}
                    found.append((float(missed[v]), (row, float(first[v]))))
    found.sort(key=lambda pair: -pair[0])
    return [row for _, row in found[:CUTS]]


def cliques(miqp: Miqp, x: Vector) -> list[Row]:
    """Violated rows that allow one of several literals that exclude each other by pairs; grown greedily."""
    excludes = conflicts(miqp)
    value = {(j, v): x[j] if v else 1.0 - x[j] for j, v in excludes}
    order = sorted(excludes, key=lambda literal: -value[literal])
    found: dict[frozenset[tuple[int, int]], float] = {}
    for first in order:
        group = [first]
        for other in order:
            if all(other in excludes[member] for member in group):
                group.append(other)
        total = sum(value[literal] for literal in group)
        if total > 1.0 + VIOLATED:
            found[frozenset(group)] = total
    chosen = sorted(found, key=lambda group: -found[group])[:CUTS]
    return [({j: 1.0 if v else -1.0 for j, v in group}, 1.0 - sum(not v for _, v in group)) for group in chosen]


def conflicts(miqp: Miqp) -> dict[tuple[int, int], set[tuple[int, int]]]:
    """For each literal (binary, value) the literals that propagation excludes beside it."""
    found: dict[tuple[int, int], set[tuple[int, int]]] = {}
    open_ones = miqp.binaries[miqp.qp.lb[miqp.binaries] < miqp.qp.ub[miqp.binaries]]
    for j, boxes in branches(miqp):
        for value, box in enumerate(boxes):
            for k in map(int, open_ones):
                if k != j and box.lb[k] == box.ub[k]:
                    pair = (j, value), (k, int(1 - box.lb[k]))
                    found.setdefault(pair[0], set()).add(pair[1])
                    found.setdefault(pair[1], set()).add(pair[0])
    return found


def cut_rounds(miqp: Miqp, separate: Callable[[Miqp, Vector], list[Row]]) -> Miqp:
    """Add violated cuts until there are none or the rounds are over."""
    for _ in range(ROUNDS):
        cuts = separate(miqp, relaxed(miqp)[0])
        if not cuts:
            break
        miqp = with_rows(miqp, cuts)
    return miqp


def narrowed(miqp: Miqp, optimum: float) -> Miqp:
    """The program narrowed by the optimum as incumbent, then probed; three times."""
    cutoff = optimum - max(GAP_ABS, GAP_REL * abs(optimum))
    for _ in range(3):
        x, y, bound = relaxed(miqp)
        if bound >= cutoff:
            break
        data, rules, box = kernel_view(miqp)
        _, _, left = narrow_by_cost(data, box, x, y, cutoff, rules)
        if not left:
            break
        miqp = probed(with_box(miqp, box), rows=True)
    return miqp


def shares(miqp: Miqp, optimum: float) -> list[float]:
    """Share of the distance from the plain bound to the optimum that each means closes, beside those before."""
    plain = relaxed(miqp)[2]
    program = without_binary_squares(miqp)[0]
    stages = [program, probed(program, rows=False), probed(program, rows=True)]
    stages.append(cut_rounds(stages[-1], implied_bounds))
    stages.append(cut_rounds(stages[-1], cliques))
    stages.append(narrowed(stages[2], optimum))
    bounds = [min(relaxed(stage)[2], optimum) for stage in stages]
    return [plain, *((bound - plain) / max(optimum - plain, 1e-12) for bound in bounds)]


# ---- searches -------------------------------------------------------------------------------------------------------

MEANS: dict[str, dict[str, Any]] = {
    "none": {"probing": 0, "narrowing": False},
    "narrowing": {"probing": 0},
    "probing": {"narrowing": False},
    "both": {},
}


def searched(miqp: Miqp, limit: int, squares: bool = True, **means: Any) -> tuple[MiqpResult, float]:
    """Answer and seconds of a search without hints."""
    keep = mock.patch.object(engine, "without_binary_squares", lambda same: (same, np.zeros(same.qp.n)))
    if squares:
        solver = MiqpSolver(miqp, settings(node_limit=limit, **means))
    else:
        with keep:
            solver = MiqpSolver(miqp, settings(node_limit=limit, **means))
    begin = time.perf_counter()
    answer = solver.solve()
    return answer, time.perf_counter() - begin


def line_of_searches(miqp: Miqp, limit: int) -> tuple[str, float]:
    """Nodes and milliseconds of all variants, and the best objective."""
    answers = [searched(miqp, limit, squares=False, **MEANS["none"])]
    answers += [searched(miqp, limit, **means) for means in MEANS.values()]
    words = [f"{a.nodes}{'' if a.status.value == 'optimal' else '+'} | {1e3 * s:.0f}" for a, s in answers]
    return " | ".join(words), min(a.objective for a, _ in answers)


def main() -> None:
    parser = argparse.ArgumentParser(description="What makes the bounds of a branch and bound stronger.")
    parser.add_argument("--cases", nargs="*")
    parser.add_argument("--node-limit", type=int, default=3000)
    options = parser.parse_args()
    roots = []
    print("| program | free binaries | squares kept: nodes | ms | " + " | ms | ".join(MEANS) + " | ms |")
    print("|" + "---|" * (4 + 2 * len(MEANS)))
    for task in TASKS:
        if options.cases and task.case not in options.cases:
            continue
        for k, miqp in programs(task):
            name = f"{task.case}, horizon {task.horizon}, step {k}"
            words, optimum = line_of_searches(miqp, options.node_limit)
            _, _, box = kernel_view(miqp)
            free = int((box[0] < box[1])[miqp.binaries].sum())
            print(f"| {name} | {free} | {words} |", flush=True)
            roots.append((name, miqp, optimum))
    print("\n| program | plain bound | optimum | squares | probed box | changed rows | implied | cliques | cost |")
    print("|" + "---|" * 9)
    for name, miqp, optimum in roots:
        plain, *closed = shares(miqp, optimum)
        if optimum - plain <= GAP_REL * abs(optimum):
            words = ["closed"] + ["-"] * (len(closed) - 1)
        else:
            words = [f"{100 * max(0.0, share):.0f} %" for share in closed]
        print(f"| {name} | {plain:.6g} | {optimum:.6g} | {' | '.join(words)} |")


if __name__ == "__main__":
    main()
