"""``hysdel compile``: write the mixed logical dynamical form."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from hysdel_py.cli.arguments import add_model, add_output, load_model
from hysdel_py.cli.compile_options import check_form
from hysdel_py.cli.compile_pwa import compile_pwa
from hysdel_py.cli.output import check_target, print_json
from hysdel_py.cli.writers import FORMATS, find_writer
from hysdel_py.export.matrices import mld_to_dict
from hysdel_py.model import to_mld
from hysdel_py.systems.mld import Mld

__all__ = ["add_parser", "listing"]

_EPILOG = """\
examples:
  hysdel compile model.hys                      print sizes, variables and every row with its source line
  hysdel compile model.hys -o model.json        write matrices, names, ranges and origins as JSON
  hysdel compile model.hys -o model.npz         write matrices for numpy.load
  hysdel compile model.hys -o model.mat         write matrices for MATLAB and Octave
  hysdel compile model.hys -o model.m           write the script that HYSDEL 2.0.5 writes
  hysdel compile model.hys -o step.py           write a simulator that needs nothing but Python
  hysdel compile model.hys -o step.c            write the same in C, and step.h
  hysdel compile model.hys -o model.fmu         write a functional mock-up unit (FMI 2.0, co-simulation)
  hysdel compile model.hys --form pwa -o model.json   write the modes of the piecewise affine form
  hysdel compile model.hys --form pwa -o modes.hys    write them as a model: thresholds, modes, affine pieces
  hysdel compile model.hys --param ts=0.01 --constants aux
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "compile",
        description="Translate a model to matrices:\n"
        "  x+ = A x + B1 u + B2 d + B3 z + B5,   y = C x + D1 u + D2 d + D3 z + D5,\n"
        "  E2 d + E3 z <= E1 u + E4 x + E5",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument(
        "-o", "--output", metavar="PATH", help=f"write a file ({', '.join(FORMATS)}) instead of the listing"
    )
    parser.add_argument("--form", choices=["mld", "pwa"], default="mld", help="which form is written (default mld)")
    parser.add_argument("--merge", action="store_true", help="with --form pwa: join modes that do the same")
    parser.add_argument("--big-m", choices=["lp", "interval"],
        help="rule for the big-M constants: linear programs (default), or interval arithmetic as HYSDEL 2.0.5",
    )  # fmt: skip
    parser.add_argument(
        "--constants",
        choices=["affine", "aux", "forbid"],
        help="constant terms of updates and outputs: B5 and D5 (default), auxiliaries, or errors",
    )
    parser.add_argument("--share", action="store_true", help="merge generated Booleans of equal definition")
    parser.add_argument("--compact", action="store_true", help="leave out rows that the others imply")
    add_output(parser, "matrices, names, ranges and origins")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    options = check_form(options)
    if options.form == "pwa":
        return compile_pwa(options)
    writer = find_writer(options.output) if options.output else None
    if options.output:
        check_target(Path(options.output), "--output")
    model = load_model(options)
    mld = to_mld(model, big_m=options.big_m, constants=options.constants, share=options.share, compact=options.compact)
    if writer is not None:
        writer(model, mld, options)
    if options.json:
        print_json(mld_to_dict(mld))
    elif writer is not None:
        print(f"{options.output}: {_sizes(mld)}")
    else:
        print("\n".join(listing(mld)))
    return 0


def _sizes(mld: Mld) -> str:
    return (
        f"{mld.nx} states, {mld.nu} inputs, {mld.ny} outputs, {mld.nd} Boolean and {mld.nz} real auxiliaries, "
        f"{mld.ne} rows"
    )


def listing(mld: Mld) -> Iterator[str]:
    """The form in words: variables with ranges, equations, and rows with their source lines."""
    yield f"{mld.name}: {_sizes(mld)}"
    for key, title in (("x", "states"), ("u", "inputs"), ("y", "outputs"), ("d", "Booleans"), ("z", "reals")):
        for variable in getattr(mld, key):
            ranged = key != "y" and not variable.is_bool
            reach = f" in [{variable.low:g}, {variable.high:g}]" if ranged else ""
            yield f"  {title[:-1]:8} {variable.label}{reach}  {variable.description}".rstrip()
    yield from _equations(mld)
    yield "rows"
    left = np.hstack([mld.E2.toarray(), mld.E3.toarray(), -mld.E1.toarray(), -mld.E4.toarray()])
    names = [v.name for v in (*mld.d, *mld.z, *mld.u, *mld.x)]
    for row, right, origin in zip(left, mld.E5, mld.rows, strict=True):
        yield f"  {_sum(row, names)} <= {right:.9g}    [{origin.item} line {origin.line}]"


def _equations(mld: Mld) -> Iterator[str]:
    names = [v.name for v in (*mld.x, *mld.u, *mld.d, *mld.z)]
    blocks = (
        ("updates", "+", mld.x, (mld.A, mld.B1, mld.B2, mld.B3), mld.B5),
        ("outputs", "", mld.y, (mld.C, mld.D1, mld.D2, mld.D3), mld.D5),
    )
    for title, mark, variables, matrices, constant in blocks:
        yield title
        for variable, row, number in zip(variables, np.hstack(matrices), constant, strict=True):
            yield f"  {variable.name}{mark} = {_sum(row, names, number)}"


def _sum(row: np.ndarray[tuple[int], np.dtype[np.float64]], names: list[str], constant: float = 0.0) -> str:
    from hysdel_py.systems.affine import Affine

    return str(Affine(float(constant), tuple((n, float(c)) for n, c in zip(names, row, strict=True) if c)))
