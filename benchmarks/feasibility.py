"""How often the clutch controller of the source document runs out of inputs, why, and what helps.

    python benchmarks/feasibility.py [--plot docs/pictures/feasibility.png] [--json FILE] [--node-limit 20]

Each controller engages the clutch from a grid of starts, with its own model as the plant, so that no model error is in
play. Prints how many starts fail and when, the explanation of one failure, and the remedies side by side.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import hysdel_py as hys
from hysdel_py.control.settings import DEFAULT_CONTROL_TOLERANCES

Vector = NDArray[np.float64]

LIMIT = 80.8
"""Engine-speed limit of the document's controller, 1.01 times that of its model [rad/s]."""
STALL = 80.0
"""Least engine speed of the document's model [rad/s]."""
SLIPS = (30.0, 60.0, 90.0)
TORQUES = (0.0, 20.0, 60.0)
ENGINE_SPEED = 100.0
STEPS = 100
SECONDS = 0.2
"""Time limit of an answer, beside the limit of nodes."""
REFERENCE = {"y1": 100.0, "y2": 0.0, "y3": 0.0}
WEIGHTS = {"y1": 1.0, "y2": 4.0, "y3": 4.0}
SHOWN = (60.0, 20.0)
"""Slip and torque of the start whose runs are drawn."""


@dataclass(frozen=True, slots=True)
class Remedy:
    """One controller: what it is called, its horizon, and what it adds to the document's limits.

    `settled` is the allowance for limits that no input can move, as :class:`ControlTolerances` has it.
    """

    name: str
    horizon: int
    limits: Mapping[str, Any]
    settled: float = DEFAULT_CONTROL_TOLERANCES.settled


def remedies() -> tuple[Remedy, ...]:
    """The document's controller without and with an allowance for rounding, and three changes of it.

    The terminal set asks that at the end of the plan the engine gives at least what the slipping clutch takes,
    ``Te >= mu Fn``: from there on the engine speed does not fall while both are held.
    """
    holding = ([[0.0, 0.0, -1.0, 1.0, 0.0]], [0.0])
    return (
        Remedy("no allowance", 10, {}, 0.0),
        Remedy("hard, horizon 10", 10, {}),
        Remedy("hard, horizon 15", 15, {}),
        Remedy("softened", 10, {"soft": ("y1",), "rho": 1e5}),
        Remedy("terminal set", 10, {"terminal": holding}),
    )


def controller(model: hys.Model, remedy: Remedy, node_limit: int) -> hys.HybridMpc:
    """The document's controller with a remedy; its limits are 0.99 and 1.01 times those of the model."""
    limits = hys.Limits(
        x={"Te": (0.0, 0.99 * 150), "Fn": (0.0, 0.99 * 180)},
        y={
            "y1": (LIMIT, 0.99 * 200),
            "y2": (0.0, 0.99 * 200),
            "y3": (-11.0, 11.0),
        },
        u={"Teinc": (-4.95, 4.95), "Fninc": (-7.92, 7.92)},
        **remedy.limits,
    )
    cost = hys.Cost(y=WEIGHTS)
    return hys.HybridMpc(
        model, remedy.horizon, cost, limits, references=tuple(WEIGHTS), node_limit=node_limit, time_limit=SECONDS,
        tolerances=replace(DEFAULT_CONTROL_TOLERANCES, settled=remedy.settled),
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Outcome:
    """One run: its start, where it ended, and its figures.

    Attributes
    ----------
    slip, torque : float
        Of the start.
    failed_at : int or None
        Step at which there was no input.
    missing : float
        By how much the limit would have to give at the state without an input [rad/s]; NaN where that is not known.
    is_proven : bool
        Whether there is proof that no input exists, rather than a search that ended early.
    state : list of float
        Last state of the run.
    cost : float
        Sum of the weighted squares over the run.
    violation : float
        By how much the engine speed fell below the limit of the controller [rad/s].
    least : float
        Least engine speed [rad/s].
    seconds : list of float
        Time of each answer.
    speeds : list of float
        Engine speed over the run.
    """

    slip: float
    torque: float
    failed_at: int | None
    missing: float
    is_proven: bool
    state: list[float]
    cost: float
    violation: float
    least: float
    seconds: list[float]
    speeds: list[float]


def engage(model: hys.Model, mpc: hys.HybridMpc, softened: hys.HybridMpc, slip: float, torque: float) -> Outcome:
    """Run until the clutch sticks or there is no input; the softened controller says what is missing there."""
    start = {"we": ENGINE_SPEED, "gamma": slip, "Te": torque, "Fn": 0.0, "lc": 0.0}
    mpc.reset()
    run = hys.closed_loop(model, mpc, start, STEPS, REFERENCE, stop=lambda _k, x: bool(x[1] <= 1.0))
    failed = run.steps < STEPS and run.x[-1, 1] > 1.0
    last = softened.solve(run.x[-1], REFERENCE, warm=False) if failed else None
    missing = np.nan if last is None or not last.ok else last.slack["y1"]
    is_proven = bool(failed and "infeasible" in run.messages[-1])
    error = run.y - [REFERENCE[name] for name in WEIGHTS]
    least = float(run.x[:, 0].min())
    return Outcome(
        slip, torque, run.steps if failed else None, float(missing), is_proven, run.x[-1].tolist(),
        float((error**2 @ list(WEIGHTS.values())).sum()), max(0.0, LIMIT - least), least,
        run.info["seconds"].tolist(), run.x[:, 0].tolist(),
    )  # fmt: skip


def sweep(model: hys.Model, node_limit: int) -> dict[str, list[Outcome]]:
    """All remedies from all starts."""
    found = {}
    softened = controller(model, next(r for r in remedies() if r.limits.get("soft")), node_limit)
    for remedy in remedies():
        mpc = controller(model, remedy, node_limit)
        found[remedy.name] = [engage(model, mpc, softened, slip, torque) for torque in TORQUES for slip in SLIPS]
        print(f"{remedy.name}: done", file=sys.stderr)
    return found


# ---- text -----------------------------------------------------------------------------------------------------------


def failures(outcomes: list[Outcome]) -> str:
    """The step at which each start fails, as a table over slip and torque."""
    at = {(o.slip, o.torque): o.failed_at for o in outcomes}
    head = "Te [Nm] \\ slip [rad/s] " + "".join(f"{slip:>7g}" for slip in SLIPS)
    rows = (
        f"{torque:>22g} " + "".join(f"{'-' if at[slip, torque] is None else at[slip, torque]:>7}" for slip in SLIPS)
        for torque in TORQUES
    )
    return "\n".join([head, *rows])


def comparison(found: Mapping[str, list[Outcome]]) -> str:
    """The remedies side by side; the cost is compared over the starts from which all of them finish."""
    common = [i for i in range(len(SLIPS) * len(TORQUES)) if all(o[i].failed_at is None for o in found.values())]
    lines = [
        "        controller  finished  fails at      missing  worst below      cost   median      p95    worst",
    ]
    for name, outcomes in found.items():
        ends = [o.failed_at for o in outcomes if o.failed_at is not None]
        ms = 1e3 * np.concatenate([o.seconds for o in outcomes])
        span = f"{min(ends)}..{max(ends)}" if ends else "-"
        missing = [o.missing for o in outcomes if np.isfinite(o.missing)]
        lack = f"{min(missing):.1g}..{max(missing):.1g}" if missing else "-"
        cost = np.mean([outcomes[i].cost for i in common]) if common else np.nan
        lines.append(
            f"{name:>18} {len(outcomes) - len(ends):>4} of {len(outcomes):<2} {span:>8} {lack:>12} "
            f"{max(o.violation for o in outcomes):>12.2g} {cost:>9.4g} {np.median(ms):8.1f} "
            f"{np.percentile(ms, 95):8.1f} {ms.max():8.1f}"
        )
    return "\n".join(
        [
            *lines,
            f"cost: mean over the {len(common)} starts from which all finish; times in ms per step",
            "missing: what the limit would have to give where there is no input; worst below: over runs [rad/s]",
            f"ended by a proof that there is no input: {sum(o.is_proven for rs in found.values() for o in rs)} of "
            f"{sum(o.failed_at is not None for rs in found.values() for o in rs)} runs that ended early",
        ]
    )


def explanation(model: hys.Model, outcome: Outcome, name: str, node_limit: int) -> str:
    """Why a run of the document's controller ended: limits of the last plan, contradiction at the last state."""
    mpc = controller(model, next(r for r in remedies() if r.name == name), node_limit)
    start = {"we": ENGINE_SPEED, "gamma": outcome.slip, "Te": outcome.torque, "Fn": 0.0, "lc": 0.0}
    assert outcome.failed_at is not None
    run = hys.closed_loop(model, mpc, start, outcome.failed_at, REFERENCE)
    before = mpc.solve(run.x[-2], REFERENCE)
    text = [
        f"from slip {outcome.slip:g} rad/s and {outcome.torque:g} Nm: at step {outcome.failed_at - 1} the last plan, "
        "with the prices of what it touches:",
        mpc.why(before).describe().partition("active requirements")[0] if before.ok else before.message,
        "",
        f"at step {outcome.failed_at}:",
        mpc.solve(run.x[-1], REFERENCE).message,
        "",
        str(hys.explain_infeasible(mpc, run.x[-1], seconds=60.0)),
    ]
    return "\n".join(text)


# ---- picture --------------------------------------------------------------------------------------------------------

COLOURS = ("#0072B2", "#56B4E9", "#009E73", "#D55E00", "#CC79A7")


def plot(found: Mapping[str, list[Outcome]], path: str) -> None:
    """A map of the starts for each controller, and the engine speed of all from one start."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 5.6), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(2, len(found))
    for column, (name, outcomes) in enumerate(found.items()):
        _map(figure.add_subplot(grid[0, column]), name, outcomes, COLOURS[column], first=column == 0)
    _speeds(figure.add_subplot(grid[1, :]), found)
    figure.savefig(path)


def _map(axes: Any, name: str, outcomes: list[Outcome], colour: str, *, first: bool) -> None:
    for o in outcomes:
        if o.failed_at is None:
            axes.plot(o.slip, o.torque, "o", color=colour, ms=9)
        else:
            axes.text(o.slip, o.torque, str(o.failed_at), ha="center", va="center", fontsize=8, color="#B22222")
    axes.set(
        xlim=(SLIPS[0] - 12, SLIPS[-1] + 12), ylim=(TORQUES[0] - 12, TORQUES[-1] + 12), xticks=SLIPS, yticks=TORQUES
    )
    axes.set_title(name, fontsize=9)
    axes.set_xlabel("slip at the start [rad/s]", fontsize=8)
    if first:
        axes.set_ylabel("engine torque [Nm]", fontsize=8)
    axes.tick_params(labelsize=7)


def _speeds(axes: Any, found: Mapping[str, list[Outcome]]) -> None:
    for (name, outcomes), colour in zip(found.items(), COLOURS, strict=True):
        shown = next(o for o in outcomes if (o.slip, o.torque) == SHOWN)
        t = 0.01 * np.arange(len(shown.speeds))
        axes.plot(t, shown.speeds, color=colour, lw=1.4, label=name)
        if shown.failed_at is not None:
            axes.plot(t[-1], shown.speeds[-1], "x", color=colour, ms=8, mew=2)
    axes.axhline(LIMIT, color="#B22222", lw=0.8, ls="--", label=f"limit {LIMIT:g} rad/s")
    axes.set_xlabel("time [s]", fontsize=8)
    axes.set_ylabel("engine speed [rad/s]", fontsize=8)
    axes.set_title(
        f"from slip {SHOWN[0]:g} rad/s and {SHOWN[1]:g} Nm. Above: dots reach lock-up, numbers are the step at which "
        "there is no input (crosses below)", fontsize=8, loc="left",
    )  # fmt: skip
    axes.grid(visible=True, color="#dddddd", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8)
    axes.tick_params(labelsize=7)


# ---- program --------------------------------------------------------------------------------------------------------


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--node-limit", type=int, default=20, help="nodes per answer (default 20)")
    parser.add_argument("--json", metavar="FILE", help="write all runs")
    parser.add_argument("--plot", metavar="FILE", help="write the picture")
    parser.add_argument("--no-explanation", action="store_true", help="leave out the explanation of one failure")
    options = parser.parse_args()
    model = hys.load("clutch", we_min=60)
    found = sweep(model, options.node_limit)
    print("step at which there is no input ('-': reaches lock-up)")
    for name in list(found)[:2]:
        print(f"{name}:", failures(found[name]), "", sep="\n")
    print(comparison(found))
    for name in () if options.no_explanation else list(found)[:2]:
        ended = [o for o in found[name] if o.failed_at is not None]
        if ended:
            print("", f"{name}, {explanation(model, ended[-1], name, options.node_limit)}", sep="\n")
    if options.json:
        data = {name: [asdict(o) for o in outcomes] for name, outcomes in found.items()}
        Path(options.json).write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    if options.plot:
        plot(found, options.plot)
    return 0


if __name__ == "__main__":
    sys.exit(main())
