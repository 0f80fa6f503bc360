"""Reachable sets and searches for runs: what they cost, that they agree, and that random runs do not contradict them.

python benchmarks/reach.py            all tables, as in docs/reachability.md
python benchmarks/reach.py --quick    fewer runs and steps
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

import hysdel_py as hys
from hysdel_py.systems.dha import AffineEquation, Dha, Event, LogicEquation, LogicRequirement, Switch
from hysdel_py.systems.formula import Connective

Array = NDArray[np.float64]
Values = dict[str, Array]

TANKS = {"h1": (0.0, 0.2), "h2": (0.0, 0.2)}
CLUTCH = {"we": (95.0, 105.0), "gamma": (60.0, 80.0), "Te": (15.0, 25.0), "Fn": (0.0, 10.0), "lc": 0.0}

QUESTIONS = (
    ("two_tanks", {}, TANKS, "h1 >= 0.55 & h2 <= 0.05", 12),
    ("two_tanks", {}, TANKS, "h2 >= 0.5 & h1 <= 0.2", 12),
    ("two_tanks", {}, TANKS, "h2 >= 0.45", 10),
    ("clutch", {"we_min": 60.0}, CLUTCH, "we <= 80", 4),
    ("clutch", {"we_min": 60.0}, CLUTCH, "we <= 80", 20),
    ("clutch", {"we_min": 60.0}, CLUTCH, "gamma <= 1", 6),
)
"""Model, parameters, first states, condition, steps."""


class Batch:
    """Many runs of a Dha at once, written apart from its step."""

    def __init__(self, dha: Dha) -> None:
        self._dha = dha

    def step(self, x: Values, u: Values) -> tuple[Values, Values, Array]:
        """Next states, all signals, and which of the runs go on."""
        dha = self._dha
        values = {**x, **u}
        for name in dha.evaluation_order:
            values[name] = self._value(name, values)
        alive = np.ones(len(next(iter(x.values()))), dtype=bool)
        for v in (*dha.x, *dha.u):
            alive &= (values[v.name] >= v.low - 1e-9) & (values[v.name] <= v.high + 1e-9)
        for item in dha.requirements:
            alive &= (
                _truth(item.value, values) > 0.5
                if isinstance(item, LogicRequirement)
                else _form(item.value, values) <= 1e-9
            )
        after = {v.name: self._value(v.name, values) for v in dha.x}
        return after, values | {v.name: self._value(v.name, values) for v in dha.y}, alive

    def _value(self, name: str, values: Values) -> Array:
        match self._dha.definitions[name]:
            case Event(form=form):
                return (_form(form, values) <= 0.0).astype(float)
            case Switch() as switch:
                holds = (values[switch.condition.name] > 0.5) == switch.condition.positive
                return np.where(holds, _form(switch.then, values), _form(switch.otherwise, values))
            case AffineEquation(value=form):
                return _form(form, values)
            case LogicEquation(value=formula):
                return _truth(formula, values)
        raise AssertionError(name)


def _form(form, values: Values) -> Array:
    total = np.full(len(next(iter(values.values()))), form.constant)
    for name, coefficient in form.terms:
        total = total + coefficient * values[name]
    return total


def _truth(formula, values: Values) -> Array:
    stack: list[NDArray[np.bool_]] = []
    count = len(next(iter(values.values())))
    for entry in formula.postfix:
        match entry:
            case str():
                stack.append(values[entry] > 0.5)
            case bool():
                stack.append(np.full(count, entry))
            case Connective.NOT:
                stack.append(~stack.pop())
            case _:
                right, left = stack.pop(), stack.pop()
                stack.append(_combined(entry, left, right))
    return stack[0].astype(float)


def _combined(connective: Connective, left: NDArray[np.bool_], right: NDArray[np.bool_]) -> NDArray[np.bool_]:
    match connective:
        case Connective.AND:
            return left & right
        case Connective.OR:
            return left | right
        case Connective.IMPLIES:
            return ~left | right
        case Connective.IMPLIED_BY:
            return left | ~right
        case _:
            return left == right


def draw(variables, spans: Mapping[str, object], count: int, rng: np.random.Generator) -> Values:
    """Random values, a third of them at the ends of their intervals, where extremes are."""
    found = {}
    for v in variables:
        low, high = np.broadcast_to(spans.get(v.name, (v.low, v.high)), 2)
        if v.is_bool:
            found[v.name] = rng.integers(0, 2, count).astype(float)
        else:
            found[v.name] = np.clip(rng.uniform(low - (high - low) / 4, high + (high - low) / 4, count), low, high)
    return found


def hits(model: hys.Model, x0, condition: str, steps: int, count: int) -> tuple[int, int]:
    """How many of the random runs meet a condition over states; second, how many last to the end."""
    from hysdel_py.reports.condition import condition_of

    monitor, batch, rng = condition_of(condition, model, "target"), Batch(model.dha), np.random.default_rng(0)
    inner = Batch(monitor.dha)
    x, alive, met = draw(model.dha.x, x0, count, rng), np.ones(count, dtype=bool), np.zeros(count, dtype=bool)
    for k in range(steps + 1):
        inside = np.ones(count, dtype=bool)
        for v in model.dha.x:
            inside &= (x[v.name] >= v.low - 1e-9) & (x[v.name] <= v.high + 1e-9)
        alive &= inside
        given = {name: x[signal.variable.name] for name, signal in monitor.signals.items()}
        for name in monitor.dha.evaluation_order:
            given[name] = inner._value(name, given)
        met |= alive & (given["condition_holds"] > 0.5)
        if k < steps:
            x, _, goes_on = batch.step(x, draw(model.dha.u, {}, count, rng))
            alive &= goes_on
    return int(met.sum()), int(alive.sum())


def questions(runs: int, quick: bool) -> Iterator[str]:
    head = f"{'model':10} {'condition':26} {'steps':>5} {'answer':>12} {'at':>3} {'cpu s':>6}"
    yield f"{head} {'met by':>8} of {runs} runs, lasting"
    for name, parameters, x0, condition, steps in QUESTIONS:
        model = hys.load(name, **parameters)
        most = min(steps, 4) if quick else steps
        begin = time.process_time()
        answer = hys.can_reach(model, x0, condition, most)
        seconds = time.process_time() - begin
        met, lasting = hits(model, x0, condition, most, runs)
        if answer.verdict == "unreachable":
            assert met == 0, f"{name}: {condition} is said to be unreachable, and {met} runs meet it"
        if answer.run is not None:
            again = model.simulate(answer.run.x[0], answer.run.u) if answer.run.steps else answer.run
            assert np.array_equal(again.x, answer.run.x)
        at = "-" if answer.time is None else answer.time
        line = f"{name:10} {condition:26} {most:5} {answer.verdict:>12} {at:>3} {seconds:6.2f}"
        yield f"{line} {met:8} {lasting:>10}"


def sets(steps: int, runs: int) -> Iterator[str]:
    """Cost of the three kinds of sets, and the share of their states that random runs leave."""
    yield f"{'sets':9} {'steps':>5} {'pieces':>6} {'cpu s':>7}   range of h1 and h2 after the last step"
    model = hys.load("two_tanks")
    x0 = {"h1": (0.1, 0.2), "h2": 0.3}
    for kind in ("exact", "octagons", "boxes"):
        begin = time.process_time()
        found = hys.reach(model, x0, steps, sets=kind)
        seconds = time.process_time() - begin
        outside = left_outside(model, found, x0, runs)
        assert outside == 0, f"{outside} random states lie outside the {kind} sets"
        ranges = "  ".join(f"[{low:.4f}, {high:.4f}]" for low, high in found.sets[-1].ranges().values())
        yield f"{kind:9} {steps:5} {len(found.sets[-1].pieces):6} {seconds:7.2f}   {ranges}"
    yield f"{runs} random runs stay in all of these sets"


def left_outside(model: hys.Model, found: hys.Reach, x0, runs: int) -> int:
    batch, rng = Batch(model.dha), np.random.default_rng(1)
    x, alive, outside = draw(model.dha.x, x0, runs, rng), np.ones(runs, dtype=bool), 0
    for states in found.sets[1:]:
        x, _, goes_on = batch.step(x, draw(model.dha.u, {}, runs, rng))
        for v in model.dha.x:
            goes_on &= (x[v.name] >= v.low) & (x[v.name] <= v.high)
        alive &= goes_on
        points = np.column_stack([x[v.name] for v in model.dha.x])
        inside = np.zeros(runs, dtype=bool)
        for piece in states.pieces:
            inside |= np.all(points @ piece.region.A.T <= piece.region.b + 1e-7, axis=1)
        outside += int(np.sum(alive & ~inside))
    return outside


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="fewer runs and steps")
    options = parser.parse_args()
    runs = 2000 if options.quick else 100_000
    for table in (questions(runs, options.quick), sets(3 if options.quick else 6, runs)):
        for line in table:
            print(line, flush=True)
        print()


if __name__ == "__main__":
    main()
