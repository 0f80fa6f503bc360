"""Models with parameters that have no value, to forms over these parameters.

Input: a TypedModel, and a Dha that was lowered with the numbers of :func:`symbolic_values`. Output: a SymbolicMld.
Preserved: rows, their order and their origins are those of the numeric lowering, since the same code makes them, and
:meth:`SymbolicMld.bind` gives the numbers that it would give.
"""

from __future__ import annotations

from collections.abc import Mapping
from graphlib import TopologicalSorter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.big_m import Ranges
from hysdel_py.lowering.mld import equation, with_ranges
from hysdel_py.lowering.rows import Row, item_rows
from hysdel_py.semantics.arithmetic import evaluate
from hysdel_py.semantics.expressions import leaves
from hysdel_py.semantics.symbols import BIG_M_BOUND, Symbol
from hysdel_py.semantics.typed_model import TypedModel
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Variable
from hysdel_py.systems.symbolic import Symbolic, parameter
from hysdel_py.systems.symbolic_mld import SymbolicMld

__all__ = ["MAX_SIZE", "symbolic_values", "to_symbolic_mld"]

MAX_SIZE = 100_000
"""Most names, numbers and operations of one entry; ranges of long chains of switches double at each link."""

Matrix = NDArray[Any]


def symbolic_values(model: TypedModel, values: Mapping[str, float], *, every: bool = False) -> dict[str, float]:
    """Values of all real parameters, symbolic where there is no number.

    A parameter whose definition uses an open one becomes the expression over it. Predefined parameters and
    MLD_bigMbound keep their numbers, and a BOOL parameter cannot be symbolic, since rows depend on it.

    Parameters
    ----------
    values : mapping
        The values that are known.
    every : bool
        Make every declared REAL parameter symbolic, whether it has a value or not.
    """
    declared = [symbol for symbol in model.parameters if symbol.line]
    graph = {s.name: [leaf.name for leaf in leaves(s.value)] if s.value else [] for s in declared}
    known = {s.name: values[s.name] for s in model.parameters if s.name in values and not (every and _can_open(s))}
    symbols = {symbol.name: symbol for symbol in declared}
    for name in TopologicalSorter(graph).static_order():
        if name not in known and name in symbols:
            number = _open(symbols[name], known, every=every)
            known |= {} if number is None else {name: number}
    return known


def _can_open(symbol: Symbol) -> bool:
    return symbol.is_real and symbol.line > 0 and symbol.name != BIG_M_BOUND


def _open(symbol: Symbol, known: Mapping[str, float], *, every: bool) -> float | None:
    if _can_open(symbol) and (every or symbol.value is None):
        return parameter(symbol.name)
    if symbol.value is None or any(leaf.name not in known for leaf in leaves(symbol.value)):
        return None
    return evaluate(symbol.value, known)


def to_symbolic_mld(dha: Dha, sink: Sink) -> SymbolicMld:
    """Lower a Dha whose numbers may be symbolic; the result is meaningful only if the sink has not failed."""
    ranges = Ranges(dha, sink)
    rows = [row for item in dha.items for row in item_rows(item, ranges, sink)]
    updates = [equation(dha, variable, "state") for variable in dha.x]
    outputs = [equation(dha, variable, "output") for variable in dha.y]
    _refuse_large([*((row.form, row.origin) for row in rows), *updates, *outputs], sink)
    A, B1, B2, B3, B5 = _blocks([form for form, _ in updates], (dha.x, dha.u, dha.d, dha.z))
    C, D1, D2, D3, D5 = _blocks([form for form, _ in outputs], (dha.x, dha.u, dha.d, dha.z))
    E4, E1, E2, E3, E5 = _blocks([row.form for row in rows], (dha.x, dha.u, dha.d, dha.z))
    return SymbolicMld(
        dha.name,
        x=with_ranges(dha.x, ranges), u=with_ranges(dha.u, ranges), y=with_ranges(dha.y, ranges),
        d=with_ranges(dha.d, ranges), z=with_ranges(dha.z, ranges),
        A=A, B1=B1, B2=B2, B3=B3, B5=B5, C=C, D1=D1, D2=D2, D3=D3, D5=D5,
        E1=_negated(E1), E2=E2, E3=E3, E4=_negated(E4), E5=_negated(E5),
        rows=_origins(rows),
        updates=tuple(origin for _, origin in updates),
        outputs=tuple(origin for _, origin in outputs),
        source=dha.source,
        tolerances=dha.tolerances,
    )  # fmt: skip


def _refuse_large(forms: list[tuple[Affine, RowOrigin]], sink: Sink) -> None:
    for form, origin in forms:
        numbers = (form.constant, *(coefficient for _, coefficient in form.terms))
        if any(isinstance(number, Symbolic) and number.size > MAX_SIZE for number in numbers):
            sink.error(
                Code.TOO_LARGE,
                f"with open parameters a number of a row of {origin} has more than {MAX_SIZE} parts",
                help="give ranges to the auxiliaries that the item reads, or values to the parameters",
            )
            return


def _origins(rows: list[Row]) -> tuple[RowOrigin, ...]:
    return tuple(row.origin for row in rows)


def _blocks(forms: list[Affine], groups: tuple[tuple[Variable, ...], ...]) -> list[Matrix]:
    """Coefficients of forms, one matrix per group of variables, and the constants."""
    place = {v.name: (block, column) for block, group in enumerate(groups) for column, v in enumerate(group)}
    blocks = [np.full((len(forms), len(group)), 0.0, dtype=object) for group in groups]
    constants = np.full(len(forms), 0.0, dtype=object)
    for row, form in enumerate(forms):
        constants[row] = form.constant
        for name, coefficient in form.terms:
            block, column = place[name]
            blocks[block][row, column] += coefficient
    for array in (*blocks, constants):
        array.setflags(write=False)
    return [*blocks, constants]


def _negated(matrix: Matrix) -> Matrix:
    """The matrix on the other side of the inequality, without negative zeros."""
    negated = np.full(matrix.shape, 0.0, dtype=object)
    for index, entry in np.ndenumerate(matrix):
        negated[index] = -entry + 0.0
    negated.setflags(write=False)
    return negated
