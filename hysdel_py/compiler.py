"""The whole pipeline on one page: text -> ast -> scalar ast -> typed model -> Dha -> Mld."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.elaboration.elaborate import Instance, elaborate
from hysdel_py.elaboration.modules import load_modules
from hysdel_py.lowering.big_m import BigM
from hysdel_py.lowering.constants import Constants
from hysdel_py.lowering.dha import to_dha
from hysdel_py.lowering.lints import lint
from hysdel_py.lowering.mld import to_mld
from hysdel_py.lowering.sound_items import report_on_sound_items
from hysdel_py.lowering.symbolic import to_symbolic_mld
from hysdel_py.semantics.lints import note_unused_parameters
from hysdel_py.semantics.mixed_logic import warn_of_mixed_logic
from hysdel_py.semantics.parameters import bind_parameters, missing_parameters
from hysdel_py.semantics.resolve import resolve
from hysdel_py.semantics.symbols import BIG_M_BOUND
from hysdel_py.semantics.typed_model import TypedModel
from hysdel_py.syntax import ast
from hysdel_py.syntax.parser import parse_what_is_sound
from hysdel_py.syntax.reader import read_source
from hysdel_py.syntax.source import Source
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.symbolic_mld import SymbolicMld

__all__ = ["analyse", "lower_dha_to_mld", "lower_to_dha", "lower_to_mld", "lower_to_symbolic_mld"]


def analyse(
    path_or_text: str | os.PathLike[str], given: Mapping[str, object], search_path: Sequence[Path] = ()
) -> tuple[TypedModel, dict[str, float], tuple[Diagnostic, ...]]:
    """Everything that needs no lowering: parse, find modules, elaborate, resolve names, check types, bind parameters.

    `search_path` holds folders for the files of modules, besides the folder of the file that names them.

    Returns
    -------
    model, values, diagnostics
        The typed model, the values of its parameters as far as they are known, and warnings and notes.

    Raises
    ------
    CompileError
        With all errors that were found.
    """
    sink = Sink()
    source = read_source(path_or_text, sink)
    sink.raise_errors(source)
    recovered = parse_what_is_sound(source, sink)
    if recovered.system is None:
        sink.raise_errors(source)
    assert recovered.system is not None  # a failed parse has reported an error
    instances, source = load_modules(recovered.system, source, search_path, sink)
    for system in {id(instance.system): instance.system for instance in instances}.values():
        warn_of_mixed_logic(system, sink)
    scalar, flat = elaborate(instances, given, sink)
    model = resolve(scalar, source, sink)
    values = bind_parameters(model, flat, sink)
    modules = _lost_modules(instances)
    if recovered.lost or modules:
        sink.forget(lambda found: _is_about(found, recovered.lost, modules, source))
    if sink.failed:
        report_on_sound_items(model, values, sink, _without_range(scalar, model))
    if BIG_M_BOUND in recovered.lost:  # what it would have given a range is not known
        sink.forget(lambda found: found.code in (Code.NO_BOUNDS, Code.CIRCULAR_BOUNDS))
    sink.raise_errors(source)
    note_unused_parameters(model, sink)
    return model, values, sink.diagnostics


def lower_to_dha(
    model: TypedModel, values: Mapping[str, float], constants: Constants
) -> tuple[Dha, tuple[Diagnostic, ...]]:
    """Lower to a Dha; all parameters that are used need a value now.

    Raises
    ------
    CompileError
    """
    sink = Sink()
    _require_parameters(model, values, sink)
    dha = None if sink.failed else to_dha(model, values, constants, sink)
    if sink.failed:
        report_on_sound_items(model, values, sink)
    sink.raise_errors(model.source)
    assert dha is not None  # a missing parameter has been reported
    return dha, sink.diagnostics


def lower_to_mld(model: TypedModel, dha: Dha, big_m: BigM) -> tuple[Mld, tuple[Diagnostic, ...]]:
    """Lower to the MLD form; warnings come with it.

    Raises
    ------
    CompileError
    """
    sink = Sink()
    declared = {symbol.name: symbol.span for symbol in model.symbols if symbol.line}
    mld = to_mld(dha, big_m, sink, declared)
    sink.raise_errors(model.source)
    lint(model, dha, sink)
    assert mld is not None  # a failed lowering has reported an error
    return mld, sink.diagnostics


def lower_dha_to_mld(dha: Dha, big_m: BigM) -> Mld:
    """Lower a Dha that was made by something else than a text.

    Raises
    ------
    CompileError
        A range is missing, or the result is too large.
    """
    sink = Sink()
    mld = to_mld(dha, big_m, sink)
    sink.raise_errors(Source(dha.source or f"<{dha.name}>", ""))
    assert mld is not None  # a failed lowering has reported an error
    return mld


def lower_to_symbolic_mld(model: TypedModel, dha: Dha) -> tuple[SymbolicMld, tuple[Diagnostic, ...]]:
    """Lower a Dha whose numbers may wait for parameters; warnings come with it.

    Raises
    ------
    CompileError
    """
    sink = Sink()
    mld = to_symbolic_mld(dha, sink)
    sink.raise_errors(model.source)
    return mld, sink.diagnostics


def _lost_modules(instances: tuple[Instance, ...]) -> tuple[str, ...]:
    """Prefixes of the names in modules whose files were not found or not understood."""
    found = {instance.prefix for instance in instances}
    declared = (f"{i.prefix}{module.name.name}." for i in instances for module in i.system.modules)
    return tuple(prefix for prefix in declared if prefix not in found)


def _without_range(system: ast.System, model: TypedModel) -> frozenset[str]:
    """Names whose declared range is wrong."""
    ranged = {d.name for section in system.declarations for d in section.declarations if d.interval is not None}
    return frozenset(symbol.name for symbol in model.symbols if symbol.bounds is None and symbol.name in ranged)


def _is_about(found: Diagnostic, names: frozenset[str], modules: tuple[str, ...], source: Source) -> bool:
    """Whether a diagnostic misses a name that was skipped after a syntax error, or one of a lost module."""
    if found.code is Code.UNDECLARED and found.message.startswith(modules):
        return True
    if found.code is Code.PARAMETER_UNKNOWN:
        return found.message.rpartition(" ")[2] in names
    return (
        found.code is Code.UNDECLARED
        and found.span is not None
        and source.text[found.span.start : found.span.end] in names
    )


def _require_parameters(model: TypedModel, values: Mapping[str, float], sink: Sink) -> None:
    missing = missing_parameters(model, values)
    if missing:
        names = [symbol.name for symbol in missing]
        sink.error(
            Code.PARAMETER_MISSING,
            f"{'a value is' if len(names) == 1 else 'values are'} missing for the parameter{'s' * (len(names) > 1)} "
            + ", ".join(names),
            missing[0].span,
            help=f"give it in the file, by keyword ({names[0]}=...) or by --param {names[0]}=VALUE",
        )
