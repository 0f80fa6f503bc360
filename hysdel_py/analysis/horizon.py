"""Several steps of a Dha in a row as mixed-integer rows, gathered into members that can be left out.

A member is a source item at a step, one value of the first state, a given input at a step, or a limit at a time. The
declared ranges are bounds of the variables; each finite end can be left out as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from math import isfinite

from hysdel_py.analysis.encoding import Places, Step, encode_step, shared_variables
from hysdel_py.analysis.milp import Milp, Source
from hysdel_py.analysis.room import with_room
from hysdel_py.systems.dha import AffineRequirement, Dha, Event, LogicRequirement
from hysdel_py.systems.origin import Origin
from hysdel_py.systems.signals import Variable

__all__ = ["Demand", "End", "Horizon", "Member", "MemberKind", "build_horizon"]

Interval = tuple[float, float]
Key = tuple[object, ...]


class MemberKind(Enum):
    """What a member is."""

    START = "x(0)"
    INPUT = "given input"
    REQUIREMENT = "MUST"
    LIMIT = "limit"
    DEFINITION = "definition"


@dataclass(frozen=True, slots=True)
class Demand:
    """A limit beside the model: ``low <= sum of coefficient * signal <= high`` at some times.

    Attributes
    ----------
    what : str
        In words, as in ``level <= 0.8``.
    vector : str
        ``"x"``, ``"y"`` or ``"u"``.
    terms : tuple of (name, coefficient)
    low, high : float
    times : tuple of int
    """

    what: str
    vector: str
    terms: tuple[tuple[str, float], ...]
    low: float
    high: float
    times: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Member:
    """What can be left out of the problem.

    Attributes
    ----------
    kind : MemberKind
    step : int
    name : str
        The variable that is defined or given, or the words of a limit; empty for a requirement.
    value : float
        Of the first state or a given input.
    origin : Origin or None
    numeric : bool
        Whether it can give by an amount: not so for logic and definitions.
    """

    kind: MemberKind
    step: int
    name: str = ""
    value: float = 0.0
    origin: Origin | None = None
    numeric: bool = True


@dataclass(frozen=True, slots=True)
class End:
    """One end of the range of a variable at a time.

    `derived` says that nobody declared it: it follows from the definition of an auxiliary and is wider than that.
    """

    place: int
    variable: Variable
    step: int
    is_high: bool
    value: float
    derived: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class Horizon:
    """N steps in a row.

    Attributes
    ----------
    problem : Milp
    steps : tuple of Step
    states, inputs : tuple of mapping of name to number
        Where the states of the times 0 to N and the inputs of the steps 0 to N-1 are.
    members : tuple of Member
        By time.
    rows : tuple of tuple of int
        Numbers of the rows of each member; all other rows always hold.
    ends : tuple of End
        By time.
    """

    problem: Milp
    steps: tuple[Step, ...]
    states: tuple[Places, ...]
    inputs: tuple[Places, ...]
    members: tuple[Member, ...]
    rows: tuple[tuple[int, ...], ...]
    ends: tuple[End, ...]


def build_horizon(
    dha: Dha,
    steps: int,
    start: Mapping[str, float],
    inputs: Mapping[str, Sequence[float]] | None = None,
    demands: Sequence[Demand] = (),
    *,
    keep_auxiliaries: bool = False,
    apart: float = 0.0,
) -> Horizon:
    """Write down N steps.

    Parameters
    ----------
    dha, steps : Dha, int
    start : mapping of name to number
        The first state.
    inputs : mapping of name to N numbers, optional
        Inputs that are given.
    demands : sequence of Demand
    keep_auxiliaries : bool
        Whether the declared ranges of auxiliaries must hold, as they must in the program of a controller.
    apart : float
        How far an event that is false is from its threshold, relative to the size of its rows; at least epsilon.

    Raises
    ------
    ArgumentError
        If a variable that needs a finite range has none.
    """
    builder = _Builder(dha, keep_auxiliaries, apart)
    logical = {v.name for v in dha.x if v.is_bool}
    for name, value in start.items():
        builder.fix(builder.states[0][name], Member(MemberKind.START, 0, name, value, numeric=name not in logical))
    for k in range(steps):
        builder.step(k)
        for name, values in (inputs or {}).items():
            builder.fix(builder.inputs[k][name], Member(MemberKind.INPUT, k, name, values[k]))
    for demand in demands:
        for time in demand.times:
            builder.demand(demand, time)
    return builder.horizon()


class _Builder:
    """Collects the rows of the steps and who they belong to."""

    def __init__(self, dha: Dha, keep_auxiliaries: bool, apart: float) -> None:
        self._dha = dha
        self._ranges = with_room(dha)
        self._problem = Milp()
        self._members: dict[Key, Member] = {}
        self._rows: dict[Key, list[int]] = {}
        self._ends: list[End] = []
        self._keep_auxiliaries = keep_auxiliaries
        self._apart = apart
        self._items = {_item_key(item.origin): item for item in reversed(dha.items)}
        self._steps: list[Step] = []
        self.states: list[Places] = [shared_variables(self._problem, dha.x)]
        self.inputs: list[Places] = []
        self._note_ends(dha.x, self.states[0], 0)

    def step(self, k: int) -> None:
        dha, problem = self._dha, self._problem
        self.inputs.append(shared_variables(problem, dha.u))
        self._note_ends(dha.u, self.inputs[k], k)
        first = len(problem.rows)
        given = {**self.states[k], **self.inputs[k]}
        step = encode_step(problem, dha, given, step=k, band=self._band, ranges=self._ranges)
        for number in range(first, len(problem.rows)):
            self._claim(number)
        self._steps.append(step)
        self.states.append(step.next)
        for variable in dha.x:
            _bound(problem, step.next[variable.name], (variable.low, variable.high))
        self._note_ends(dha.x, step.next, k + 1)
        self._note_auxiliaries(step, k)

    def _band(self, event: Event) -> float:
        """Relative to the greatest coefficient of its row, as the tolerance of the solver is."""
        low, _ = event.form.range(self._ranges.__getitem__)
        size = max(1.0, abs(low), *(abs(c) for _, c in event.form.terms)) if isfinite(low) else 1.0
        return max(event.epsilon, self._apart * size)

    def _claim(self, number: int) -> None:
        """Give a row of a step to the item that it comes from."""
        source = self._problem.rows[number].source
        if source is None or source.origin is None:
            return
        key = (_item_key(source.origin), source.step)
        if key not in self._members:
            self._members[key] = self._item_member(source.origin, source.step)
        self._rows.setdefault(key, []).append(number)

    def _item_member(self, origin: Origin, step: int) -> Member:
        item = self._items[_item_key(origin)]
        if isinstance(item, AffineRequirement | LogicRequirement):
            return Member(MemberKind.REQUIREMENT, step, origin=origin, numeric=isinstance(item, AffineRequirement))
        return Member(MemberKind.DEFINITION, step, item.name, origin=origin, numeric=False)

    def fix(self, place: int, member: Member) -> None:
        self._add({place: 1.0}, member.value, member.value, member)

    def demand(self, demand: Demand, time: int) -> None:
        places = self._places(demand.vector, time)
        terms = {places[name]: coefficient for name, coefficient in demand.terms}
        self._add(terms, demand.low, demand.high, Member(MemberKind.LIMIT, time, demand.what))

    def _places(self, vector: str, time: int) -> Places:
        return {"x": self.states, "u": self.inputs, "y": [s.outputs for s in self._steps]}[vector][time]

    def _add(self, terms: Mapping[int, float], low: float, high: float, member: Member) -> None:
        key = _key(member)
        self._members[key] = member
        self._rows.setdefault(key, []).append(len(self._problem.rows))
        self._problem.row(terms, low, high, Source(None, member.step, member.name))

    def _note_ends(self, variables: tuple[Variable, ...], places: Places, step: int, *, derived: bool = False) -> None:
        for variable in variables:
            if not variable.is_bool:
                place = places[variable.name]
                low, high = self._problem.low[place], self._problem.high[place]
                self._ends += [
                    End(place, variable, step, is_high, value, derived)
                    for is_high, value in ((False, low), (True, high))
                    if isfinite(value)
                ]

    def _note_auxiliaries(self, step: Step, k: int) -> None:
        for variable in self._dha.z:
            declared = self._keep_auxiliaries and not variable.generated
            if declared and (isfinite(variable.low) or isfinite(variable.high)):
                _bound(self._problem, step.values[variable.name], (variable.low, variable.high))
                self._note_ends((variable,), step.values, k)
            else:
                self._note_ends((variable,), step.values, k, derived=True)

    def horizon(self) -> Horizon:
        order = sorted(self._members, key=lambda key: _when(self._members[key]))
        return Horizon(
            self._problem,
            tuple(self._steps),
            tuple(self.states),
            tuple(self.inputs),
            tuple(self._members[key] for key in order),
            tuple(tuple(self._rows[key]) for key in order),
            tuple(sorted(self._ends, key=lambda end: end.step)),
        )


def _when(member: Member) -> tuple[int, bool]:
    """By step, what is given first."""
    return (member.step, member.kind not in (MemberKind.START, MemberKind.INPUT))


def _key(member: Member) -> Key:
    return (member.kind, member.name, member.step)


def _item_key(origin: Origin) -> Key:
    """What the source item and all that it generated have in common."""
    return (origin.group, origin.start, origin.text)


def _bound(problem: Milp, place: int, interval: Interval) -> None:
    problem.low[place] = max(problem.low[place], interval[0])
    problem.high[place] = min(problem.high[place], interval[1])
