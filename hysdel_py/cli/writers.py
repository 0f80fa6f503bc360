"""Files that ``hysdel compile --output`` writes, by the end of their name."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from hysdel_py.errors import ArgumentError
from hysdel_py.export.compiled import Compiled
from hysdel_py.export.matlab import MatlabOptions, matlab_text
from hysdel_py.export.matrices import write_json, write_mat, write_npz
from hysdel_py.export.plant_c import write_plant
from hysdel_py.export.simulator_python import module_text
from hysdel_py.lowering.constants import Constants
from hysdel_py.model import Model, to_dha, to_mld
from hysdel_py.systems.mld import Mld

if TYPE_CHECKING:
    from hysdel_py.export.fmu import FmuFile

__all__ = ["FORMATS", "find_writer", "report_unit"]

Writer = Callable[[Model, Mld, argparse.Namespace], None]


def find_writer(path: str) -> Writer:
    """Writer for a file name.

    Raises
    ------
    ArgumentError
        The name ends in nothing that is known.
    """
    writer = FORMATS.get(Path(path).suffix)
    if writer is None:
        *others, last = FORMATS
        raise ArgumentError(f"--output {path}: a name that ends in {', '.join(others)} or {last} was expected")
    return writer


def _python(model: Model, mld: Mld, options: argparse.Namespace) -> None:  # noqa: ARG001 -- the Dha is written
    text = module_text(model.typed, to_dha(model, constants=options.constants))
    Path(options.output).write_text(text, encoding="utf-8")


def _matlab(model: Model, mld: Mld, options: argparse.Namespace) -> None:
    constants = Constants(options.constants)
    # The numbers of that script are those of the interval rule, whatever else was asked for.
    mld = to_mld(model, big_m="interval", constants=options.constants)
    compiled = Compiled(model.typed, model.parameters, to_dha(model, constants=options.constants), mld, constants)
    Path(options.output).write_text(matlab_text(compiled, MatlabOptions()), encoding="utf-8")


def _c(model: Model, mld: Mld, options: argparse.Namespace) -> None:  # noqa: ARG001 -- the Dha is written
    write_plant(to_dha(model, constants=options.constants), options.output, model.typed)


def _fmu(model: Model, mld: Mld, options: argparse.Namespace) -> None:  # noqa: ARG001 -- the Dha is written
    from hysdel_py.export.fmu import to_fmu  # units hold controllers too, which no other format needs

    system = model if options.constants == Constants.AFFINE.value else to_dha(model, constants=options.constants)
    report_unit(to_fmu(system, options.output, sample_time=model.sample_time))


def report_unit(written: FmuFile) -> None:
    """Say so on the error stream if a unit holds no library."""
    if written.message:
        print(f"{written.path}: {written.message}", file=sys.stderr)


FORMATS: dict[str, Writer] = {
    ".json": lambda _, mld, options: write_json(mld, options.output),
    ".npz": lambda _, mld, options: write_npz(mld, options.output),
    ".mat": lambda _, mld, options: write_mat(mld, options.output),
    ".m": _matlab,
    ".py": _python,
    ".c": _c,
    ".fmu": _fmu,
}
"""Writer for each end of a file name."""
