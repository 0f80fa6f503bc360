"""Two automata over the same states and inputs, and searches for a point at which they part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.comparison import add_form, is_requirement
from hysdel_py.analysis.encoding import Step, encode_step, nothing, ranges_by_definition, shared_variables
from hysdel_py.analysis.margins import Margins, largest
from hysdel_py.analysis.milp import Milp, Source
from hysdel_py.analysis.questions import on_thresholds_last
from hysdel_py.analysis.report import CheckStatus
from hysdel_py.analysis.search import Found, settle
from hysdel_py.analysis.stepping import Witness, clipped, differing, take_step
from hysdel_py.analysis.tseitin import formula_variable
from hysdel_py.errors import SimulationError
from hysdel_py.systems.dha import AffineEquation, AffineRequirement, Dha, DhaItem, Event, LogicRequirement, read_by

__all__ = ["Pair", "Side"]

Vector = NDArray[np.float64]
ANY_POINT = -1.0

_STATUS = {
    Found.NONE: CheckStatus.HOLDS,
    Found.POINT: CheckStatus.DIFFERENT,
    Found.DOUBTFUL: CheckStatus.DOUBTFUL,
    Found.UNSETTLED: CheckStatus.NOT_SETTLED,
}


@dataclass(frozen=True, eq=False)
class Side:
    """One of the two models, over the common ranges."""

    dha: Dha

    @cached_property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        """Ranges of all variables by their definitions."""
        return ranges_by_definition(self.dha)

    @cached_property
    def names(self) -> frozenset[tuple[str, str, str]]:
        """Name, kind and type of all variables that are written in the source."""
        d = self.dha
        return frozenset((v.name, v.kind.value, v.type.value) for v in (*d.x, *d.u, *d.y, *d.d, *d.z))


class Pair:
    """An old and a new model."""

    def __init__(self, old: Dha, new: Dha, margins: Margins, clock: Clock) -> None:
        self.old, self.new = Side(old), Side(new)
        self.margins, self.clock = margins, clock
        both = self.old.names & self.new.names
        self._common = {(kind, name): type_ for name, kind, type_ in both}
        self.shared = frozenset(name for name, kind, _ in both if kind in "xu")

    def common(self, kind: str) -> tuple[str, ...]:
        """Names of a vector that both models have, in the order of the old one."""
        group = {"x": self.old.dha.x, "u": self.old.dha.u, "y": self.old.dha.y}[kind]
        return tuple(v.name for v in group if (kind, v.name) in self._common)

    def value_tolerance(self, name: str, kind: str = "") -> float:
        """By how much two values have to differ."""
        for (letter, own), type_ in self._common.items():
            if own == name and letter in (kind or "dz") and type_ == "BOOL":
                return 0.5
        sizes = []
        for side in (self.old, self.new):
            definition = side.dha.definitions.get(name)
            if isinstance(definition, AffineEquation):
                sizes.append(largest(definition.value, side.ranges))
        sizes += [max(map(abs, side.ranges[name])) for side in (self.old, self.new) if name in side.ranges and not kind]
        return self.margins.tolerance * max(sizes, default=1.0)

    # ---- searches ---------------------------------------------------------------------------------------------

    def differing_value(self, name: str, mark: str) -> tuple[CheckStatus, Witness | None]:
        """Search for a next state or output that differs where both models have a step."""
        return on_thresholds_last(lambda clear: self._differing_value(name, mark, clear=clear))

    def _differing_value(self, name: str, mark: str, *, clear: bool) -> tuple[CheckStatus, Witness | None]:
        problem, steps = self._both(must=(True, True), clear=clear)
        ours, theirs = ((step.next if mark else step.outputs)[name] for step in steps)
        tolerance = self.value_tolerance(name, "x" if mark else "y")
        statuses = []
        for sign in (1.0, -1.0):
            kept: list[Witness] = []

            def accept(w: Vector, kept: list[Witness] = kept) -> bool:
                witness = self._witness(w, steps, name + mark, tolerance)
                kept += [witness] if name + mark in witness.differing else []
                return bool(kept)

            found = settle(problem, {ours: sign, theirs: -sign}, tolerance, accept, self.clock).found
            if kept:
                return CheckStatus.DIFFERENT, kept[0]
            statuses.append(_STATUS[found])
        return max(statuses, key=list(CheckStatus).index), None

    def violated_here_alone(
        self, side: Side, requirement: AffineRequirement | LogicRequirement
    ) -> tuple[CheckStatus, Witness | None]:
        """Search for a point at which a requirement of one side is violated and the other side has a step."""
        return on_thresholds_last(lambda clear: self._violated_here_alone(side, requirement, clear=clear))

    def _violated_here_alone(
        self, side: Side, requirement: AffineRequirement | LogicRequirement, *, clear: bool
    ) -> tuple[CheckStatus, Witness | None]:
        is_old = side is self.old
        problem, steps = self._both(must=(not is_old, is_old), clear=clear)
        objective, threshold = self._violate(problem, side, steps[0 if is_old else 1], requirement)
        kept: list[Witness] = []

        def accept(w: Vector) -> bool:
            witness = self._witness(w, steps, "", 0.0)
            here, there = (witness.first, witness.second) if is_old else (witness.second, witness.first)
            if there.exists and not here.exists:
                kept.append(witness)
            return bool(kept)

        found = settle(problem, objective, threshold, accept, self.clock).found
        return (CheckStatus.DIFFERENT, kept[0]) if kept else (_STATUS[found], None)

    def _violate(
        self, problem: Milp, side: Side, step: Step, requirement: AffineRequirement | LogicRequirement
    ) -> tuple[dict[int, float], float]:
        if isinstance(requirement, LogicRequirement):
            problem.fix(formula_variable(problem, requirement.value, step.values, Source(requirement.origin)), 0.0)
            return {}, ANY_POINT
        objective: dict[int, float] = {}
        add_form(objective, requirement.value, step.values)
        level = self.margins.violation(requirement.value, side.ranges)
        return objective, level - requirement.value.constant

    def _both(self, must: tuple[bool, bool], *, clear: bool) -> tuple[Milp, tuple[Step, Step]]:
        """Both steps over shared states and inputs; a state or input of one model alone is its own."""
        problem = Milp()
        given: dict[str, int] = {}
        steps = []
        for side, wanted in zip((self.old, self.new), must, strict=True):
            variables = (*side.dha.x, *side.dha.u)
            own = [v for v in variables if v.name not in given or v.name not in self.shared]
            given |= shared_variables(problem, own)
            steps.append(
                self._step(problem, side, {v.name: given[v.name] for v in variables}, must=wanted, clear=clear)
            )
        return problem, (steps[0], steps[1])

    def _step(self, problem: Milp, side: Side, given: Mapping[str, int], *, must: bool, clear: bool) -> Step:
        def band(event: Event) -> float:
            return self.margins.beside(event, side.ranges)

        def below(event: Event) -> float:
            return self.margins.below(event, side.ranges)

        def unwanted(item: DhaItem) -> bool:
            return is_requirement(item) and not must

        return encode_step(problem, side.dha, given, band=band, below=below if clear else nothing, leave_out=unwanted)

    # ---- confirmation -----------------------------------------------------------------------------------------

    def _witness(self, w: Vector, steps: tuple[Step, Step], name: str, tolerance: float) -> Witness:
        points = [
            (
                clipped(side.dha.x, {v.name: w[step.values[v.name]] for v in side.dha.x}),
                clipped(side.dha.u, {v.name: w[step.values[v.name]] for v in side.dha.u}),
            )
            for side, step in zip((self.old, self.new), steps, strict=True)
        ]
        first, second = (take_step(s.dha, *point) for s, point in zip((self.old, self.new), points, strict=True))
        names = differing(first, second, lambda _: 0.5 * tolerance) if name else ()
        x, u = ({**points[0][i], **points[1][i]} for i in (0, 1))
        return Witness(tuple(x.items()), tuple(u.items()), first, second, names)

    def auxiliary_values(self, witness: Witness) -> tuple[Mapping[str, float], Mapping[str, float]]:
        """Auxiliaries of both models at a witness, in the order of evaluation where there is one."""
        ours, theirs = (self._values(side, witness) for side in (self.old, self.new))
        return ours, theirs

    def _values(self, side: Side, witness: Witness) -> Mapping[str, float]:
        dha = side.dha
        given = dict(witness.x) | dict(witness.u)
        x, u = ({v.name: given[v.name] for v in group} for group in (dha.x, dha.u))
        try:
            _, _, d, z = dha.step(x, u, check=False)
        except SimulationError:
            return {}
        values = {v.name: float(value) for v, value in zip((*dha.d, *dha.z), (*d, *z), strict=True)}
        return {name: values[name] for name in dha.evaluation_order or values}

    def reads(self, name: str) -> set[str]:
        """All auxiliaries that a definition rests on, in either model, itself not among them."""
        found: set[str] = set()
        for side in (self.old, self.new):
            pending = [name]
            while pending:
                definition = side.dha.definitions.get(pending.pop())
                if definition is not None:
                    fresh = set(read_by(definition)) - found - self.shared
                    found |= fresh
                    pending += sorted(fresh)
        return found - {name}
