"""What the original tells of each row: ``rowinfo``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from hysdel_py.diagnostics.sink import Sink
from hysdel_py.export.compiled import Compiled
from hysdel_py.export.matlab_text import NumberStyle, Value
from hysdel_py.export.matrices import nonzeros
from hysdel_py.lowering.big_m import Ranges
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import Event, Switch
from hysdel_py.systems.origin import Origin, RowOrigin
from hysdel_py.systems.signals import Variable

__all__ = ["row_info"]

Fields = dict[str, Value]
Part = tuple[list[tuple[int, float]], Sequence[Variable]]
Interval = tuple[float, float]


def row_info(compiled: Compiled, style: NumberStyle) -> Iterator[tuple[str, int, Fields]]:
    """(``state_upd``, ``output`` or ``ineq``, number of the row from 1, fields) of each row that an item made."""
    mld = compiled.mld
    equations = (
        ("state_upd", mld.updates, mld.x, ("A", "B1", "B2", "B3", "B5")),
        ("output", mld.outputs, mld.y, ("C", "D1", "D2", "D3", "D5")),
    )
    for key, origins, variables, names in equations:
        *matrices, constants = (getattr(mld, name) for name in names)
        rows = zip(*map(nonzeros, matrices), strict=True)
        for index, (origin, variable, row) in enumerate(zip(origins, variables, rows, strict=True)):
            if origin.item:
                parts = list(zip(row, (mld.x, mld.u, mld.d, mld.z), strict=True))
                human = f"{variable.name} = {_sum(parts, constants[index], style)}"
                yield key, index + 1, _fields(origin, human)
    extras = _Extras(compiled)
    for index, (origin, human) in enumerate(zip(mld.rows, _inequalities(compiled, style), strict=True), start=1):
        yield "ineq", index, _fields(origin, human) | extras.of(origin)


def _fields(origin: RowOrigin, human: str) -> Fields:
    return {
        "section": origin.section if len(origin.section) == 2 else origin.section.capitalize(),
        "item_type": origin.item,
        "defines": origin.defines or "NONE",
        "depends": origin.depends,
        "group": float(origin.group),
        "subgroup": float(origin.subgroup),
        "subindex": float(origin.subindex),
        "source": f"{origin.text};",
        "sourceline": float(origin.line),
        "human": human,
    }


def _inequalities(compiled: Compiled, style: NumberStyle) -> Iterator[str]:
    mld = compiled.mld
    matrices = (nonzeros(matrix) for matrix in (mld.E1, mld.E2, mld.E3, mld.E4))
    for E1, E2, E3, E4, constant in zip(*matrices, mld.E5, strict=True):
        left = _sum([(E2, mld.d), (E3, mld.z)], 0.0, style)
        right = _sum([(E1, mld.u), (E4, mld.x)], constant, style)
        yield f"{left} <= {right}"


def _sum(parts: Sequence[Part], constant: float, style: NumberStyle) -> str:
    """Terms in the alphabetical order of the names, then the constant."""
    terms = sorted((group[column].name, c) for row, group in parts for column, c in row)
    texts = [f"({style.number(c)}) * {name}" for name, c in terms]
    if constant or not texts:
        texts.append(f"({style.number(constant)})")
    return " + ".join(texts)


class _Extras:
    """Ranges from which the constants of AD and DA rows were made."""

    def __init__(self, compiled: Compiled) -> None:
        self._definitions = compiled.dha.definitions
        self._ranges = Ranges(compiled.dha, Sink())

    def of(self, row: RowOrigin) -> Fields:
        """The additional fields of a row; none for most."""
        definition = self._definitions.get(row.defines) if row.item in ("AD", "DA") else None
        match definition:
            case Event(form=form, limits=limits, epsilon=epsilon, origin=origin):
                computed = float(limits is None)
                return {
                    **self._interval("aff", form, limits, origin),
                    "aff_eps": epsilon,
                    "aff_eps_computed": computed,
                }
            case Switch(then_limits=then_limits, otherwise_limits=else_limits, origin=origin) as switch:
                return {
                    **self._interval("then", switch.then, then_limits, origin),
                    **self._interval("else", switch.otherwise, else_limits, origin),
                }
            case _:
                return {}

    def _interval(self, prefix: str, form: Affine, limits: Interval | None, origin: Origin) -> Fields:
        low, high = self._ranges.of(form, limits, origin)
        computed = float(limits is None)
        return {
            f"{prefix}_min": low,
            f"{prefix}_min_computed": computed,
            f"{prefix}_max": high,
            f"{prefix}_max_computed": computed,
        }
