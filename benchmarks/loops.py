"""Closed loops of hybrid controllers: our engine warm, cold and with a work limit, beside Gurobi, CPLEX and SCIP.

    python benchmarks/loops.py                                       all loops, horizons 5, 10 and 15, 10 minutes
    python benchmarks/loops.py --cases clutch --horizons 5 10 15 20 25 30 --budget 300 --plot growth.png
    python benchmarks/loops.py --json loops.json --plot docs/pictures/loops.png

Our engine runs the loop, which is not timed; then each solver answers the mixed-integer programs of its steps, in their
order, on one thread, with the same gap. So each works alone, as in a controller of its own, with the caches of the
processor to itself. Times are processor times, so that other work on the machine counts little; peers
are timed without the building of their models, ours with everything that a call does. The engine with a limit of time
reads the clock for it. A solver that is not installed, or whose edition is too small for a program, is named.
`--budget` is parted evenly among the loops, and what one leaves over goes to the next; each solver has an equal part of
the share of a loop and is not asked about the steps that are left when it has used it, after one step at the earliest.
The exit status is 1 if two solvers proved optima that differ by more than the gap.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import peers
from loop_cases import LoopCase, cases
from numpy.typing import NDArray
from peers import Answer, TooLarge

import hysdel_py as hys

GAP = 1e-4
SMALL_COST = peers.GAP_ABS / GAP
"""Below this cost the absolute gap is the larger one."""
WARM = "warm"
PEERS = ("gurobi", "cplex", "scip")

Vector = NDArray[np.float64]
Ask = Callable[[Vector, Any], Answer]
Step = tuple[Vector, Any]
"""State and references."""


@dataclass(slots=True)
class Loop:
    """One case with one horizon, as it grows.

    Attributes
    ----------
    answers : mapping of solver to its answers, one per step
    left_out : mapping of solver to why it was not run
    ended : str
    last_state : list of float
    """

    case: str
    horizon: int
    variables: int
    rows: int
    binaries: int
    answers: dict[str, list[Answer]] = field(default_factory=dict)
    left_out: dict[str, str] = field(default_factory=dict)
    ended: str = ""
    last_state: list[float] = field(default_factory=list)


def run_loop(case: LoopCase, horizon: int, options: argparse.Namespace, share: float) -> Loop:
    """Run one loop until its goal, its steps or its share of the time are reached."""
    search = {"gap_rel": GAP, "gap_abs": peers.GAP_ABS, "time_limit": options.seconds}
    driver = case.controller(horizon, **search)
    qp = driver.problem(case.first(), case.reference(0)).qp
    loop = Loop(case.name, horizon, qp.n, qp.m, len(driver.formulation.binaries))
    solvers = _solvers(case, driver, horizon, options, loop)
    allowed = share / (1 + len(solvers))
    steps = _drive(case, driver, loop, min(case.steps, options.steps), allowed)
    for name, solver in solvers.items():
        _answer_all(name, solver, steps, loop, allowed)
    return loop


def _drive(case: LoopCase, driver: hys.HybridMpc, loop: Loop, most: int, allowed: float) -> list[Step]:
    """Run the loop with our warm engine; the steps that the others are asked about."""
    steps: list[Step] = []
    begin, x = time.perf_counter(), case.first()
    for k in range(most):
        if case.is_over(x):
            loop.ended = f"goal reached after {k} steps"
            break
        if k and time.perf_counter() - begin > allowed:
            loop.ended = f"its share of the time was over after {k} of {case.steps} steps"
            break
        steps.append((x, case.reference(k)))
        move = driver.solve(x, case.reference(k))
        if move.u is None:
            loop.ended = f"no input at step {k}"
            break
        x = case.advance(x, move.u)
    loop.last_state = x.tolist()
    return steps


def _answer_all(name: str, solver: Any, steps: list[Step], loop: Loop, allowed: float) -> None:
    """Let one solver answer the steps in turn, until its time is over."""
    begin = time.perf_counter()
    for k, (x, ref) in enumerate(steps):
        if k and time.perf_counter() - begin > allowed:
            break
        if isinstance(solver, hys.HybridMpc):
            start = time.process_time()
            move = solver.solve(x, ref, warm=name != "cold")
            answer = _answer(move, time.process_time() - start)
        else:
            try:
                answer = solver(x, ref)
            except TooLarge:
                loop.left_out[name] = "not run: size limit"
                break
        loop.answers.setdefault(name, []).append(answer)


def _solvers(
    case: LoopCase, driver: hys.HybridMpc, horizon: int, options: argparse.Namespace, loop: Loop
) -> dict[str, Any]:
    """Other controllers with the same problem, and the peers that can be asked."""
    search = {"gap_rel": GAP, "gap_abs": peers.GAP_ABS}
    ours: dict[str, Any] = {
        WARM: case.controller(horizon, time_limit=options.seconds, **search),
        "cold": case.controller(horizon, time_limit=options.seconds, **search),
        "limited": case.controller(horizon, node_limit=options.node_limit, time_limit=options.seconds, **search),
        "timed": case.controller(horizon, time_limit=1e-3 * options.time_limit, **search),
    }
    for name, solve in peers.available().items():
        if name not in options.solvers:
            continue
        if solve is None:
            loop.left_out[name] = "not run: not installed"
        else:
            ours[name] = _peer(solve, driver, options.seconds)
    return ours


def _peer(solve: peers.Solve, driver: hys.HybridMpc, seconds: float) -> Ask:
    return lambda x, ref: solve(driver.problem(x, ref), GAP, seconds)


def _answer(move: hys.Move, seconds: float) -> Answer:
    infeasible = move.status is hys.MoveStatus.INFEASIBLE
    return Answer(move.cost, move.status is hys.MoveStatus.OPTIMAL, infeasible, move.nodes, seconds)


# ---- figures --------------------------------------------------------------------------------------------------------


def figures(answers: list[Answer]) -> dict[str, float]:
    """Times in ms, mean nodes, and how many answers were proven."""
    ms = 1e3 * np.array([a.seconds for a in answers])
    return {
        "steps": len(answers),
        "median": float(np.median(ms)),
        "mean": float(ms.mean()),
        "p95": float(np.percentile(ms, 95)),
        "worst": float(ms.max()),
        "nodes": float(np.mean([a.nodes for a in answers])),
        "proven": sum(a.proven or a.infeasible for a in answers),
        "without_plan": sum(not np.isfinite(a.cost) for a in answers),
    }


def disagreements(loop: Loop) -> list[tuple[int, float]]:
    """Steps at which proven optima differ, with the relative difference; infinite where one says there is none."""
    found = []
    for k in range(max(map(len, loop.answers.values()), default=0)):
        proven = {n: a[k] for n, a in loop.answers.items() if len(a) > k and (a[k].proven or a[k].infeasible)}
        costs = [np.inf if a.infeasible else a.cost for a in proven.values()]
        if len(costs) > 1 and np.isfinite(min(costs)):
            difference = (max(costs) - min(costs)) / max(SMALL_COST, abs(min(costs)))
            if difference > GAP:
                found.append((k, float(difference)))
    return found


def excess(loop: Loop, name: str) -> float:
    """By how much the plans of a solver cost more than the cheapest of the step, relative and at worst."""
    worst = 0.0
    for k, answer in enumerate(loop.answers[name]):
        best = min(a[k].cost for a in loop.answers.values() if len(a) > k)
        if np.isfinite(best):
            worst = max(worst, (answer.cost - best) / max(SMALL_COST, abs(best)))
    return worst


def table(loop: Loop) -> Iterator[str]:
    """The lines of one loop."""
    yield (
        f"{loop.case}, horizon {loop.horizon}: {loop.variables} variables, {loop.binaries} binaries, {loop.rows} rows"
        + f"; {loop.ended}" * bool(loop.ended)
    )
    for name, answers in loop.answers.items():
        f = figures(answers)
        yield (
            f"{name:>10} {f['steps']:>5} {f['median']:8.2f} {f['mean']:8.2f} {f['p95']:8.2f} {f['worst']:8.1f} "
            f"{f['nodes']:8.1f} {f['proven']:>6} {100 * excess(loop, name):9.3g}"
        )
    for name, reason in loop.left_out.items():
        yield f"{name:>10} {reason}"
    for k, difference in disagreements(loop):
        yield f"{'':>10} DISAGREEMENT at step {k}: proven optima differ by {100 * difference:.3g} %"


HEAD = "    solver steps   median     mean      p95    worst    nodes proven    excess"
LEGEND = (
    "times in ms per step; nodes: mean; proven: answers with a proof within the gap; excess: by how much a plan costs "
    "more than the cheapest of its step, in % and at worst"
)


def summary(loops: list[Loop]) -> Iterator[str]:
    """Ratios of times of the peers to ours, over the steps that both answered."""
    yield "all loops: time of a peer divided by that of our warm engine, step by step"
    yield f"{'solver':>10} {'steps':>6} {'median':>8} {'geo-mean':>8} {'of sums':>8}"
    for name in dict.fromkeys(name for loop in loops for name in loop.answers):
        pairs = [(a.seconds, w.seconds) for loop in loops
                 for a, w in zip(loop.answers.get(name, []), loop.answers.get(WARM, []), strict=False)]  # fmt: skip
        if name != WARM and pairs:
            theirs, ours = np.array(pairs).T
            ratio = theirs / ours
            yield (
                f"{name:>10} {len(pairs):>6} {np.median(ratio):8.2f} {np.exp(np.log(ratio).mean()):8.2f} "
                f"{theirs.sum() / ours.sum():8.2f}"
            )
    wrong = sum(len(disagreements(loop)) for loop in loops)
    yield f"disagreements between proven optima beyond {100 * GAP:g} %: {wrong}"


def beside_best(loops: list[Loop]) -> Iterator[str]:
    """For each loop the quickest peer by its median, and its figures divided by those of our warm engine."""
    yield "quickest peer of each loop: its times divided by those of our warm engine, over the steps that both answered"
    yield f"{'loop':>22} {'horizon':>7} {'peer':>7} {'steps':>6} {'median':>7} {'mean':>7} {'p95':>7} {'worst':>7}"
    for loop in loops:
        rivals = [(name, *_common(loop, name)) for name in PEERS if name in loop.answers]
        if rivals:
            name, theirs, ours = min(rivals, key=lambda rival: np.median(rival[1]) / np.median(rival[2]))
            figures = [f(theirs) / f(ours) for f in (np.median, np.mean, lambda t: np.percentile(t, 95), np.max)]
            text = " ".join(f"{figure:7.2f}" for figure in figures)
            yield f"{loop.case:>22} {loop.horizon:>7} {name:>7} {len(ours):>6} {text}"


def _common(loop: Loop, name: str) -> tuple[Vector, Vector]:
    pairs = [(a.seconds, w.seconds) for a, w in zip(loop.answers[name], loop.answers[WARM], strict=False)]
    theirs, ours = np.array(pairs).T
    return theirs, ours


# ---- picture --------------------------------------------------------------------------------------------------------

STYLES = {"warm": ("#0072B2", "o-"), "cold": ("#0072B2", "o--"), "limited": ("#56B4E9", "o:"),
          "timed": ("#56B4E9", "o-."),
          "gurobi": ("#D55E00", "s-"), "cplex": ("#009E73", "^-"), "scip": ("#CC79A7", "v-")}  # fmt: skip


def plot(loops: list[Loop], path: str) -> None:
    """Median time of a step over the horizon, one panel for each case; thin lines for the 95th percentile."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    names = list(dict.fromkeys(loop.case for loop in loops))
    columns = min(4, len(names))
    height = -(-len(names) // columns)
    figure = Figure(figsize=(3.4 * columns + 1.2, 2.7 * height + 0.6), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(height, columns, squeeze=False)
    for axes, name in zip(grid.flat, names, strict=False):
        _panel(axes, [loop for loop in loops if loop.case == name])
    for axes in grid.flat[len(names) :]:
        axes.set_axis_off()
    handles = {label: line for axes in grid.flat for line, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(list(handles.values()), list(handles), loc="outside right center", frameon=False, fontsize="small")
    figure.suptitle("time per step: median, and 95th percentile as thin lines", fontsize=10)
    figure.savefig(path)


def _panel(axes: Any, loops: list[Loop]) -> None:
    from matplotlib.ticker import NullFormatter

    for name in dict.fromkeys(name for loop in loops for name in loop.answers):
        at = [loop for loop in loops if name in loop.answers]
        found = [figures(loop.answers[name]) for loop in at]
        colour, style = STYLES[name]
        horizons = [loop.horizon for loop in at]
        axes.plot(horizons, [f["median"] for f in found], style, color=colour, ms=3, lw=1.3, label=name)
        axes.plot(horizons, [f["p95"] for f in found], style[1:], color=colour, lw=0.5)
    axes.set_yscale("log")
    axes.set_title(loops[0].case, fontsize=9)
    axes.set_xticks(
        [loop.horizon for loop in loops], [f"{loop.horizon}\n{loop.binaries}" for loop in loops], fontsize=7
    )
    axes.set_xlabel("horizon [steps] / binaries", fontsize=8)
    axes.set_ylabel("time [ms]", fontsize=8)
    axes.tick_params(axis="y", which="both", labelsize=7)
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.grid(visible=True, color="#dddddd", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)


# ---- program --------------------------------------------------------------------------------------------------------


def as_data(loops: list[Loop]) -> list[dict[str, Any]]:
    """The loops with their figures as plain data."""
    return [asdict(loop) | {"figures": {n: figures(a) for n, a in loop.answers.items()}} for loop in loops]


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", nargs="+", choices=list(cases()), default=list(cases()), metavar="NAME")
    parser.add_argument("--horizons", type=int, nargs="+", default=[5, 10, 15], metavar="N")
    parser.add_argument("--steps", type=int, default=1000, help="at most (default: those of each case)")
    parser.add_argument("--node-limit", type=int, default=30, help="work limit of the column 'limited' (default 30)")
    parser.add_argument("--time-limit", type=float, default=8.0, help="milliseconds of the column 'timed' (default 8)")
    parser.add_argument("--seconds", type=float, default=2.0, help="time limit of every other solve (default 2)")
    parser.add_argument("--solvers", nargs="*", default=list(PEERS), help="peers that are asked")
    parser.add_argument("--budget", type=float, default=600.0, help="seconds for all loops together (default 600)")
    parser.add_argument("--json", metavar="FILE", help="write every answer")
    parser.add_argument("--plot", metavar="FILE", help="write a picture of the growth with the horizon")
    return parser.parse_args()


def main() -> int:
    options = arguments()
    pairs = [(cases()[name], horizon) for horizon in sorted(options.horizons) for name in options.cases]
    end, loops = time.perf_counter() + options.budget, []
    _warm_up(options)
    print(LEGEND, HEAD, sep="\n", flush=True)
    for i, (case, horizon) in enumerate(pairs):
        share = max(0.0, end - time.perf_counter()) / (len(pairs) - i)
        loops.append(run_loop(case, horizon, options, share))
        print(*table(loops[-1]), sep="\n", flush=True)
    print(*beside_best(loops), *summary(loops), sep="\n")
    if options.json:
        Path(options.json).write_text(json.dumps(as_data(loops), indent=1) + "\n", encoding="utf-8")
    if options.plot:
        plot(loops, options.plot)
    return int(any(disagreements(loop) for loop in loops))


def _warm_up(options: argparse.Namespace) -> None:
    """Let compiled kernels and peers load before anything is timed."""
    small = argparse.Namespace(**{**vars(options), "steps": 1, "seconds": 1.0})
    run_loop(cases()["pendulum_wall"], 2, small, 60.0)


if __name__ == "__main__":
    sys.exit(main())
