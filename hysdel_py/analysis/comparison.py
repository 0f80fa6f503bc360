"""The questions whose answers show that a Dha and an Mld are the same, each settled by proof or by a witness.

Each is asked over the definitions it concerns alone first, with everything else free in its range: what cannot happen
there cannot happen in the model. Only where that is not enough the whole step is searched. Induction along the order
of evaluation joins the small proofs: if the rows of each auxiliary leave one value where all earlier ones agree, then
all agree.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.encoding import (
    UPDATES_AND_OUTPUTS,
    Step,
    add_terms,
    auxiliary_variables,
    encode_items,
    encode_step,
    nothing,
    ranges_by_definition,
    shared_variables,
)
from hysdel_py.analysis.margins import Margins, largest
from hysdel_py.analysis.milp import Milp
from hysdel_py.analysis.mld_forms import equations, idle_auxiliaries, row_forms
from hysdel_py.analysis.stepping import TOUCHING, Witness, clipped, differing, take_step
from hysdel_py.errors import SimulationError
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineRequirement, Dha, DhaItem, Event, LogicRequirement, read_by
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import Variable

__all__ = ["SHARE", "Comparison", "add_form", "is_requirement"]

Vector = NDArray[np.float64]
Point = dict[str, float]

SHARE = 1e-3
"""A point that a search puts at the edge of a band may lie inside by this share of it, by rounding."""

FAR = 1e4
"""How far beyond the range of its definition another value of a real auxiliary is looked for."""


def is_requirement(item: DhaItem) -> bool:
    """Whether an item belongs to MUST."""
    return isinstance(item, AffineRequirement | LogicRequirement)


def add_form(terms: dict[int, float], form: Affine, places: Mapping[str, int], factor: float = 1.0) -> None:
    """Add the terms of a form, without its constant."""
    for name, coefficient in form.terms:
        add_terms(terms, places[name], factor * coefficient)


class Comparison:
    """A Dha and an Mld over the same states and inputs, prepared for questions."""

    def __init__(self, dha: Dha, mld: Mld, margins: Margins, clock: Clock) -> None:
        self.dha, self.mld, self.margins, self.clock = dha, mld, margins, clock
        self.ranges = ranges_by_definition(dha)
        self.rows = row_forms(mld)
        self.updates, self.outputs = equations(mld)
        self.idle = idle_auxiliaries(mld)
        self.auxiliaries = (*dha.d, *dha.z)
        self.position = {name: i for i, name in enumerate(dha.evaluation_order)}
        self._variables = {v.name: v for v in (*dha.x, *dha.u, *self.auxiliaries)}

    @cached_property
    def rows_of(self) -> Mapping[str, tuple[int, ...]]:
        """Rows of the Mld in which each auxiliary stands."""
        found: dict[str, list[int]] = {v.name: [] for v in self.auxiliaries}
        for index, form in enumerate(self.rows):
            for name, _ in form.terms:
                if name in found:
                    found[name].append(index)
        return {name: tuple(rows) for name, rows in found.items()}

    @cached_property
    def tolerances(self) -> Mapping[str, float]:
        """By how much values have to differ: auxiliaries and outputs by name, next states by name with a ``'``."""
        half = 0.5  # the searches ask for twice as much, so that what they find stands here
        found = {
            v.name: half * (0.5 if v.is_bool else self.margins.tolerance * self._size(v)) for v in self.auxiliaries
        }
        for forms, mark in ((self.updates, "'"), (self.outputs, "")):
            for name, form in forms.items():
                found[name + mark] = half * self.margins.distance(form, self.ranges)
        return found

    def _size(self, variable: Variable) -> float:
        return max(map(abs, self.ranges[variable.name]))

    def band(self, event: Event) -> float:
        """Half width of the band around a threshold."""
        return self.margins.beside(event, self.ranges)

    def below(self, event: Event) -> float:
        """How far searches away from thresholds stay on the true side."""
        return self.margins.below(event, self.ranges)

    # ---- problems ---------------------------------------------------------------------------------------------

    def part(self, names: Iterable[str], items: Iterable[DhaItem]) -> tuple[Milp, dict[str, int]]:
        """Some definitions alone; what else they read is free in its range."""
        problem = Milp()
        chosen = list(items)
        wanted = dict.fromkeys([*names, *(name for item in chosen for name in mentioned(item))])
        variables = [self._variables[name] for name in wanted]
        given = [v for v in variables if v.kind.value in "xu"]
        values = shared_variables(problem, given)
        values |= auxiliary_variables(problem, [v for v in variables if v.kind.value in "dz"], self.ranges)
        encode_items(problem, chosen, values, self.ranges, band=self.band)
        return problem, values

    def definitions(self, names: Iterable[str]) -> Iterator[DhaItem]:
        """Definitions of the auxiliaries among some names."""
        for name in names:
            if name in self.rows_of and name in self.dha.definitions:
                yield self.dha.definitions[name]

    def whole(self, *, must: bool = True, clear: bool) -> tuple[Milp, Step]:
        """A whole step of the Dha; `clear` keeps it away from thresholds on both sides."""
        problem = Milp()
        given = shared_variables(problem, (*self.dha.x, *self.dha.u))
        step = encode_step(
            problem,
            self.dha,
            given,
            band=self.band,
            below=self.below if clear else nothing,
            leave_out=lambda item: is_requirement(item) and not must,
        )
        return problem, step

    def add_mld(self, problem: Milp, step: Step) -> dict[str, int]:
        """Auxiliaries of their own that satisfy all rows of the Mld at the same state and input."""
        places = {v.name: step.values[v.name] for v in (*self.dha.x, *self.dha.u)}
        for v in self.auxiliaries:
            places[v.name] = self.another(problem, v)
        for form in self.rows:
            terms: dict[int, float] = {}
            add_form(terms, form, places)
            problem.row(terms, high=-form.constant)
        return places

    def another(self, problem: Milp, variable: Variable) -> int:
        """A second variable for an auxiliary, which is not bound to its definition."""
        if variable.name in self.idle:
            return problem.real(0.0, 0.0)
        if variable.is_bool:
            return problem.boolean()
        size = self._size(variable) or 1.0
        return problem.real(-FAR * size, FAR * size, size=min(size, 1.0))

    # ---- confirmation -----------------------------------------------------------------------------------------

    def witness(self, w: Vector, step: Step) -> Witness | None:
        """The state and input of a point, if the two forms differ there."""
        x, u = self.point(w, step)
        values = self.values_at(x, u)
        return None if values is not None and self.is_in_band(values) else self.compare(x, u)

    def point(self, w: Vector, step: Step) -> tuple[Point, Point]:
        """The state and input of a point of a search, without what rounding did to it."""
        true = {v.name for v in self.dha.d if w[step.values[v.name]] > 0.5}
        x, u = ({v.name: w[step.values[v.name]] for v in group} for group in (self.dha.x, self.dha.u))
        return self._onto_thresholds(clipped(self.dha.x, x), clipped(self.dha.u, u), true)

    def _onto_thresholds(self, x: Point, u: Point, true: set[str]) -> tuple[Point, Point]:
        """Move a point back onto the thresholds of true events that rounding put it beyond."""
        for event in (item for item in self.dha.items if isinstance(item, Event) and item.name in true):
            values = self.values_at(x, u)
            excess = 0.0 if values is None else event.form.value(values)
            if 0.0 < excess <= TOUCHING * largest(event.form, self.ranges):
                x, u = self._moved(x, u, event, excess)
        return x, u

    def _moved(self, x: Point, u: Point, event: Event, excess: float) -> tuple[Point, Point]:
        real = {v.name for v in (*self.dha.x, *self.dha.u) if not v.is_bool}
        name, slope = next(((n, c) for n, c in event.form.terms if c and n in real), ("", 1.0))
        there = {name: {**x, **u}.get(name, 0.0) - 2.0 * excess / slope}
        return clipped(self.dha.x, {**x, **there}), clipped(self.dha.u, {**u, **there})

    def values_at(self, x: Mapping[str, float], u: Mapping[str, float]) -> Mapping[str, float] | None:
        """All variables of the Dha at a state and input, requirements or not; None if there is no step."""
        try:
            _, _, d, z = self.dha.step(x, u, check=False)
        except SimulationError:
            return None
        found = zip(self.auxiliaries, (*d, *z), strict=True)
        return {**x, **u, **{v.name: float(value) for v, value in found}}

    def is_in_band(self, values: Mapping[str, float]) -> bool:
        """Whether the form of an event lies on the false side and too near to its threshold."""
        return any(
            0.0 < item.form.value(values) < self.band(item) * (1.0 - SHARE)
            for item in self.dha.items
            if isinstance(item, Event)
        )

    def compare(self, x: Mapping[str, float], u: Mapping[str, float]) -> Witness | None:
        """Step both forms at a state and input; None if they do the same."""
        x, u = clipped(self.dha.x, x), clipped(self.dha.u, u)
        first, second = take_step(self.dha, x, u), take_step(self.mld, x, u)
        if not first.exists and not second.exists:
            return None
        names = differing(first, second, self.tolerances.__getitem__)
        if first.exists and second.exists and not names:
            return None
        return Witness(tuple(x.items()), tuple(u.items()), first, second, names, "Mld")


def mentioned(item: DhaItem) -> tuple[str, ...]:
    """Variables that an item reads, and the auxiliary that it defines."""
    own = getattr(item, "name", "")
    after = getattr(item, "item", "") in UPDATES_AND_OUTPUTS
    return (*read_by(item), *((own,) if own and not after else ()))
