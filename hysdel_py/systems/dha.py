"""The discrete hybrid automaton: thresholds, logic, switches and affine equations, with an executable step.

A Dha joins a switched affine system (the switches and affine equations), an event generator (the events), a finite
state machine (the Boolean updates) and a mode selector (the logic equations), after Torrisi and Bemporad, "HYSDEL - a
tool for generating computational hybrid models", IEEE Trans. Control Systems Technology 12, 2004. Its `step` is the
meaning of a model: no big-M constant and no epsilon takes part in it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import SimulationError
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.formula import Formula, Literal
from hysdel_py.systems.origin import Origin
from hysdel_py.systems.signals import Variable, as_vector, range_violations
from hysdel_py.systems.summary import counted, one_line
from hysdel_py.tolerances import DEFAULT_TOLERANCES, Tolerances

if TYPE_CHECKING:
    from hysdel_py.systems.trajectory import Trajectory

__all__ = [
    "AffineEquation", "AffineRequirement", "Dha", "DhaItem", "Event", "LogicEquation", "LogicRequirement", "Switch",
    "read_by",
]  # fmt: skip

Vector = NDArray[np.float64]
Interval = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Event:
    """``name`` is true exactly where ``form <= 0``.

    `limits` is the stated range of the form, if any; `epsilon` is the gap that the MLD form leaves on its false side.
    """

    name: str
    form: Affine
    limits: Interval | None
    epsilon: float
    origin: Origin


@dataclass(frozen=True, slots=True)
class Switch:
    """``name`` is `then` where the condition holds and `otherwise` elsewhere; the limits are stated ranges, if any."""

    name: str
    condition: Literal
    then: Affine
    otherwise: Affine
    then_limits: Interval | None
    otherwise_limits: Interval | None
    origin: Origin

    @property
    def branches(self) -> tuple[tuple[Affine, Interval | None], tuple[Affine, Interval | None]]:
        """Form and stated range where the variable of the condition is 1, and those where it is 0."""
        pair = ((self.then, self.then_limits), (self.otherwise, self.otherwise_limits))
        return pair if self.condition.positive else (pair[1], pair[0])

    def branch(self, values: Mapping[str, float]) -> Affine:
        """The branch that is active."""
        holds = (values[self.condition.name] > 0.5) == self.condition.positive
        return self.then if holds else self.otherwise


@dataclass(frozen=True, slots=True)
class AffineEquation:
    """``name = value``; `item` is ``Linear``, ``Continuous`` or ``Cont_output``."""

    item: str
    name: str
    value: Affine
    origin: Origin


@dataclass(frozen=True, slots=True)
class LogicEquation:
    """``name <-> value``; `item` is ``Logic``, ``Automata`` or ``Logic_output``."""

    item: str
    name: str
    value: Formula
    origin: Origin


@dataclass(frozen=True, slots=True)
class AffineRequirement:
    """``value <= 0`` has to hold."""

    value: Affine
    origin: Origin


@dataclass(frozen=True, slots=True)
class LogicRequirement:
    """`value` has to be true."""

    value: Formula
    origin: Origin


Definition = Event | Switch | AffineEquation | LogicEquation
DhaItem = Definition | AffineRequirement | LogicRequirement


@dataclass(frozen=True, eq=False, repr=False)
class Dha:
    """A discrete hybrid automaton.

    Attributes
    ----------
    name : str
    x, u, y, d, z : tuple of Variable
        Reals before Booleans in x, u and y; declared before generated ones in d and z.
    items : tuple of DhaItem
        Items in file order, then the generated definitions in the order of their creation.
    source : str
        Name of the source file.
    default_bound : float
        What bounds, in absolute value, a variable whose range the MLD form needs and nothing gives; infinite for none.
        The step does not look at it.
    """

    name: str
    x: tuple[Variable, ...]
    u: tuple[Variable, ...]
    y: tuple[Variable, ...]
    d: tuple[Variable, ...]
    z: tuple[Variable, ...]
    items: tuple[DhaItem, ...]
    source: str = ""
    tolerances: Tolerances = field(default=DEFAULT_TOLERANCES)
    default_bound: float = inf

    def __repr__(self) -> str:
        return one_line(self, counted(len(self.items), "item"))

    @cached_property
    def definitions(self) -> Mapping[str, Definition]:
        """What defines each auxiliary variable, updated state and output."""
        return {item.name: item for item in self.items if not isinstance(item, AffineRequirement | LogicRequirement)}

    @cached_property
    def requirements(self) -> tuple[AffineRequirement | LogicRequirement, ...]:
        """What has to hold in every step."""
        return tuple(item for item in self.items if isinstance(item, AffineRequirement | LogicRequirement))

    @property
    def algebraic_loop(self) -> tuple[str, ...]:
        """Auxiliaries that are defined in a circle, the first repeated at the end; empty if there is no circle."""
        return self._order_or_loop[1]

    @property
    def evaluation_order(self) -> tuple[str, ...]:
        """Auxiliaries such that each comes after all it depends on; empty where an algebraic loop forbids that."""
        return self._order_or_loop[0]

    @cached_property
    def _order_or_loop(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Auxiliaries such that each comes after all it depends on, or else a circle of them."""
        auxiliaries = {v.name for v in (*self.d, *self.z)}
        graph = {
            name: [n for n in read_by(self.definitions[name]) if n in auxiliaries]
            for name in auxiliaries
            if name in self.definitions
        }
        order = TopologicalSorter({name: graph.get(name, []) for name in (v.name for v in (*self.d, *self.z))})
        try:
            return tuple(order.static_order()), ()
        except CycleError as error:
            return (), tuple(reversed(error.args[1]))

    def step(
        self, x: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] = (), *, check: bool = True
    ) -> tuple[Vector, Vector, Vector, Vector]:
        """One step of the system.

        Parameters
        ----------
        x : array_like of shape (nx,) or mapping
            State; Booleans are 0 or 1.
        u : array_like of shape (nu,) or mapping
            Input.
        check : bool
            Whether states and inputs outside their ranges and violated requirements are errors. Ranges of auxiliaries
            and stated [min, max] are promises for the big-M constants and are not part of the meaning.

        Returns
        -------
        x1, y, d, z : arrays
            Next state, output and auxiliaries.

        Raises
        ------
        ArgumentError
            Wrong dimension, name, type or a value that is not finite.
        SimulationError
            Out of range, requirement violated, auxiliary undefined or in a loop without a unique solution; names every
            fault.
        """
        state, control = as_vector(x, self.x, "state"), as_vector(u, self.u, "input")
        values = self._auxiliaries(state, control)
        d, z = _gather(values, self.d), _gather(values, self.z)
        if check:
            problems = self._problems(state, control, values)
            if problems:
                raise SimulationError(problems)
        x1 = np.array([self._equation_value(v.name, values) for v in self.x])
        y = np.array([self._equation_value(v.name, values) for v in self.y])
        return x1, y, d, z

    def _auxiliaries(self, x: Vector, u: Vector) -> dict[str, float]:
        """Values of all variables that the step reads."""
        if self.undefined_but_used:
            raise SimulationError(
                tuple(f"the auxiliary variable {name} is used but never defined" for name in self.undefined_but_used)
            )
        order, loop = self._order_or_loop
        values = {v.name: float(value) for v, value in zip((*self.x, *self.u), (*x, *u), strict=True)}
        if loop:
            return self._settle_loops(values)
        for name in order:
            values[name] = self._equation_value(name, values)
        return values

    def _settle_loops(self, values: dict[str, float]) -> dict[str, float]:
        from hysdel_py.systems.loops import settle_loops

        booleans = {v.name for v in self.d}
        auxiliaries = booleans | {v.name for v in self.z}
        needs = {
            v.name: tuple(n for n in read_by(self.definitions[v.name]) if n in auxiliaries)
            if v.name in self.definitions
            else ()
            for v in (*self.d, *self.z)
        }
        return settle_loops(needs, booleans.__contains__, self._equation_value, self._active_form, values)

    def _active_form(self, name: str, values: Mapping[str, float]) -> Affine:
        definition = self.definitions[name]
        if isinstance(definition, Switch):
            return definition.branch(values)
        return definition.value if isinstance(definition, AffineEquation) else Affine()

    @cached_property
    def undefined_but_used(self) -> tuple[str, ...]:
        """Auxiliaries that something reads and nothing defines; a step is not defined then."""
        used = {name for item in self.items for name in read_by(item)}
        return tuple(v.name for v in (*self.d, *self.z) if v.name in used and v.name not in self.definitions)

    def _equation_value(self, name: str, values: Mapping[str, float]) -> float:
        """Value of an update or output; one that is never defined is zero, as in the MLD form."""
        definition = self.definitions.get(name)
        return 0.0 if definition is None else _evaluate(definition, values)

    def _problems(self, x: Vector, u: Vector, values: Mapping[str, float]) -> tuple[str, ...]:
        tolerance = self.tolerances.range
        return (
            *range_violations(x, self.x, "state", tolerance),
            *range_violations(u, self.u, "input", tolerance),
            *(f"MUST is violated in {r.origin}" for r in self.requirements if not self._holds(r, values)),
        )

    def _holds(self, requirement: AffineRequirement | LogicRequirement, values: Mapping[str, float]) -> bool:
        if isinstance(requirement, LogicRequirement):
            return requirement.value.value(values)
        size = abs(requirement.value.constant) + sum(abs(c * values[n]) for n, c in requirement.value.terms)
        return requirement.value.value(values) <= self.tolerances.row + self.tolerances.rounding * size

    def describe(self) -> str:
        """Text with one line per variable group and item."""
        from hysdel_py.systems.describe import describe_dha

        return describe_dha(self)

    def simulate(
        self, x0: ArrayLike | Mapping[str, float], inputs: ArrayLike, *, ts: float = 1.0, check: bool = True
    ) -> Trajectory:
        """Run from a state under a sequence of inputs; see :func:`hysdel_py.systems.simulation.simulate`."""
        from hysdel_py.systems.simulation import simulate

        return simulate(self, x0, inputs, ts=ts, check=check)


def read_by(item: DhaItem) -> tuple[str, ...]:
    """Variables on the right side of an item."""
    match item:
        case Event(form=form):
            return tuple(name for name, _ in form.terms)
        case Switch(condition=condition, then=then, otherwise=otherwise):
            return (condition.name, *(name for name, _ in (*then.terms, *otherwise.terms)))
        case AffineEquation(value=form) | AffineRequirement(value=form):
            return tuple(name for name, _ in form.terms)
        case LogicEquation(value=formula) | LogicRequirement(value=formula):
            return formula.names


def _evaluate(definition: Definition, values: Mapping[str, float]) -> float:
    match definition:
        case Event(form=form):
            return float(form.value(values) <= 0.0)
        case Switch():
            return definition.branch(values).value(values)
        case AffineEquation(value=value):
            return value.value(values)
        case LogicEquation(value=formula):
            return float(formula.value(values))


def _gather(values: Mapping[str, float], variables: tuple[Variable, ...]) -> Vector:
    return np.array([values[v.name] for v in variables], dtype=float)
