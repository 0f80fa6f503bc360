"""A discrete hybrid automaton as C99: one function that makes one step, without allocation and without libm.

The result of the function tells what the step violates. A macro compiles a program that replays steps that were
computed in Python.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from hysdel_py.diagnostics.sink import Sink
from hysdel_py.errors import ArgumentError
from hysdel_py.export.c_text import chosen_prefix, comment, guard, plain, source_path
from hysdel_py.export.plant_c_step import step_body
from hysdel_py.export.plant_c_test import plant_test
from hysdel_py.export.plant_points import replay_steps
from hysdel_py.export.statements import refuse_loop, refuse_undefined
from hysdel_py.semantics.typed_model import TypedModel
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.signals import Variable
from hysdel_py.version import __version__

if TYPE_CHECKING:
    from hysdel_py.model import Model

__all__ = ["STATUS", "PlantCode", "to_c", "write_plant"]

STATUS = {"STATE_RANGE": 1, "INPUT_RANGE": 2, "MUST": 4, "INVALID": 8}
"""Bits of the result of a step."""

_MEANING = (
    "0, or the sum of",
    "{0}_STATE_RANGE  a state lies outside its range,",
    "{0}_INPUT_RANGE  an input lies outside its range,",
    "{0}_MUST         a requirement does not hold,",
    "{0}_INVALID      a number is not finite, or a Boolean is neither 0 nor 1: nothing was computed.",
    "x_next may be x; d and z (auxiliaries, events among them) may be null. Booleans are 0.0 and 1.0.",
)


@dataclass(frozen=True, slots=True)
class PlantCode:
    """What was written.

    Attributes
    ----------
    files : tuple of Path
        Source and header.
    prefix : str
    points : int
        Steps of the self-test.
    """

    files: tuple[Path, ...]
    prefix: str
    points: int


def to_c(
    model: Model | Dha, path: str | PathLike[str], *, prefix: str | None = None, points: int = 50, seed: int = 0
) -> PlantCode:
    """Write a plant as C: a source that ends in .c, and a header beside it.

    Parameters
    ----------
    model : Model or Dha
    path : str or path
        Of the source.
    prefix : str, optional
        Of all names; by default the name of the file.
    points : int
        Steps of the self-test, which is compiled where the macro ``PREFIX_SELF_TEST`` is defined.
    seed : int
        Of these steps.

    Raises
    ------
    CompileError
        An auxiliary of the model is read and undefined, or auxiliaries are defined in a circle.
    ArgumentError
        The same in a Dha without a text; a wrong path or prefix.
    """
    dha, typed = (model, None) if isinstance(model, Dha) else (model.dha, model.typed)
    return write_plant(dha, path, typed, prefix=prefix, points=points, seed=seed)


def write_plant(
    dha: Dha,
    path: str | PathLike[str],
    typed: TypedModel | None = None,
    *,
    prefix: str | None = None,
    points: int = 50,
    seed: int = 0,
) -> PlantCode:
    """Write a plant; arguments as for :func:`to_c`, and the model whose text diagnostics are about, if there is one."""
    _refuse(dha, typed)
    source = source_path(path)
    header = source.with_suffix(".h")
    name = chosen_prefix(prefix, source)
    replay = replay_steps(dha, points, seed)
    code = [f"/* One step of {plain(dha.name)}, written by hysdel_py {__version__}. */", f'#include "{header.name}"',
            "#include <float.h>", "#include <stddef.h>", "", *step_body(dha, name, _prototype(name)),
            *plant_test(dha, name, replay)]  # fmt: skip
    _write(header, _header(dha, name))
    _write(source, code)
    return PlantCode((source, header), name, len(replay))


def _refuse(dha: Dha, typed: TypedModel | None) -> None:
    """Refuse what no order of statements evaluates."""
    if typed is not None:
        sink = Sink()
        refuse_undefined(typed, dha, sink, only_used=True)
        refuse_loop(dha, sink)
        sink.raise_errors(typed.source)
    elif dha.algebraic_loop or dha.undefined_but_used:
        names = ", ".join(dha.algebraic_loop or dha.undefined_but_used)
        raise ArgumentError(f"no code can be written: {names} are undefined or depend on themselves")


def _header(dha: Dha, name: str) -> Iterator[str]:
    upper = name.upper()
    yield from comment([f"One step of {dha.name}, written by hysdel_py {__version__}.", "", *_legend(dha)])
    yield f"#ifndef {guard(name)}"
    yield f"#define {guard(name)}"
    yield ""
    for title, group in (("STATES", dha.x), ("INPUTS", dha.u), ("OUTPUTS", dha.y), ("BOOLEANS", dha.d),
                         ("REALS", dha.z)):  # fmt: skip
        yield f"#define {upper}_{title} {len(group)}"
    yield from (f"#define {upper}_{bit} {value}" for bit, value in STATUS.items())
    yield ""
    yield from comment(line.format(upper) for line in _MEANING)
    yield f"{_prototype(name)};"
    yield from ("", "#endif")


def _legend(dha: Dha) -> Iterator[str]:
    for key, group in (("x", dha.x), ("u", dha.u), ("y", dha.y), ("d", dha.d), ("z", dha.z)):
        for index, variable in enumerate(group):
            yield f"{key}[{index}]: {variable.label}{_range(key, variable)} {variable.description}"


def _range(key: str, variable: Variable) -> str:
    if variable.is_bool:
        return " in {0, 1}"
    return f" in [{variable.low:g}, {variable.high:g}]" if key in "xu" else ""


def _prototype(name: str) -> str:
    return f"int {name}_step(const double *x, const double *u, double *x_next, double *y, double *d, double *z)"


def _write(path: Path, lines: Sequence[str] | Iterator[str]) -> None:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
