"""What tight big-M constants bring to hybrid predictive control, and what they cost to compile.

    python benchmarks/tightening.py [--horizons 5 10] [--models clutch ...] [--node-limit 300] [--steps 4]
    python benchmarks/tightening.py --compile

For each shipped model, and for one whose ranges are too wide while MUST says the right ones, one closed loop is run
with the interval form. Each of its problems is then solved by a controller of every form: interval constants, those by
linear programs, and the latter with shared Booleans and without redundant rows. All controllers see the same states,
start without a plan from before and stop at the same gap or number of nodes. Read ratios: all columns come from one
run.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import hysdel_py as hys
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.big_m import Ranges
from hysdel_py.lowering.tightening import tighten

FORMS: dict[str, dict[str, Any]] = {
    "interval": {"big_m": "interval"},
    "lp": {},
    "lp+share": {"share": True},
    "lp+compact": {"share": True, "compact": True},
}


@dataclass(frozen=True)
class Task:
    """A loop of a shipped model."""

    model: str
    cost: hys.Cost
    reference: dict[str, float]
    x0: tuple[float, ...]
    parameters: dict[str, float]
    limits: hys.Limits | None = None
    text: str = ""


def ranges_in_must() -> str:
    """The two tanks with ranges that are ten times too wide, and MUST that says what they should be."""
    text = (Path(__file__).parents[1] / "models" / "two_tanks.hys").read_text(encoding="utf-8")
    wide = text.replace("[0, h_max]", "[-10*h_max, 10*h_max]")
    return wide.replace("MUST {", "MUST { h1 >= 0; h1 <= h_max; h2 >= 0; h2 <= h_max;")


TASKS = (
    Task(
        "clutch", hys.Cost(y={"y1": 1.0, "y2": 4.0, "y3": 4.0}), {"y1": 100.0, "y2": 0.0, "y3": 0.0},
        (100.0, 12.0, 20.0, 20.0, 0.0), {"we_min": 60.0},
        hys.Limits(y={"y1": (80.3, None), "y2": (0.0, None), "y3": (-11.0, 11.0)}, soft=("y1",), rho=1e5),
    ),
    Task("two_tanks", hys.Cost(y={"level2": 10.0}, u={"q": 1.0}), {"level2": 0.3}, (0.1, 0.4), {}),
    Task(
        "two_tanks_wide", hys.Cost(y={"level2": 10.0}, u={"q": 1.0}), {"level2": 0.3}, (0.1, 0.4), {},
        text=ranges_in_must(),
    ),
    Task("two_rooms", hys.Cost(y={"y1": 1.0, "y2": 1.0}), {"y1": 22.0, "y2": 21.0}, (15.0, 28.0, 25.0, 0.0), {}),
    Task(
        "three_tanks", hys.Cost(y={"level(1)": 1.0, "level(2)": 1.0, "level(3)": 1.0}),
        {"level(1)": 3.0, "level(2)": 2.0, "level(3)": 1.0}, (1.0, 4.0, 5.0), {},
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Figures:
    """Answers of one controller to the problems of a loop."""

    nodes: float
    ms: float
    proven: int
    costs: tuple[float, ...]


def measure(task: Task, horizon: int, options: argparse.Namespace) -> dict[str, Figures]:
    """Figures of all forms at the states of the loop that the first form makes."""
    model = hys.load(task.text or task.model, **task.parameters)
    controllers = {
        name: hys.HybridMpc(
            hys.to_mld(model, **form), horizon, task.cost, task.limits, node_limit=options.node_limit,
            time_limit=options.time_limit,
        )
        for name, form in FORMS.items()
    }  # fmt: skip
    moves: dict[str, list[Any]] = {name: [] for name in FORMS}
    x = np.array(task.x0)
    for _ in range(options.steps):
        for name, controller in controllers.items():
            moves[name].append(controller.solve(x, task.reference, warm=False))
        u = moves["interval"][-1].u
        if u is None:
            break
        x = model.dha.step(x, u, check=False)[0]
    return {name: figures(found) for name, found in moves.items()}


def figures(moves: list[Any]) -> Figures:
    solved = [m for m in moves if m.u is not None]
    return Figures(
        float(np.mean([m.nodes for m in moves])),
        1e3 * float(np.mean([m.seconds for m in moves])),
        sum(m.gap <= max(1e-5, 1e-4 * abs(m.cost)) for m in solved),
        tuple(m.cost if m.u is not None else np.nan for m in moves),
    )


def worst_difference(one: Figures, other: Figures) -> float:
    """Largest relative difference of costs; both are right up to the gap."""
    pairs = zip(one.costs, other.costs, strict=True)
    return max((abs(a - b) / max(1.0, abs(a)) for a, b in pairs if a == a and b == b), default=0.0)


def table(options: argparse.Namespace) -> Iterator[str]:
    yield "| model | horizon | form | nodes | ratio | ms | ratio | proven | cost differs by |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for task in TASKS:
        for horizon in options.horizons:
            if task.model not in options.models:
                continue
            found = measure(task, horizon, options)
            base = found["interval"]
            for name, f in found.items():
                yield (
                    f"| {task.model} | {horizon} | {name} | {f.nodes:.1f} | {f.nodes / base.nodes:.2f} | {f.ms:.1f} | "
                    f"{f.ms / base.ms:.2f} | {f.proven}/{len(f.costs)} | {worst_difference(base, f):.1e} |"
                )


def chain(tanks: int, *, equal: bool) -> str:
    """A chain of tanks with thresholds, choices and requirements at each; equal ones, or each of its own size."""
    k = "0.1" if equal else "(0.1 + 0.001*i)"
    return f"""SYSTEM chain {{
      INTERFACE {{
        PARAMETER {{ REAL n = {tanks}; REAL h_pipe = 0.3; REAL h_max = 0.6; }}
        STATE {{ REAL h(n) [0, h_max]; }}
        INPUT {{ REAL q [0, 0.01]; BOOL valve(n); }}
      }}
      IMPLEMENTATION {{
        AUX {{ INDEX i; BOOL above(n), full(n), forward(n - 1); REAL over(n - 1), pipe(n - 1), drain(n); }}
        AD {{
          above = h >= h_pipe;
          full = h >= 0.9*h_max;
          FOR (i = 1:n - 1) {{ forward(i) = h(i) >= h(i + 1); }}
        }}
        DA {{
          FOR (i = 1:n - 1) {{
            over(i) = {{IF above(i) THEN {k}*(h(i) - h_pipe) ELSE 0}};
            pipe(i) = {{IF forward(i) & ~above(i + 1) THEN {k}*(h(i) - h(i + 1)) ELSE {k}*(h(i) - h(i + 1))/2}};
          }}
          FOR (i = 1:n) {{ drain(i) = {{IF valve(i) THEN {k}*h(i) ELSE 0}}; }}
        }}
        CONTINUOUS {{ h = h + [q; over + pipe] - [over + pipe; 0] - drain; }}
        MUST {{ full -> ~valve; }}
      }}
    }}"""


def compile_table() -> Iterator[str]:
    """Seconds of the processor to lower a Dha to the MLD form by either rule."""
    yield "| model | rows | interval, s | lp, s | programs |"
    yield "|---|---|---|---|---|"
    texts = {task.model: task.text or task.model for task in TASKS}
    texts |= {
        f"chain of {n}, {word}": chain(n, equal=word == "equal") for n in (50, 200) for word in ("equal", "unequal")
    }
    for name, text in texts.items():
        model = hys.load(text)
        interval, mld = seconds(model, "interval")
        lp, _ = seconds(model, "lp")
        programs = tighten(model.dha, Ranges(model.dha, Sink()), Sink()).programs
        yield f"| {name} | {mld.ne} | {interval:.3f} | {lp:.3f} | {programs} |"


def seconds(model: hys.Model, rule: str) -> tuple[float, hys.Mld]:
    hys.to_mld(model, big_m=rule) if len(model.typed.items) < 100 else model.dha
    begin = time.process_time()
    mld = hys.to_mld(model, big_m=rule)
    return time.process_time() - begin, mld


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--horizons", type=int, nargs="+", default=[5, 10])
    parser.add_argument("--models", nargs="+", default=[task.model for task in TASKS])
    parser.add_argument("--node-limit", type=int, default=300)
    parser.add_argument("--time-limit", type=float, default=20.0)
    parser.add_argument("--steps", type=int, default=4)
    parser.add_argument("--compile", action="store_true", help="times of the compiler instead")
    options = parser.parse_args()
    for line in compile_table() if options.compile else table(options):
        print(line, flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
