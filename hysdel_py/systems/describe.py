"""Readable text of a Dha and of an Mld: every item and every row with its names instead of matrices."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import (
    AffineEquation,
    AffineRequirement,
    Dha,
    DhaItem,
    Event,
    LogicEquation,
    LogicRequirement,
    Switch,
)
from hysdel_py.systems.signals import Variable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scipy.sparse import csr_array

    from hysdel_py.systems.mld import Matrix, Mld

__all__ = ["describe_dha", "describe_mld", "equations", "inequalities", "variable_lines"]

_UPDATED = frozenset({"Continuous", "Automata"})


def describe_dha(dha: Dha) -> str:
    """Variables and items of a Dha, one per line; ``'`` marks the next value of a state."""
    lines = [f"{dha.name}: discrete hybrid automaton"]
    lines += variable_lines({"x": dha.x, "u": dha.u, "y": dha.y, "d": dha.d, "z": dha.z})
    lines += [f"  {_item_text(item)}" for item in dha.items]
    return "\n".join(lines) + "\n"


def describe_mld(mld: Mld) -> str:
    """Variables, update and output equations, and the inequalities under the item each came from."""
    lines = [f"{mld.name}: mixed logical dynamical form, {mld.ne} rows"]
    lines += variable_lines({"x": mld.x, "u": mld.u, "y": mld.y, "d": mld.d, "z": mld.z})
    lines += [f"  {text}" for text in equations(mld)]
    for origin, rows in groupby(zip(mld.rows, inequalities(mld), strict=True), key=lambda pair: str(pair[0])):
        lines += [f"  {origin}", *(f"    {text}" for _, text in rows)]
    return "\n".join(lines) + "\n"


def equations(mld: Mld) -> tuple[str, ...]:
    """The update of each state, then each output, with names, such as ``level' = level - out``."""
    updates = _equation_lines([f"{v.name}'" for v in mld.x], mld, (mld.A, mld.B1, mld.B2, mld.B3), mld.B5)
    outputs = _equation_lines([v.name for v in mld.y], mld, (mld.C, mld.D1, mld.D2, mld.D3), mld.D5)
    return (*updates, *outputs)


def inequalities(mld: Mld) -> tuple[str, ...]:
    """Each row of ``E2 d + E3 z <= E1 u + E4 x + E5`` with names, such as ``4*hot - z <= -x + 4``."""
    left = zip(_row_terms(mld.E2, mld.d), _row_terms(mld.E3, mld.z), strict=True)
    right = zip(_row_terms(mld.E1, mld.u), _row_terms(mld.E4, mld.x), mld.E5.tolist(), strict=True)
    return tuple(
        f"{Affine(0.0, d + z)} <= {Affine(constant, u + x)}".replace("  ", " ")
        for (d, z), (u, x, constant) in zip(left, right, strict=True)
    )


def _row_terms(matrix: csr_array, variables: Sequence[Variable]) -> list[tuple[tuple[str, float], ...]]:
    return [_terms(row, variables) for row in matrix.toarray()]


def _terms(row: Matrix, variables: Sequence[Variable]) -> tuple[tuple[str, float], ...]:
    return tuple((v.name, float(value)) for v, value in zip(variables, row, strict=True) if value)


def _equation_lines(names: list[str], mld: Mld, blocks: tuple[Matrix, ...], constants: Matrix) -> list[str]:
    groups = (mld.x, mld.u, mld.d, mld.z)
    lines = []
    for index, name in enumerate(names):
        terms = tuple(term for block, group in zip(blocks, groups, strict=True) for term in _terms(block[index], group))
        lines.append(f"{name} = {Affine(float(constants[index]), terms)}")
    return lines


def variable_lines(groups: dict[str, tuple[Variable, ...]]) -> list[str]:
    """One line for each group that has variables, with their ranges and units."""
    return [f"  {letter}: {', '.join(map(_variable_text, group))}" for letter, group in groups.items() if group]


def _variable_text(variable: Variable) -> str:
    if variable.is_bool:
        return f"{variable.name} in {{0, 1}}"
    unit = f" {variable.unit}" if variable.unit else ""
    return f"{variable.name} in [{variable.low:.12g}, {variable.high:.12g}]{unit}"


def _item_text(item: DhaItem) -> str:
    match item:
        case Event(name=name, form=form):
            return f"{name} <-> {form} <= 0"
        case Switch(name=name, condition=condition, then=then, otherwise=otherwise):
            return f"{name} = {then} if {condition} else {otherwise}"
        case AffineEquation(item=kind, name=name, value=value) | LogicEquation(item=kind, name=name, value=value):
            next_value = "'" if kind in _UPDATED else ""
            equals = "=" if isinstance(item, AffineEquation) else "<->"
            return f"{name}{next_value} {equals} {value}"
        case AffineRequirement(value=value):
            return f"must {value} <= 0"
        case LogicRequirement(value=formula):
            return f"must {formula}"
