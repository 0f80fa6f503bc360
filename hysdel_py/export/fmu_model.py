"""What a functional mock-up unit simulates: a plant, or an explicit law with the input applied last as its state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.errors import ArgumentError
from hysdel_py.export.plant_c import STATUS, write_plant
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.signals import Kind, Type, Variable, as_vector

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysdel_py.model import Model
    from hysdel_py.semantics.typed_model import TypedModel

__all__ = ["FmuModel", "fmu_model", "law_model", "plant_model"]

INVALID = STATUS["INVALID"]
OUTSIDE = 1

_PLANT_REMARKS = (
    (STATUS["STATE_RANGE"], "a state lies outside its range"),
    (STATUS["INPUT_RANGE"], "an input lies outside its range"),
    (STATUS["MUST"], "a requirement (MUST) does not hold"),
)
_LAW_REMARKS = ((OUTSIDE, "the point lies outside the law: the last move is held"),)


@dataclass(frozen=True, slots=True)
class FmuModel:
    """A sampled system with a step function in C.

    Attributes
    ----------
    name, description : str
    x, u, y, d, z : tuple of Variable
    start : tuple of float
        First states.
    sample_time : float
    remarks : tuple of (bit, text)
        Bits of the result of a step and what they mean.
    source : Dha or law
        What the step function is written from.
    typed : TypedModel or None
        The text of a plant, for diagnostics.
    """

    name: str
    description: str
    x: tuple[Variable, ...]
    u: tuple[Variable, ...]
    y: tuple[Variable, ...]
    d: tuple[Variable, ...]
    z: tuple[Variable, ...]
    start: tuple[float, ...]
    sample_time: float
    remarks: tuple[tuple[int, str], ...]
    source: Dha | ExplicitLaw | HybridLaw
    typed: TypedModel | None = None

    @property
    def variables(self) -> tuple[Variable, ...]:
        """All of them, in the order of their value references."""
        return (*self.x, *self.u, *self.y, *self.d, *self.z)

    @property
    def shows_states(self) -> bool:
        """Whether the states are the outputs, because there are no others."""
        return not self.y

    def write_step(self, folder: Path, prefix: str) -> tuple[Path, ...]:
        """Write the step function, ``PREFIX_step``, and what it needs."""
        if isinstance(self.source, Dha):
            return write_plant(self.source, folder / f"{prefix}.c", self.typed, prefix=prefix, points=0).files
        law = self.source.to_c(folder / f"{prefix}_law.c", prefix=f"{prefix}_law", points=0)
        step = folder / f"{prefix}.c"
        lines = _law_step(self.source, prefix, [v.name for v in self.u], len(self.y))
        step.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
        return (step, *law.files)


def fmu_model(
    system: Model | Dha | ExplicitLaw | HybridLaw,
    x0: ArrayLike | Mapping[str, float] | None = None,
    sample_time: float | None = None,
) -> FmuModel:
    """The model of a unit; see :func:`hysdel_py.export.fmu.to_fmu`.

    Raises
    ------
    ArgumentError
        Something else, or a wrong first state.
    """
    if isinstance(system, ExplicitLaw | HybridLaw):
        model = law_model(system)
    else:
        dha = getattr(system, "dha", system)
        if not isinstance(dha, Dha):
            raise ArgumentError(
                f"system is a {type(system).__name__}: a Model, a Dha, or an explicit law of a controller was expected"
            )
        model = plant_model(dha, getattr(system, "sample_time", 1.0), getattr(system, "typed", None))
    if sample_time is not None:
        if not (isinstance(sample_time, Real) and 0.0 < sample_time < float("inf")):
            raise ArgumentError(f"sample_time is {sample_time!r}: a positive number was expected")
        model = replace(model, sample_time=float(sample_time))
    return model if x0 is None else replace(model, start=tuple(as_vector(x0, model.x, "state").tolist()))


def plant_model(dha: Dha, sample_time: float, typed: TypedModel | None = None) -> FmuModel:
    """A plant; its first states are 0 or the nearest allowed value."""
    start = tuple(_nearest_to_zero(v) for v in dha.x)
    description = f"plant {dha.name}"
    return FmuModel(dha.name or "model", description, dha.x, dha.u, dha.y, dha.d, dha.z, start, sample_time,
                    _PLANT_REMARKS, dha, typed)  # fmt: skip


def _nearest_to_zero(v: Variable) -> float:
    return 0.0 if v.is_bool else min(max(0.0, v.low), v.high) + 0.0


def law_model(law: ExplicitLaw | HybridLaw) -> FmuModel:
    """A law: its inputs are the parameters but the inputs applied last, which are states; its outputs are the moves."""
    moves = _moves(law)
    last = tuple(replace(v, name=f"{v.name}(-1)", kind=Kind.STATE) for v in moves)
    given = tuple(v for v in _parameters(law) if v.name not in {v.name for v in last})
    start = tuple(_nearest_to_zero(v) for v in moves)
    outputs = tuple(replace(v, kind=Kind.OUTPUT) for v in moves)
    return FmuModel("controller", "explicit control law", last, given, outputs, (), (), start, law.sample_time,
                    _LAW_REMARKS, law)  # fmt: skip


def _moves(law: ExplicitLaw | HybridLaw) -> tuple[Variable, ...]:
    if isinstance(law, HybridLaw):
        return law.u
    if law.signals is not None and len(law.signals.u) == law.moves:
        return law.signals.u
    return tuple(Variable(f"u{i}", Type.REAL, Kind.INPUT) for i in range(law.moves))


def _parameters(law: ExplicitLaw | HybridLaw) -> tuple[Variable, ...]:
    """The entries of zeta, those of states with their units."""
    if isinstance(law, HybridLaw):
        known = {v.name: v for v in law.x}
        return tuple(_input(p.name, known.get(p.name), is_bool=p.is_bool) for p in law.parameters.free)
    known = {} if law.signals is None else {v.name: v for v in law.signals.x}
    return tuple(_input(name, known.get(name)) for name in law.names)


def _input(name: str, known: Variable | None, *, is_bool: bool = False) -> Variable:
    """A parameter as an input; it has no range, since the law itself says where it ends."""
    unit, text = ("", "") if known is None else (known.unit, known.description)
    return Variable(name, Type.BOOL if is_bool else Type.REAL, Kind.INPUT, unit=unit, description=text)


def _law_step(law: ExplicitLaw | HybridLaw, prefix: str, inputs: Sequence[str], moves: int) -> Iterator[str]:
    """Lines of a step function around a law."""
    increment = isinstance(law, ExplicitLaw) and law.signals is not None and law.signals.increment
    last = {f"{v.name}(-1)": i for i, v in enumerate(_moves(law))}
    yield f'#include "{prefix}_law.h"'
    yield ""
    yield (f"int {prefix}_step(const double *x, const double *u, double *x_next, double *y, double *d, double *z);")
    yield (f"int {prefix}_step(const double *x, const double *u, double *x_next, double *y, double *d, double *z)")
    yield "{"
    yield f"    double zeta[{max(1, len(law.names))}], move[{moves}];"
    yield "    int i, inside;"
    yield "    (void)d;"
    yield "    (void)z;"
    if not inputs:
        yield "    (void)u;"
    for place, name in enumerate(law.names):
        yield f"    zeta[{place}] = {f'x[{last[name]}]' if name in last else f'u[{inputs.index(name)}]'};"
    yield f"    inside = {prefix}_law(zeta, move) == {prefix.upper()}_LAW_INSIDE;"
    yield f"    for (i = 0; i < {moves}; i++)"
    yield f"        y[i] = x_next[i] = inside ? {'x[i] + ' * increment}move[i] : x[i];"
    yield f"    return inside ? 0 : {OUTSIDE};"
    yield "}"
