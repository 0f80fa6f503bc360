"""Runs of a Dha from a set of states as mixed-integer rows that grow step by step.

The rows are closed: an event that is false may lie on its threshold. They hold every run of the model, also one that
passes through the gap which the MLD form leaves at a threshold, so that a proof that they have no point is one for the
model. A point of them may lie on the wrong side of a threshold; the simulator decides then.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from hysdel_py.analysis.encoding import OUTWARDS, Distance, Interval, Places, Step, encode_step, ranges_by_definition
from hysdel_py.analysis.hybrid_set import Span, box_of
from hysdel_py.analysis.milp import Milp
from hysdel_py.analysis.monitor import Monitor, Watch, watch
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.dha import AffineEquation, Dha, Event
from hysdel_py.systems.signals import Variable

__all__ = ["Runs", "distance", "start_runs"]


def distance(apart: float) -> Distance:
    """How far an event that is false keeps away from its threshold: nothing, or relative to its coefficients."""

    def band(event: Event) -> float:
        size = max(1.0, abs(event.form.constant), *(abs(c) for _, c in event.form.terms))
        return apart * size

    return band


@dataclass(slots=True)
class Runs:
    """Rows of some steps.

    Attributes
    ----------
    dha : Dha
        With the inputs narrowed to what is allowed.
    apart, target_apart : float
        How far false events keep away from their thresholds, those of the model and those of conditions; zero for
        closed rows.
    problem : Milp
    states, inputs : list of mapping of name to number
    steps : list of Step
    ranges : list of mapping of "vector.name" to interval
        Where the signals of each time can be, by interval arithmetic along the run.
    """

    dha: Dha
    apart: float
    target_apart: float
    problem: Milp = field(default_factory=Milp)
    states: list[Places] = field(default_factory=list)
    inputs: list[Places] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    ranges: list[dict[str, Interval]] = field(default_factory=list)

    def grow(self) -> None:
        """Add a step."""
        k, dha, problem = len(self.steps), self._narrowed(), self.problem
        self.inputs.append(_variables(problem, {v: (v.low, v.high) for v in dha.u}))
        ranges = ranges_by_definition(dha)
        given = {**self.states[k], **self.inputs[k]}
        step = encode_step(problem, dha, given, step=k, band=distance(self.apart), ranges=ranges)
        self.steps.append(step)
        self.states.append(step.next)
        self.ranges[k] |= {f"{w}.{v.name}": ranges[v.name] for w in "udz" for v in getattr(dha, w)}
        self.ranges[k] |= {f"y.{v.name}": _result(dha, v, ranges) for v in dha.y}
        self.ranges.append(
            {f"x.{v.name}": _within(_result(dha, v, ranges), v, dha.tolerances.range) for v in self.dha.x}
        )
        for v in dha.x:
            _bound(problem, step.next[v.name], self.ranges[k + 1][f"x.{v.name}"])

    def _narrowed(self) -> Dha:
        """The model with the ranges that the states have after the steps so far."""
        ranges = self.ranges[-1]
        return replace(
            self.dha,
            x=tuple(replace(v, low=low, high=high) for v in self.dha.x for low, high in [ranges[f"x.{v.name}"]]),
        )

    def watch(self, monitor: Monitor, time: int) -> Watch:
        """Rows of a condition at a time; one that reads more than states needs the step from there."""
        places: dict[str, Places] = {"x": self.states[time]}
        if time < len(self.steps):
            step = self.steps[time]
            places |= {"u": self.inputs[time], "y": step.outputs, "d": step.values, "z": step.values}
        return watch(self.problem, monitor, places, self.ranges[time], time=time, band=distance(self.target_apart))


def start_runs(dha: Dha, box: Mapping[str, Span], inputs: Mapping[str, Span], apart: tuple[float, float]) -> Runs:
    """Runs of no step yet, from a box of states; states and inputs that are not named have their declared range.

    `apart` holds the two distances that :class:`Runs` names.
    """
    allowed = _allowed(inputs, dha.u, "inputs")
    runs = Runs(replace(dha, u=tuple(replace(v, low=low, high=high) for v, (low, high) in allowed.items())), *apart)
    ends = _allowed(box, dha.x, "x0")
    runs.states.append(_variables(runs.problem, ends))
    runs.ranges.append({f"x.{v.name}": interval for v, interval in ends.items()})
    return runs


def _allowed(given: Mapping[str, Span], variables: Sequence[Variable], what: str) -> dict[Variable, Interval]:
    """Intervals that are given, within the declared ranges."""
    found = {}
    for variable, low, high in zip(variables, *box_of(given, variables, what), strict=True):
        own = (0.0, 1.0) if variable.is_bool else (variable.low, variable.high)
        found[variable] = (max(float(low), own[0]), min(float(high), own[1]))
        if found[variable][0] > found[variable][1]:
            raise ArgumentError(
                f"{what}: {variable.name} in [{low:g}, {high:g}] has nothing in common with its range "
                f"[{own[0]:g}, {own[1]:g}]"
            )
    return found


def _variables(problem: Milp, ends: Mapping[Variable, Interval]) -> dict[str, int]:
    places = {}
    for variable, interval in ends.items():
        places[variable.name] = problem.boolean() if variable.is_bool else problem.real(*interval)
        _bound(problem, places[variable.name], interval)
    return places


def _bound(problem: Milp, place: int, interval: Interval) -> None:
    problem.low[place], problem.high[place] = interval


def _result(dha: Dha, variable: Variable, ranges: Mapping[str, Interval]) -> Interval:
    """Where an update or output can be; one that is never defined is zero."""
    definition = dha.definitions.get(variable.name)
    if definition is None:
        return 0.0, 0.0
    if not isinstance(definition, AffineEquation):
        return 0.0, 1.0
    return _widened(definition.value.range(ranges.__getitem__), OUTWARDS)


def _within(interval: Interval, variable: Variable, tolerance: float) -> Interval:
    """Within the declared range; an interval that misses it by no more than the simulator grants is its end."""
    if variable.is_bool:
        return interval
    low, high = max(interval[0], variable.low), min(interval[1], variable.high)
    if low > high and low - high <= tolerance * max(1.0, abs(low)):
        return (variable.low, variable.low) if low == variable.low else (variable.high, variable.high)
    return low, high


def _widened(interval: Interval, share: float) -> Interval:
    low, high = interval
    return low - share * max(1.0, abs(low)), high + share * max(1.0, abs(high))
