"""What is proven, and what is only tested, about the controllers of the clutch, of the tanks and of the gear shift.

python benchmarks/controller_questions.py            as in docs/reachability.md
python benchmarks/controller_questions.py --quick    without closed loops
python benchmarks/controller_questions.py --runs N   closed loops of the predictive controllers (default 12)

The lock-up law of the clutch is affine with limits and so closes the loop as a model of its own, whose queries are
proven. Predictive controllers have no such form: what is proven of them are premises, of which it follows that there
always is a plan and that a target is reached. Closed loops and random runs have to agree with every proof.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from reach import Batch, draw

import hysdel_py as hys
from hysdel_py.demos.certified_clutch import CERTIFIED_REFERENCE, CERTIFIED_START, certified_clutch_controller
from hysdel_py.demos.clutch import LEAST_ENGINE_SPEED, clutch_controller, engage
from hysdel_py.demos.shifts.cases import SHIFTS, Shift
from hysdel_py.demos.shifts.controllers import BRAKE_RULE, part_of, shift_cost, shift_limits
from hysdel_py.demos.shifts.shift import run_shift
from hysdel_py.demos.shifts.transmission import Transmission
from hysdel_py.shipped import locate

Array = NDArray[np.float64]

STALL = 80.0
STARTS = {"we": (90.0, 110.0), "gamma": (50.0, 80.0), "Te": (10.0, 30.0)}
"""Random starts of the predictive controller, clutch open."""

LAW_AUX = "REAL wanted, rate;  BOOL open, below, above;"
LAW = """
    AD { open = gamma > 0.4;  below = wanted - Fn <= -8;  above = wanted - Fn >= 8; }
    DA { wanted = {IF open THEN (Te*Jv + b*(we - gamma)*Je)/(Je + Jv)/mu + 3/mu ELSE 180};
         rate = {IF below THEN -8 ELSE {IF above THEN 8 ELSE wanted - Fn}}; }
"""
QUERIES = """
    QUERIES {
      NEVER we <= 80 WITHIN 10 FROM %(start)s;
      EVENTUALLY gamma <= 0.2 WITHIN 10 FROM %(start)s;
      EVENTUALLY gamma <= 0.2 WITHIN 3 FROM %(start)s;
    }
"""
COUNT = 100_000
"""Random runs of two steps, and steps along any plans, at least."""
START = (
    "we >= 95 & we <= 110 & gamma >= 0.2 & gamma <= 1 & Te >= 15 & Te <= 25 & Fn >= 30 & Fn <= 45 & lc <= 0 & lc >= 0"
)


def closed_clutch() -> hys.Model:
    """The clutch near lock-up under the law that takes over from the predictive controller.

    The law keeps the engine torque and holds the clutch 3 Nm tighter than sticking needs, or closes it once the slip is
    at most 0.4 rad/s; its force changes by at most 8 N in a sample of 10 ms. The stick window is 0.2 rad/s.
    """
    text = Path(locate("clutch")).read_text(encoding="utf-8")
    begin, end = text.index("    INPUT {"), text.index("    OUTPUT {")
    text = text[:begin] + text[end:]
    text = text.replace("BOOL stick,", LAW_AUX + "\n      BOOL stick,").replace("    AD {", LAW + "    AD {", 1)
    text = text.replace("Te = Te + Teinc;", "Te = Te;").replace("Fn = Fn + Fninc;", "Fn = Fn + rate;")
    closing = text.rstrip().removesuffix("}").rstrip().removesuffix("}")
    front = "/* extension: queries */\n"
    return hys.load(front + closing + QUERIES % {"start": START} + "  }\n}\n", reltol=0.2, we_min=60.0)


def of_law() -> Iterator[str]:
    """Queries of the closed loop, proven or contradicted."""
    yield "lock-up law of the clutch, closed loop, all states of the set:"
    begin = time.process_time()
    for found in hys.answer_queries(closed_clutch(), seconds=200.0):
        asked = found.query.text.partition(" FROM ")[0]
        extra = "" if found.answer.message == "" else f" ({found.answer.message})"
        yield f"  {asked:34} {found.verdict:12} {found.answer.verdict:12}{extra}"
    yield f"  {time.process_time() - begin:.1f} cpu s"


def with_brake_before() -> str:
    """The second part of a gear shift with the brake force of the sample before as a state."""
    text = Path(locate("bist_part2")).read_text(encoding="utf-8")
    text = text.replace("    STATE {", "    STATE {\n      REAL before [0, F_max];", 1)
    return text.replace("    CONTINUOUS {", "    CONTINUOUS {\n      before = Fnb;", 1)


def of_gear_shift() -> Iterator[str]:
    """How hard may the brake hold the flywheel in a sample in which it comes to stand still? Under any inputs."""
    model = hys.load(with_brake_before())
    yield "gear shift, any state in range, any inputs; the brake one sample before the flywheel turns forwards:"
    for force in (5.02, 4.9):
        begin = time.process_time()
        found = hys.can_reach(model, {"before": 0.0}, f"before >= {force} & wf >= 0", 2)
        yield f"  at least {force:<5g} N                    {found.verdict:12} {time.process_time() - begin:8.2f} cpu s"
    yield f"  {braked_reversals(model, COUNT)}"


def braked_reversals(model: hys.Model, count: int) -> str:
    """Random steps near the reversal: how many reverse the flywheel, and the hardest brake among them."""
    rng, batch, lasting, reversals, hardest = np.random.default_rng(2), Batch(model.dha), 0, 0, 0.0
    while lasting < count:
        x = near_reversal(model, count, rng)
        after, seen, alive = batch.step(x, draw(model.dha.u, {"Fnb_rate": (-500.0, -400.0)}, count, rng))
        _, then, goes_on = batch.step(after, draw(model.dha.u, {}, count, rng))
        goes_on &= alive
        reverses = goes_on & (seen["wf"] < 0.0) & (then["wf"] >= 0.0)
        lasting, reversals = lasting + int(goes_on.sum()), reversals + int(reverses.sum())
        hardest = max(hardest, float(then["before"][reverses].max(initial=0.0)))
    assert hardest < 5.02, f"a brake of {hardest} N at the reversal contradicts the proof"
    return f"{lasting} random runs of two steps: {reversals} reverse the flywheel, hardest brake {hardest:.3f} N"


def near_reversal(model: hys.Model, count: int, rng: np.random.Generator) -> dict[str, Array]:
    """States with a flywheel that is about to turn forwards, most of them within the rule for the brake."""
    p = model.parameters
    x = draw(model.dha.x, {"before": 0.0, "Fnb": (0.0, 5.2), "Te": (0.0, 60.0), "dphi": (-0.4, 0.4)}, count, rng)
    x["we"] = rng.uniform(90.0, 600.0, count)
    wheel = rng.uniform(-12.0, 2.0, count)
    x["ws"] = np.clip((wheel + p["z"] * x["we"]) * p["r_gn"] / p["z"], *ends(model, "ws"))
    x["wv"] = np.clip(p["r_d"] * x["ws"] + rng.normal(0.0, 2.0, count), *ends(model, "wv"))
    x["Fnb"] = np.where(wheel <= p["wf_back"], x["Fnb"], np.minimum(x["Fnb"], 0.01))
    return x


def ends(model: hys.Model, name: str) -> tuple[float, float]:
    """Range of a state."""
    return next((v.low, v.high) for v in model.dha.x if v.name == name)


def of_shift_plans() -> Iterator[str]:
    """The same of every plan of the predictive controllers, and of their softened plans."""
    data, text = Transmission(), with_brake_before()
    yield "predictive controllers of the gear shifts, every plan from every state; the brake one sample before the"
    yield "flywheel turns forwards, under the limits that no call changes; second, with softened limits as well:"
    for shift in shifts():
        mpc, words = shift_planner(shift, data, text), []
        begin = time.process_time()
        for force in (5.02, 0.011):
            for softened in (False, True):
                found = hys.plans_never(mpc, f"before >= {force} & wf >= 0", softened=softened)
                words.append(f"{found.verdict:8}")
        seconds = time.process_time() - begin
        said = f"5.02 N or more: never {words[0]} {words[1]}  0.011 N or more: never {words[2]} {words[3]}"
        yield f"  {shift.name:20} {said} {seconds:6.2f} cpu s"


def shifts() -> tuple[Shift, ...]:
    """All shifts of the demonstration."""
    return tuple(SHIFTS.values() if isinstance(SHIFTS, Mapping) else SHIFTS)


def shift_planner(shift: Shift, data: Transmission, text: str) -> hys.HybridMpc:
    """The controller of part 2 with those of its limits that no call replaces."""
    own = shift_limits(shift, 2, data)
    kept = hys.Limits(
        x={name: own.x[name] for name in ("dphi", "we", "ws", "wv")},
        y={name: own.y[name] for name in ("torque", "wf")},
        u=own.u,
    )
    model = hys.load(text, r_new=data.gears[shift.gears[1]], F_max=shift.force, wf_back=BRAKE_RULE)
    return hys.HybridMpc(model, 10, shift_cost(part_of(shift, 2), 2), kept)


def of_shift_loops() -> Iterator[str]:
    """Closed loops of the shifts on their plant, with fallbacks: the brake where the flywheel reverses."""
    yield "closed loops of the shifts on their plant, with fallbacks, tested only:"
    for shift in shifts():
        begin, found = time.process_time(), run_shift(shift)
        force, samples = found.judgement.brake_at_reversal, sum(part.steps for part in found.parts[:2])
        assert force < 5.02, f"a brake of {force} N at the reversal contradicts the proof"
        seconds = time.process_time() - begin
        yield f"  {shift.name:20} {samples:4} samples, brake at the reversal {force:.4f} N {seconds:8.1f} cpu s"


def clutch_model() -> hys.Model:
    """The clutch with engine speeds below its limit, so that the limit is no range."""
    return hys.load("clutch", we_min=60.0)


def of_certificates() -> Iterator[str]:
    """Premises of the predictive controllers of the clutch and of the tanks."""
    model, locked = clutch_model(), "gamma <= 1"
    mpc = certified_clutch_controller(model)
    yield from certified("clutch, plans with an end", mpc, CERTIFIED_START, CERTIFIED_REFERENCE, locked)
    hard = clutch_controller(model, hard=True)
    wanted = {"y1": 100.0, "y2": 0.0, "y3": 0.0}
    yield from certified("clutch, as in the document: hard limits, no end", hard, CERTIFIED_START, wanted, locked)
    yield str(hys.plans_never(hard, f"we < {LEAST_ENGINE_SPEED}"))
    tanks = tanks_controller(hys.load("two_tanks"))
    yield from certified("tanks, plans with an end", tanks, TANKS, LEVEL, "h2 >= 0.25 & h2 <= 0.35")


def certified(
    what: str, mpc: hys.HybridMpc, start: Mapping[str, object], ref: Mapping[str, float], target: str
) -> Iterator[str]:
    """A certificate and what it took."""
    begin = time.process_time()
    found = hys.predictive_certificate(mpc, start, ref=ref, target=target)
    yield f"{what}, {time.process_time() - begin:.2f} cpu s:"
    yield str(found).rstrip()


TANKS = {"h1": (0.1, 0.4), "h2": (0.2, 0.4)}
LEVEL = {"level2": 0.3}
TANK_GAP = (0.3 - 1e-6, 0.3)
"""Levels of the first tank between both sides of its threshold, in which the program of a controller has no point."""


def tanks_controller(model: hys.Model, gap: float = 1e-2) -> hys.HybridMpc:
    """The level of the second tank, with an end of the plans that can be kept with the valve shut."""
    kept = hys.invariant_set(model, {"h1": (0.3, 0.55), "h2": (0.28, 0.32)}, inputs={"valve": 0})
    (piece,) = kept.states.pieces
    end = piece.region.minimal()
    limits = hys.Limits(x={"h1": (0.0, 0.55), "h2": (0.05, 0.5)}, terminal=(end.A, end.b))
    cost = hys.Cost(y={"level2": 100.0}, terminal={})
    return hys.HybridMpc(model, 12, cost, limits, references=("level2",), gap_abs=gap, gap_rel=0.0)


def of_tank_loops(runs: int) -> Iterator[str]:
    """Best plans from random starts."""
    model = hys.load("two_tanks")
    draw_, mpc, steps, latest, least = np.random.default_rng(0), tanks_controller(model), 0, 0, np.inf
    begin = time.process_time()
    for _ in range(runs):
        run = hys.closed_loop(model, mpc, [draw_.uniform(*TANKS["h1"]), draw_.uniform(*TANKS["h2"])], 30, LEVEL)
        assert run.steps == 30, run.messages
        assert run["h1"].max() <= 0.55 + 1e-6
        assert run["h2"].min() >= 0.05 - 1e-6
        outside = (run["h2"][:-2] < 0.25) | (run["h2"][:-2] > 0.35)
        least = min(least, float(-np.diff(run.info["cost"])[outside].max(initial=-np.inf)))
        latest, steps = max(latest, int(np.argmax((run["h2"] >= 0.25) & (run["h2"] <= 0.35)))), steps + run.steps
    yield f"tanks, best plans: {steps} steps from {runs} starts, a plan at each; in the target after {latest} at most;"
    yield f"  the cost falls by {least:.3f} at least along a step outside; {time.process_time() - begin:.0f} cpu s"


def of_any_tank_plans(count: int) -> Iterator[str]:
    """The first plan that is found, for another reference at each step."""
    model, draw_, steps, begin = hys.load("two_tanks"), np.random.default_rng(1), 0, time.process_time()
    mpc, gaps = tanks_controller(model, gap=1e9), 0
    while steps < count:
        x = np.array([draw_.uniform(*TANKS["h1"]), draw_.uniform(*TANKS["h2"])])
        for _ in range(30):
            gaps += TANK_GAP[0] < x[0] < TANK_GAP[1]
            x, steps = after_any_plan(model, mpc, x, {"level2": float(draw_.uniform(0.0, 0.6))}), steps + 1
            assert 0.0 - 1e-6 <= x[0] <= 0.55 + 1e-6
            assert 0.05 - 1e-6 <= x[1] <= 0.5 + 1e-6
    yield f"tanks, any plans: {steps} steps, a plan at each, {gaps} states in the gap of a threshold;"
    yield f"  {time.process_time() - begin:.0f} cpu s"


def after_any_plan(model: hys.Model, mpc: hys.HybridMpc, x: Array, ref: Mapping[str, float]) -> Array:
    """The next state under a plan, which has to exist."""
    move = mpc.solve(x, ref, warm=False)
    assert move.u is not None, f"no plan at {x.tolist()}: {move.message}"
    return model.dha.step(x, move.u, check=False)[0]


def of_any_clutch_plans(count: int) -> Iterator[str]:
    """The same of the certified controller of the clutch, until the clutch sticks."""
    model, draw_, begin = clutch_model(), np.random.default_rng(4), time.process_time()
    mpc, steps, lowest = certified_clutch_controller(model, gap=1e12), 0, np.inf
    while steps < count:
        x = np.array([float(draw_.uniform(*np.broadcast_to(span, 2))) for span in CERTIFIED_START.values()])
        for _ in range(100):
            ref = {"y1": draw_.uniform(40, 150), "y2": 0.0, "y3": 0.0, "gamma": draw_.uniform(-50, 50)}
            x, steps = after_any_plan(model, mpc, x, ref | {"stick": float(draw_.integers(2))}), steps + 1
            lowest = min(lowest, float(x[0]))
            if x[1] <= 1.0 + 1e-6:
                break
    assert lowest >= LEAST_ENGINE_SPEED - 1e-6
    yield f"clutch, any plans: {steps} steps, a plan at each, least engine speed {lowest:.6f} rad/s;"
    yield f"  {time.process_time() - begin:.0f} cpu s"


def of_clutch_loops(runs: int) -> Iterator[str]:
    """Closed loops of the certified controller of the clutch from random starts of its set."""
    model = clutch_model()
    mpc, draw_, begin = certified_clutch_controller(model), np.random.default_rng(3), time.process_time()
    lowest, falls, steps, nodes = np.inf, np.inf, [], 0.0
    for _ in range(runs):
        start = {name: float(draw_.uniform(*np.broadcast_to(span, 2))) for name, span in CERTIFIED_START.items()}
        run = hys.closed_loop(model, mpc, start, 1539, CERTIFIED_REFERENCE, stop=lambda _k, x: bool(x[1] <= 1.0))
        assert run["gamma"][-1] <= 1.0, run.messages
        assert np.all(run.info["status"] == 0), run.messages
        mpc.reset()
        lowest, nodes = min(lowest, float(run["we"][1:].min())), max(nodes, float(run.info["nodes"].max()))
        falls = min(falls, float(-np.diff(run.info["cost"]).max()))
        steps.append(run.steps)
    assert lowest >= LEAST_ENGINE_SPEED - 1e-6
    yield f"clutch, best plans: {sum(steps)} steps from {runs} starts, proven optimal with {nodes:.0f} nodes at most;"
    yield f"  least engine speed {lowest:.6f} rad/s; stuck after {min(steps)} to {max(steps)} steps;"
    yield f"  the cost falls by {falls:.0f} at least along a step; {time.process_time() - begin:.0f} cpu s"


def of_predictive_controller(runs: int) -> Iterator[str]:
    """Closed loops from random starts on a plant that is not the model: tested, not proven."""
    draw_ = np.random.default_rng(0)
    begin, lowest, times, failed = time.process_time(), np.inf, [], 0
    for _ in range(runs):
        start = {name: float(draw_.uniform(*ends_)) for name, ends_ in STARTS.items()} | {"Fn": 0.0, "lc": 0.0}
        found = engage(start=start, node_limit=20)
        lowest = min(lowest, found.least_engine_speed)
        failed += not found.engaged
        times.append(np.nan if found.lockup_time is None else found.lockup_time)
    yield f"predictive controller of the clutch on its plant, {runs} closed loops of 1 s, tested only:"
    yield f"  least engine speed {lowest:.2f} rad/s (stall {STALL:g}, limit {LEAST_ENGINE_SPEED:g})"
    yield f"  not locked: {failed}; locked after {np.nanmin(times):.3f} to {np.nanmax(times):.3f} s"
    yield f"  {time.process_time() - begin:.0f} cpu s"


def parts(runs: int, *, quick: bool) -> Iterator[Iterator[str]]:
    """All answers, in the order of the page."""
    yield of_law()
    yield of_gear_shift()
    yield of_shift_plans()
    yield of_certificates()
    if not quick:
        yield of_clutch_loops(runs)
        yield of_any_clutch_plans(COUNT // 50)
        yield of_tank_loops(runs)
        yield of_any_tank_plans(COUNT // 2)
        yield of_shift_loops()
        yield of_predictive_controller(runs)


def main() -> None:
    """Print all answers."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="without closed loops")
    parser.add_argument("--runs", type=int, default=12, metavar="N", help="closed loops of the predictive controllers")
    given = parser.parse_args()
    for part in parts(given.runs, quick=given.quick):
        for line in part:
            print(line, flush=True)


if __name__ == "__main__":
    main()
