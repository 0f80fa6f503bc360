"""``hysdel compile --form pwa``: write the piecewise affine form."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from hysdel_py.cli.arguments import load_model
from hysdel_py.cli.output import check_target, print_json
from hysdel_py.errors import ArgumentError
from hysdel_py.export.hysdel_text import hysdel_text
from hysdel_py.export.pwa_data import pwa_to_dict, write_pwa_json
from hysdel_py.lowering.modes_to_dha import pwa_to_dha
from hysdel_py.systems.pwa import Pwa

__all__ = ["PWA_FORMATS", "compile_pwa"]


def _write_text(pwa: Pwa, path: str) -> None:
    Path(path).write_text(hysdel_text(pwa_to_dha(pwa)), encoding="utf-8")


PWA_FORMATS: dict[str, Callable[[Pwa, str], None]] = {".json": write_pwa_json, ".hys": _write_text}
"""Writer for each end of a file name."""


def compile_pwa(options: argparse.Namespace) -> int:
    """Find the modes and write, print or list them."""
    writer = PWA_FORMATS.get(Path(options.output).suffix) if options.output else None
    if options.output and writer is None:
        names = " or ".join(PWA_FORMATS)
        raise ArgumentError(f"--output {options.output}: with --form pwa a name that ends in {names} was expected")
    if options.output:
        check_target(Path(options.output), "--output")
    model = load_model(options)
    pwa = model.pwa.merge() if options.merge else model.pwa
    if writer is not None:
        writer(pwa, options.output)
    if options.json:
        print_json(pwa_to_dict(pwa))
    elif writer is not None:
        print(f"{options.output}: {len(pwa.modes)} modes with {len(pwa.dynamics)} different dynamics")
    else:
        print(pwa.describe(), end="")
    return 0
