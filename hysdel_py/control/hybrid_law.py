"""The explicit law of a hybrid controller: a law for each sequence of switches, and the least value among them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.explicit_parameters import LAST, Parameters
from hysdel_py.control.hybrid_sequences import Place, SearchReport, SequenceLaw, Stack, stacked
from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.control.references import Reference, References
from hysdel_py.control.settings import DEFAULT_CONTROL_TOLERANCES, ControlTolerances
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Variable, as_vector

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hysdel_py.control.hybrid_certificate import HybridCertificate
    from hysdel_py.control.hybrid_mpc import HybridMpc
    from hysdel_py.export.law_c import LawCode

__all__ = ["HybridLaw", "Place", "SearchReport", "SequenceLaw"]

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class HybridLaw:
    """Explicit form of a hybrid controller.

    Several sequences may have a region at one point; the least value decides. Values that are equal up to rounding
    (1e-9, relative) are a tie, which the first sequence wins, and within a sequence the region that holds the point
    best.

    Attributes
    ----------
    sequences : tuple of SequenceLaw
        In rising order of their words.
    parameters : Parameters
        What zeta consists of, with the box, and what is fixed.
    switches : tuple of str
        Meaning of the entries of a word: Boolean parameters by name, then ``NAME[k]``.
    x, u : tuple of Variable
        States and inputs of the controller.
    references : References
    horizon : int
    norm : str
        ``"2"``, ``"1"`` or ``"inf"``.
    exact : int
        Switches from this stage on are relaxed; the horizon if none are.
    complete : bool
        Whether all sequences were solved completely. If not, the law holds as far as it goes, but another sequence may
        be better or hold a point that it leaves out.
    partition : bool
        Whether regions of different sequences have no inner points in common.
    report : SearchReport
    sample_time : float
    """

    sequences: tuple[SequenceLaw, ...]
    parameters: Parameters
    switches: tuple[str, ...]
    x: tuple[Variable, ...]
    u: tuple[Variable, ...]
    references: References
    horizon: int
    norm: str
    exact: int
    complete: bool
    partition: bool
    report: SearchReport
    sample_time: float = 1.0

    def __repr__(self) -> str:
        state = "complete" if self.complete else "incomplete"
        laws = f"{len(self.sequences)} sequences, {self.count} regions"
        return f"<HybridLaw of {', '.join(self.names)}: {laws}, {state}>"

    def _repr_html_(self) -> str:
        from hysdel_py.markup.cards import law_card

        return law_card(self)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the entries of zeta."""
        return self.parameters.names

    @property
    def p(self) -> int:
        """Number of entries of zeta."""
        return len(self.parameters.free)

    @property
    def count(self) -> int:
        """Number of regions of all sequences."""
        return sum(sequence.law.count for sequence in self.sequences)

    @property
    def uses_last_input(self) -> bool:
        """Whether :meth:`solve` needs the input applied last."""
        return bool(self.parameters.group(LAST))

    def __call__(self, zeta: ArrayLike | Mapping[str, float]) -> Vector | None:
        """The first input at a point, or None where no region holds it.

        Parameters
        ----------
        zeta : array_like of shape (p,), or mapping of name to number
        """
        point = self.parameters.point(zeta)
        place = self.locate(point)
        return None if place is None else self.plan(point, place)[: len(self.u)]

    def locate(self, zeta: ArrayLike | Mapping[str, float]) -> Place | None:
        """Sequence, region and value at a point; None where no region holds it."""
        point = self.parameters.point(zeta)
        theta = self._real(point)
        stack = self._stacks.get(self._bits(point))
        return None if stack is None else stack.best(theta)

    def value(self, zeta: ArrayLike | Mapping[str, float]) -> float:
        """Optimal cost at a point, infinite where no region holds it."""
        place = self.locate(zeta)
        return float("inf") if place is None else place.value

    def plan(self, zeta: ArrayLike | Mapping[str, float], place: Place) -> Vector:
        """Inputs of the whole plan at a place, stage after stage; Boolean entries are 0 or 1 up to the exact stages."""
        law = self.sequences[place.sequence].law
        theta = self._real(self.parameters.point(zeta))
        return np.asarray(law.K[place.region] @ theta + law.k[place.region])

    def evaluate(self, zeta: ArrayLike | Mapping[str, float]) -> Move:
        """The move at a point, with a status that says what it is worth.

        OPTIMAL inside a region of a complete law, FEASIBLE inside one of an incomplete law, INFEASIBLE where a complete
        law has no region inside its box, and NO_PLAN outside the box or where an incomplete law has no region.
        """
        begin = perf_counter()
        point = self.parameters.point(zeta)
        place = self.locate(point)
        if place is None:
            return self._outside(point, perf_counter() - begin)
        u = self._on_range(self.plan(point, place)[: len(self.u)])
        status = MoveStatus.OPTIMAL if self.complete else MoveStatus.FEASIBLE
        return Move(
            status,
            f"explicit: cost {place.value:.6g}, sequence {place.sequence}, region {place.region}{self._remarks()}",
            u=u,
            cost=place.value,
            bound=place.value if self.complete else -np.inf,
            gap=0.0 if self.complete else np.inf,
            seconds=perf_counter() - begin,
            approximate_from=self.exact if self.exact < self.horizon else None,
        )

    def solve(
        self,
        x: ArrayLike | Mapping[str, float],
        ref: Reference = None,
        *,
        last_input: ArrayLike | Mapping[str, float] | None = None,
        tolerances: ControlTolerances = DEFAULT_CONTROL_TOLERANCES,
    ) -> Move:
        """Answer like the controller itself, so that the law can take its place in a closed loop.

        Parameters
        ----------
        x, ref, last_input
            As for :meth:`HybridMpc.solve`; a reference must be constant over the horizon, and what was fixed must have
            its fixed value.
        tolerances : ControlTolerances
            Values that are outside the box by no more than ``measured`` are moved onto it.

        Raises
        ------
        ArgumentError
            As :meth:`HybridMpc.solve`; a reference that varies, or another value than the fixed one.
        """
        state = as_vector(x, self.x, "state")
        last = None
        if self.uses_last_input:
            if last_input is None:
                raise ArgumentError("last_input is missing: increments are weighed or limited in this law")
            last = as_vector(last_input, self.u, "last input")
        values = {name: _constant(name, table) for name, table in self.references.table(ref).items()}
        return self.evaluate(self.parameters.gathered(state, last, values, tolerances.measured))

    def reduced(self) -> HybridLaw:
        """The same law without regions that are never best, and for the norms 1 and infinity without overlaps."""
        from hysdel_py.control.hybrid_overlaps import without_overlaps

        return without_overlaps(self)

    def single(self, booleans: Mapping[str, float] | None = None) -> ExplicitLaw:
        """All regions as one explicit law, for given values of the Boolean parameters.

        Parameters
        ----------
        booleans : mapping of name to 0 or 1
            Of every Boolean parameter that is not fixed.

        Raises
        ------
        ArgumentError
            The sequences overlap, so that values have to be compared; or a Boolean parameter is missing.
        """
        from hysdel_py.control.hybrid_overlaps import as_single

        return as_single(self, booleans or {})

    def certificate(self, mpc: HybridMpc, samples: int = 200, seed: int = 0) -> HybridCertificate:
        """Comparison with the controller solved online at random parameters; see :func:`certify_hybrid`."""
        from hysdel_py.control.hybrid_certificate import certify_hybrid

        return certify_hybrid(self, mpc, samples, seed)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the law as an .npz file."""
        from hysdel_py.control.hybrid_file import save_hybrid

        save_hybrid(self, path)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> HybridLaw:
        """Read a law from an .npz file."""
        from hysdel_py.control.hybrid_file import load_hybrid

        return load_hybrid(path)

    def to_c(self, path: str | PathLike[str], **options: Any) -> LawCode:
        """Write the law as C99, a source and a header beside it; options as for :func:`hybrid_to_c`."""
        from hysdel_py.export.hybrid_c import hybrid_to_c

        return hybrid_to_c(self, path, **options)

    def to_python(self, path: str | PathLike[str]) -> Path:
        """Write the law as a Python module with ``law(zeta)`` that needs nothing but Python."""
        from hysdel_py.export.hybrid_python import hybrid_to_python

        return hybrid_to_python(self, path)

    def to_latex(self, path: str | PathLike[str] | None = None, **options: Any) -> str:
        """The law as LaTeX tables; options as for :func:`hybrid_to_latex`."""
        from hysdel_py.export.hybrid_latex import hybrid_to_latex

        return hybrid_to_latex(self, path, **options)

    def plot(self, what: str = "partition", **options: Any) -> Figure:
        """Draw the law over one or two parameters; options as for :func:`plot_hybrid_law`."""
        from hysdel_py.plotting.hybrid_law import plot_hybrid_law

        return plot_hybrid_law(self, what, **options)

    def to_json(self, path: str | PathLike[str]) -> None:
        """Write the law as JSON."""
        from hysdel_py.export.hybrid_json import write_hybrid_json

        write_hybrid_json(self, path)

    @classmethod
    def from_json(cls, path: str | PathLike[str]) -> HybridLaw:
        """Read a law from a JSON file; it equals the one that was written."""
        from hysdel_py.export.hybrid_json import read_hybrid_json

        return read_hybrid_json(path)

    def describe(self, regions: bool = False) -> str:
        """The law as text: sizes, parameters, sequences; with `regions` also rows and moves of each region."""
        from hysdel_py.control.hybrid_text import describe_hybrid

        return describe_hybrid(self, regions)

    def _real(self, point: Vector) -> Vector:
        return np.array([v for v, p in zip(point, self.parameters.free, strict=True) if not p.is_bool])

    def _bits(self, point: Vector) -> tuple[int, ...] | None:
        """Values of the Boolean parameters, None if one is neither 0 nor 1."""
        values = [v for v, p in zip(point.tolist(), self.parameters.free, strict=True) if p.is_bool]
        return tuple(int(v) for v in values) if all(v in (0.0, 1.0) for v in values) else None

    @cached_property
    def _stacks(self) -> dict[tuple[int, ...] | None, Stack]:
        size = len(self.parameters.boolean)
        groups: dict[tuple[int, ...] | None, list[int]] = {}
        for number, sequence in enumerate(self.sequences):
            if sequence.law.count:
                groups.setdefault(sequence.word[:size], []).append(number)
        return {bits: stacked(self.sequences, numbers) for bits, numbers in groups.items()}

    def _outside(self, point: Vector, seconds: float) -> Move:
        beyond = [
            f"{p.name} = {value:g} is outside [{p.low:g}, {p.high:g}]"
            for p, value in zip(self.parameters.free, point.tolist(), strict=True)
            if not p.low <= value <= p.high
        ]
        if beyond:
            message = f"outside the box of the law: {', '.join(beyond)}; make the law for a larger box"
        elif not self.complete:
            message = f"no region of this incomplete law holds the point ({self.report.stop}); let the search finish"
        else:
            message = "infeasible: no sequence of switches keeps the model and the limits from here"
        status = MoveStatus.INFEASIBLE if self.complete and not beyond else MoveStatus.NO_PLAN
        return Move(status, message, bound=np.inf if status is MoveStatus.INFEASIBLE else -np.inf, seconds=seconds)

    def _remarks(self) -> str:
        parts = [] if self.complete else [f"the law is incomplete ({self.report.stop}): another plan may cost less"]
        if self.exact < self.horizon:
            parts.append(f"an approximation: binaries of step {self.exact} and later are relaxed")
        return "".join(f"; {part}" for part in parts)

    def _on_range(self, u: Vector) -> Vector:
        """Rounding must not leave the range of an input, nor a Boolean between its values."""
        bools = np.array([v.is_bool for v in self.u], dtype=bool)
        return np.where(bools, np.round(u), np.clip(u, [v.low for v in self.u], [v.high for v in self.u])) + 0.0


def _constant(name: str, table: Vector) -> float:
    if np.ptp(table) > 0:
        raise ArgumentError(f"reference {name} varies over the horizon: the law was made for constant references")
    return float(table[0])
