"""Conditions on the signals of a model at one time, written as a small Dha whose inputs are these signals.

A condition comes from the language, from intervals or from a set of states; either way it is a Dha with one Boolean
auxiliary that tells whether it holds. The rows of a search and the check of its answer are then those of the Dha.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

from hysdel_py.analysis.encoding import (
    Distance,
    Places,
    Ranges,
    auxiliary_variables,
    encode_items,
    ranges_by_definition,
)
from hysdel_py.analysis.hybrid_set import HybridSet, Span, box_of
from hysdel_py.analysis.milp import Milp
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import Dha, DhaItem, Event, LogicEquation
from hysdel_py.systems.formula import Connective, Formula
from hysdel_py.systems.origin import Origin
from hysdel_py.systems.signals import Kind, Type, Variable

__all__ = [
    "RESULT", "Monitor", "Signal", "Watch", "monitor_of_intervals", "monitor_of_rows", "monitor_of_set", "signals_of",
    "watch",
]  # fmt: skip

RESULT = "condition_holds"
"""The auxiliary that tells whether a condition holds."""


@dataclass(frozen=True, slots=True)
class Signal:
    """A variable of a model and the letter of its vector."""

    vector: str
    variable: Variable


@dataclass(frozen=True, eq=False, slots=True)
class Monitor:
    """A condition at one time.

    Attributes
    ----------
    text : str
        In words, for messages.
    signals : mapping of name to Signal
        What stands behind the inputs of the Dha.
    dha : Dha
        Without states; its auxiliary ``condition_holds`` is the condition.
    """

    text: str
    signals: Mapping[str, Signal]
    dha: Dha

    @property
    def needs_step(self) -> bool:
        """Whether something but states is read, so that the state after the last step cannot be judged."""
        return any(signal.vector != "x" for signal in self.signals.values())

    @property
    def events(self) -> tuple[Event, ...]:
        """Its thresholds."""
        return tuple(item for item in self.dha.items if isinstance(item, Event))

    def holds(self, value_of: Callable[[str, str], float]) -> bool:
        """Whether it holds where ``value_of(vector, name)`` is the value of a signal."""
        return self.values(value_of)[RESULT] > 0.5

    def values(self, value_of: Callable[[str, str], float]) -> dict[str, float]:
        """Values of the inputs and auxiliaries of the condition."""
        given = {name: value_of(s.vector, s.variable.name) for name, s in self.signals.items()}
        _, _, d, z = self.dha.step((), given, check=False)
        found = zip((*self.dha.d, *self.dha.z), (*d, *z), strict=True)
        return given | {v.name: float(value) for v, value in found}


@dataclass(frozen=True, slots=True)
class Watch:
    """Where a condition at one time is in a problem."""

    monitor: Monitor
    time: int
    places: Places

    @property
    def result(self) -> int:
        """The variable that is 1 where the condition holds."""
        return self.places[RESULT]


def watch(
    problem: Milp, monitor: Monitor, places: Mapping[str, Places], ranges: Ranges, *, time: int, band: Distance
) -> Watch:
    """Add the rows of a condition.

    Parameters
    ----------
    problem : Milp
    monitor : Monitor
    places : mapping of vector to mapping of name to number
    ranges : mapping of "vector.name" to interval
    time : int
    band : callable
        How far a threshold that is false keeps away.
    """
    given = {name: places[s.vector][s.variable.name] for name, s in monitor.signals.items()}
    own = ranges_by_definition(monitor.dha)
    own |= {name: ranges[f"{s.vector}.{s.variable.name}"] for name, s in monitor.signals.items()}
    values = {**given, **auxiliary_variables(problem, (*monitor.dha.d, *monitor.dha.z), own)}
    encode_items(problem, monitor.dha.items, values, own, step=time, band=band)
    return Watch(monitor, time, values)


def signals_of(dha: Dha) -> dict[str, Signal]:
    """Signals by the names of the source; a name of several stands for the state first, then the output."""
    found: dict[str, Signal] = {}
    for vector in ("x", "y", "u", "d", "z"):
        for variable in getattr(dha, vector):
            if not variable.generated:
                found.setdefault(variable.name, Signal(vector, variable))
    return found


def monitor_of_intervals(given: Mapping[str, Span], dha: Dha, what: str) -> Monitor:
    """The condition that each named signal lies in its interval."""
    signals = signals_of(dha)
    chosen = {name: signals[name] for name in given if name in signals}
    low, high = box_of(given, [s.variable for s in signals.values()], what)
    ends = dict(zip(signals, zip(low, high, strict=True), strict=True))
    rows = [row for name in chosen for row in _interval(name, *ends[name])]
    text = " & ".join(_spoken(name, *ends[name]) for name in chosen) or "any state"
    return monitor_of_rows(text, chosen, [rows])


def monitor_of_set(states: HybridSet, what: str) -> Monitor:
    """The condition that the state lies in a set."""
    signals = {v.name: Signal("x", v) for v in states.x}
    reals = [v.name for v in states.x if not v.is_bool]
    booleans = [v.name for v in states.x if v.is_bool]
    pieces = []
    for piece in states.pieces:
        rows = [Affine(-float(b), tuple((n, float(c)) for n, c in zip(reals, a, strict=True) if c))
                for a, b in zip(piece.region.A, piece.region.b, strict=True)]  # fmt: skip
        rows += [row for name, value in zip(booleans, piece.word, strict=True) for row in _interval(name, value, value)]
        pieces.append(rows)
    return monitor_of_rows(what, signals, pieces)


def _interval(name: str, low: float, high: float) -> list[Affine]:
    rows = [Affine(-float(high), ((name, 1.0),))] if isfinite(high) else []
    return [*rows, Affine(float(low), ((name, -1.0),))] if isfinite(low) else rows


def _spoken(name: str, low: float, high: float) -> str:
    return f"{name} = {low:g}" if low == high else f"{low:g} <= {name} <= {high:g}"


def monitor_of_rows(text: str, signals: Mapping[str, Signal], pieces: Sequence[Sequence[Affine]]) -> Monitor:
    """At least one piece holds; a piece holds where all its forms are at most zero."""
    events: list[DhaItem] = []
    postfix: list[str | bool | Connective] = [False]
    for rows in pieces:
        postfix.append(True)
        for form in rows:
            events.append(Event(f"__row_{len(events)}", form, None, 0.0, Origin()))
            postfix += [events[-1].name, Connective.AND]  # type: ignore[union-attr]
        postfix.append(Connective.OR)
    result = LogicEquation("Logic", RESULT, Formula(tuple(postfix)), Origin())
    inputs = tuple(Variable(name, s.variable.type, Kind.INPUT) for name, s in signals.items())
    names = [*(f"__row_{i}" for i in range(len(events))), RESULT]
    auxiliaries = tuple(Variable(name, Type.BOOL, Kind.BOOLEAN_AUX) for name in names)
    if not text:
        raise ArgumentError("a condition was expected, found nothing")
    return Monitor(text, signals, Dha("condition", (), inputs, (), auxiliaries, (), (*events, result)))
