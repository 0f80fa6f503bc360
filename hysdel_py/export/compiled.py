"""A model in all its forms, as the writers of the original's files need it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hysdel_py import compiler
from hysdel_py.diagnostics.diagnostic import Diagnostic
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.big_m import BigM, Ranges
from hysdel_py.lowering.constants import Constants
from hysdel_py.lowering.rows import item_rows
from hysdel_py.lowering.symbolic import symbolic_values
from hysdel_py.semantics.typed_model import TypedModel
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.symbolic import Symbolic
from hysdel_py.systems.symbolic_mld import SymbolicMld

__all__ = ["Compiled", "compile_model", "needed_ranges"]


@dataclass(frozen=True, slots=True)
class Compiled:
    """A typed model with the values of its parameters, and what it was lowered to.

    `mld` is symbolic if a parameter is; `values` then holds symbolic numbers.
    """

    typed: TypedModel
    values: Mapping[str, float]
    dha: Dha
    mld: Mld | SymbolicMld
    constants: Constants


def compile_model(
    typed: TypedModel, values: Mapping[str, float], constants: Constants, *, every: bool = False
) -> tuple[Compiled, tuple[Diagnostic, ...]]:
    """Lower a model; parameters without value, or all real ones with `every`, stay open.

    Raises
    ------
    CompileError
    """
    numbers = symbolic_values(typed, values, every=every)
    dha, found = compiler.lower_to_dha(typed, numbers, constants)
    mld: Mld | SymbolicMld
    if any(isinstance(number, Symbolic) for number in numbers.values()):
        mld, more = compiler.lower_to_symbolic_mld(typed, dha)
    else:
        mld, more = compiler.lower_to_mld(typed, dha, BigM.INTERVAL)
    return Compiled(typed, numbers, dha, mld, constants), (*found, *more)


def needed_ranges(dha: Dha) -> Mapping[str, tuple[float, float]]:
    """Ranges that are declared, or that the rows of some item needed; the original writes these only."""
    ranges = Ranges(dha, Sink())
    for item in dha.items:
        for _ in item_rows(item, ranges, Sink()):
            pass
    return ranges.known
