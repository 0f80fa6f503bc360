"""Dha to Mld.

Input: a Dha. Output: an Mld with the rows of the original compiler, item after item in the order of the Dha. Preserved:
for every state and input inside the declared ranges, next state, output and auxiliaries; only the gap of width epsilon
on the false side of each event is lost. Every row carries the item it came from.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.big_m import BigM, Ranges, Rule
from hysdel_py.lowering.rows import Row, item_rows
from hysdel_py.lowering.tightening import tighten
from hysdel_py.syntax.source import Span
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, Dha, LogicEquation
from hysdel_py.systems.formula import Formula
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import Origin, RowOrigin
from hysdel_py.systems.signals import Variable

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = ["MAX_DENSE_ENTRIES", "assemble", "equation", "to_mld", "with_ranges"]

MAX_DENSE_ENTRIES = 50_000_000
"""Largest number of entries of the dense update and output matrices together (400 MB)."""


def to_mld(
    dha: Dha,
    big_m: BigM,
    sink: Sink,
    declared: Mapping[str, Span] | None = None,
) -> Mld | None:
    """Lower a Dha; None where the model is too large for dense matrices, which is an error in the sink.

    Parameters
    ----------
    declared : mapping of name to Span, optional
        Where variables are declared, to be shown beside a missing range.
    """
    columns = dha.x + dha.u + dha.d + dha.z
    if (len(dha.x) + len(dha.y)) * len(columns) > MAX_DENSE_ENTRIES:
        sink.error(
            Code.TOO_LARGE,
            f"{len(dha.x)} states and {len(dha.y)} outputs over {len(columns)} variables: the matrices would hold more "
            f"than {MAX_DENSE_ENTRIES} entries",
        )
        return None
    ranges = Ranges(dha, sink, declared)
    return assemble(dha, ranges if big_m is BigM.INTERVAL else tighten(dha, ranges, sink), sink)


def assemble(dha: Dha, rule: Rule, sink: Sink) -> Mld:
    """Rows with the constants of a rule, and the matrices; meaningful only if the sink has not failed."""
    rows = [row for item in dha.items for row in item_rows(item, rule, sink)]
    A, B1, B2, B3, B5, updates = _equations(dha, dha.x, "state")
    C, D1, D2, D3, D5, outputs = _equations(dha, dha.y, "output")
    E1, E2, E3, E4, E5 = _inequalities(dha, rows)
    return Mld(
        dha.name,
        x=with_ranges(dha.x, rule), u=with_ranges(dha.u, rule), y=with_ranges(dha.y, rule),
        d=with_ranges(dha.d, rule), z=with_ranges(dha.z, rule),
        A=A, B1=B1, B2=B2, B3=B3, B5=B5, C=C, D1=D1, D2=D2, D3=D3, D5=D5, E1=E1, E2=E2, E3=E3, E4=E4, E5=E5,
        rows=tuple(row.origin for row in rows),
        updates=updates,
        outputs=outputs,
        source=dha.source,
        tolerances=dha.tolerances,
    )  # fmt: skip


def with_ranges(group: tuple[Variable, ...], rule: Rule) -> tuple[Variable, ...]:
    """Variables with their ranges as far as these can be known."""
    known = [(variable, *rule.of_variable(variable.name)) for variable in group]
    return tuple(replace(variable, low=low, high=high) for variable, low, high in known)


# ---- matrices ---------------------------------------------------------------------------------------------------

_Matrix = NDArray[np.float64]


def _equations(
    dha: Dha, variables: tuple[Variable, ...], what: str
) -> tuple[_Matrix, _Matrix, _Matrix, _Matrix, _Matrix, tuple[RowOrigin, ...]]:
    """Rows of the update or output equations over (x, u, d, z, 1), and their origins."""
    groups = (dha.x, dha.u, dha.d, dha.z)
    place = _places(groups)
    blocks = [np.zeros((len(variables), len(group))) for group in groups]
    constant = np.zeros(len(variables))
    origins = []
    for row, variable in enumerate(variables):
        form, origin = equation(dha, variable, what)
        origins.append(origin)
        constant[row] = form.constant
        for name, coefficient in form.terms:
            block, column = place[name]
            blocks[block][row, column] += coefficient
    for array in (*blocks, constant):
        array.setflags(write=False)
    A, B1, B2, B3 = blocks
    return A, B1, B2, B3, constant, tuple(origins)


def equation(dha: Dha, variable: Variable, what: str) -> tuple[Affine, RowOrigin]:
    """Right side and origin of an update or output; zero where nothing defines it."""
    definition = dha.definitions.get(variable.name)
    if isinstance(definition, AffineEquation | LogicEquation):
        form = definition.value if isinstance(definition, AffineEquation) else _literal_form(definition.value)
        return form, definition.origin.row(definition.item, variable.name, 1)
    return Affine(), Origin(text=f"{what} {variable.name} is never defined").row("", variable.name, 1)


def _literal_form(formula: Formula) -> Affine:
    """A Boolean update that is a literal or a truth value, as an affine form."""
    literal = formula.literal
    if literal is None:
        return Affine(float(formula.postfix[0] is True))
    variable = Affine(0.0, ((literal.name, 1.0),))
    return variable if literal.positive else Affine(1.0) - variable


def _places(groups: tuple[tuple[Variable, ...], ...]) -> Mapping[str, tuple[int, int]]:
    return {v.name: (block, column) for block, group in enumerate(groups) for column, v in enumerate(group)}


def _inequalities(dha: Dha, rows: list[Row]) -> tuple[csr_array, csr_array, csr_array, csr_array, _Matrix]:
    """Rows as E2 d + E3 z <= E1 u + E4 x + E5."""
    from scipy.sparse import csr_array

    groups = (dha.u, dha.d, dha.z, dha.x)
    signs = (-1.0, 1.0, 1.0, -1.0)
    place = _places(groups)
    entries: list[tuple[list[int], list[int], list[float]]] = [([], [], []) for _ in groups]
    for index, row in enumerate(rows):
        for name, coefficient in row.form.terms:
            if coefficient:
                block, column = place[name]
                i, j, values = entries[block]
                i.append(index)
                j.append(column)
                values.append(signs[block] * coefficient)
    E1, E2, E3, E4 = (
        csr_array((values, (i, j)), shape=(len(rows), len(group)), dtype=float)
        for (i, j, values), group in zip(entries, groups, strict=True)
    )
    E5 = np.array([-row.form.constant + 0.0 for row in rows], dtype=float)
    E5.setflags(write=False)
    return E1, E2, E3, E4, E5
