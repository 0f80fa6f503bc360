"""The whole pipeline on one page: text -> ast -> scalar ast -> typed model -> Dha -> Mld."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.elaboration.elaborate import elaborate
from hysdel_py.elaboration.modules import load_modules
from hysdel_py.lowering.big_m import BigM
from hysdel_py.lowering.constants import Constants
from hysdel_py.lowering.dha import to_dha
from hysdel_py.lowering.lints import lint
from hysdel_py.lowering.mld import to_mld
from hysdel_py.lowering.symbolic import to_symbolic_mld
from hysdel_py.semantics.lints import note_unused_parameters
from hysdel_py.semantics.parameters import bind_parameters, missing_parameters
from hysdel_py.semantics.resolve import resolve
from hysdel_py.semantics.typed_model import TypedModel
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
    scalar, flat = elaborate(instances, given, sink)
    model = resolve(scalar, source, sink)
    values = bind_parameters(model, flat, sink)
    if recovered.lost:
        sink.forget(lambda found: _is_about(found, recovered.lost, source))
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
    dha = to_dha(model, values, constants, sink)
    sink.raise_errors(model.source)
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


def _is_about(found: Diagnostic, names: frozenset[str], source: Source) -> bool:
    """Whether a diagnostic misses one of the names whose declaration was skipped after a syntax error."""
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
        sink.raise_errors(model.source)
