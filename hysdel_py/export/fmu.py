"""Functional mock-up units (FMI 2.0, co-simulation): a plant or an explicit law for other simulators.

A unit is a zip file with a model description, the C sources, and the library for this platform where a compiler is
present.
"""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from os import PathLike, environ
from pathlib import Path
from typing import TYPE_CHECKING

from hysdel_py.errors import ArgumentError
from hysdel_py.export.c_text import prefix_of
from hysdel_py.export.fmu_description import description_text, guid_of, header_lines
from hysdel_py.export.fmu_model import FmuModel, fmu_model

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hysdel_py.control.explicit_law import ExplicitLaw
    from hysdel_py.control.hybrid_law import HybridLaw
    from hysdel_py.model import Model
    from hysdel_py.systems.dha import Dha

__all__ = ["FmuFile", "find_compiler", "to_fmu", "unit_path"]

_COMPILERS = ("cc", "gcc", "clang")
_FLAGS = ("-std=c99", "-O2", "-shared", "-fPIC", "-fvisibility=hidden")
_DATE = (1980, 1, 1, 0, 0, 0)
_WORD = {"x86_64": "64", "amd64": "64", "i386": "32", "i686": "32"}
_TAKEN = ("fmi2", "fmu_model", "float", "math", "stddef", "stdint", "string", "limits")
_SYSTEMS = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib"), "win32": ("win", ".dll")}


@dataclass(frozen=True, slots=True)
class FmuFile:
    """What was written.

    Attributes
    ----------
    path : Path
    platform : str
        Of the library inside, as ``linux64``; empty where there is none.
    message : str
        Why there is no library, empty where there is one.
    """

    path: Path
    platform: str
    message: str


def to_fmu(
    system: Model | Dha | ExplicitLaw | HybridLaw,
    path: str | PathLike[str],
    *,
    x0: ArrayLike | Mapping[str, float] | None = None,
    sample_time: float | None = None,
    compiler: str | None = "auto",
) -> FmuFile:
    """Write a plant or an explicit law as a functional mock-up unit.

    Parameters
    ----------
    system : Model, Dha, ExplicitLaw or HybridLaw
        The unit of a plant has its inputs, outputs (the states where there are none), and as local variables states and
        auxiliaries. That of a law has the parameters as inputs and the moves as outputs; the moves applied last are its
        states.
    path : str or path
        Ends in .fmu; the name is the model identifier.
    x0 : array_like or mapping, optional
        First states, which an importer may change; by default 0 or the nearest allowed value.
    sample_time : float, optional
        That of the model or the controller by default.
    compiler : str or None
        Command of a C compiler. ``"auto"`` takes the variable CC, else cc, gcc or clang, and leaves the library out
        where there is none; None leaves it out.

    Raises
    ------
    ArgumentError
        Wrong arguments, or the compiler fails.
    CompileError
        The model has no step function.

    Examples
    --------
    >>> import hysdel_py as hys
    >>> hys.to_fmu(hys.load("two_tanks"), "two_tanks.fmu", compiler=None).message
    'no library was asked for: importers have to compile the sources'
    """
    target = unit_path(path)
    prefix = _identifier(target)
    model = fmu_model(system, x0, sample_time)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sources = _write_sources(model, folder, prefix)
        guid = guid_of(model, [(folder / source).read_text(encoding="utf-8") for source in sources])
        _write(folder / "fmu_model.h", "\n".join(header_lines(model, prefix, guid)) + "\n")
        units = [source for source in sources if source.endswith(".c")]
        _write(folder / "modelDescription.xml", description_text(model, prefix, guid, units))
        library, message = _library(folder, units, prefix, compiler)
        _pack(target, folder, [*sources, "fmu_model.h"], library)
    return FmuFile(target, _platform()[0] if library else "", message)


def unit_path(path: str | PathLike[str]) -> Path:
    """Path of a unit.

    Raises
    ------
    ArgumentError
        It is no path, does not end in .fmu, is a folder, or its own folder does not exist.
    """
    if not isinstance(path, str | PathLike):
        raise ArgumentError(f"path is {path!r}: a name that ends in .fmu was expected")
    target = Path(path)
    if target.suffix != ".fmu":
        raise ArgumentError(f"{target}: a name that ends in .fmu was expected")
    if not target.parent.is_dir():
        raise ArgumentError(f"{target}: the folder {target.parent} does not exist")
    if target.is_dir():
        raise ArgumentError(f"{target}: this is a folder, a file was expected")
    return target


def _identifier(target: Path) -> str:
    """Model identifier; the sources that are named after it are neither ours nor headers of C."""
    prefix = prefix_of(target)
    return f"c_{prefix}" if prefix.lower() in _TAKEN else prefix


def _write_sources(model: FmuModel, folder: Path, prefix: str) -> list[str]:
    interface = (files("hysdel_py.export") / "assets" / "fmi2.c").read_text(encoding="utf-8")
    _write(folder / "fmi2.c", interface)
    return ["fmi2.c", *(file.name for file in model.write_step(folder, prefix))]


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="\n")


def find_compiler(compiler: str | None) -> str | None:
    """Path of a C compiler, None where there is none.

    Raises
    ------
    ArgumentError
        A compiler was named and does not exist.
    """
    if compiler is None:
        return None
    if not isinstance(compiler, str):
        raise ArgumentError(f'compiler is {compiler!r}: a command, "auto" or None was expected')
    if compiler != "auto":
        found = shutil.which(compiler)
        if found is None:
            raise ArgumentError(f"compiler is {compiler!r}: there is no such command")
        return found
    names = (environ["CC"], *_COMPILERS) if environ.get("CC") else _COMPILERS
    return next((found for name in names if (found := shutil.which(name))), None)


def _library(folder: Path, units: Sequence[str], prefix: str, compiler: str | None) -> tuple[Path | None, str]:
    """The compiled library, or why there is none."""
    if compiler is None:
        return None, "no library was asked for: importers have to compile the sources"
    command = find_compiler(compiler)
    if command is None:
        return None, "no C compiler was found (CC, cc, gcc, clang): importers have to compile the sources"
    library = folder / f"{prefix}{_platform()[1]}"
    done = subprocess.run(
        [command, *_FLAGS, *units, "-o", library.name], cwd=folder, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise ArgumentError(f"{command} does not compile the sources: {done.stderr.strip() or done.stdout.strip()}")
    return library, ""


def _platform() -> tuple[str, str]:
    """Name of this platform in a unit, and the end of the names of its libraries."""
    name, suffix = _SYSTEMS.get(sys.platform, (sys.platform, ".so"))
    machine = platform.machine().lower()
    return (f"{name}{_WORD[machine]}" if machine in _WORD else f"{machine}-{name}"), suffix


def _pack(target: Path, folder: Path, sources: Sequence[str], library: Path | None) -> None:
    """The zip file; the same contents give the same bytes."""
    entries = {"modelDescription.xml": folder / "modelDescription.xml"}
    entries |= {f"sources/{source}": folder / source for source in sorted(sources)}
    if library is not None:
        entries[f"binaries/{_platform()[0]}/{library.name}"] = library
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, file in entries.items():
            archive.writestr(zipfile.ZipInfo(name, _DATE), file.read_bytes(), zipfile.ZIP_DEFLATED)
