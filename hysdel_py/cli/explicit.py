"""``hysdel explicit``: the explicit law of a hybrid controller."""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import asdict
from math import inf
from pathlib import Path
from typing import Any

from hysdel_py.cli.arguments import add_model, add_output, assignments, load_model
from hysdel_py.cli.controller import add_demands, add_shape, all_limits, blocking_of, cost_of, references_of, spans
from hysdel_py.cli.output import PICTURES, check_picture, check_target, print_json
from hysdel_py.cli.progress import clear_progress, counter
from hysdel_py.cli.writers import report_unit
from hysdel_py.control.explicit_hybrid import explicit_hybrid
from hysdel_py.control.hybrid_certificate import HybridCertificate
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.errors import ArgumentError
from hysdel_py.export.c_text import source_path
from hysdel_py.export.fmu import to_fmu, unit_path
from hysdel_py.model import Model
from hysdel_py.optimize.mpmiqp import MpMiqpSettings

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel explicit two_tanks --horizon 2 --weight level2=10,q=0.1 --box "r(level2)=0.1:0.4" --out law.npz
  hysdel explicit two_tanks --horizon 2 --weight level2=10 --ref level2=0.3 --norm 1 --describe

The parameters are the states, the inputs applied last where changes are weighed or limited, as in "q(-1)", and the
references that have a --box, as in "r(level2)"; --ref fixes a reference, and other references are 0. States without a
--box have their declared range. Ctrl-C and --time-limit end the search with the law of what was found. The law is
compared with the controller at --samples random points.
The exit status is 1 if the law is incomplete or differs from the controller.
"""


_WRITERS = (
    ("--c", "FILE.c", "write the law as C, with a header beside it"),
    ("--python", "FILE.py", "write the law as a Python module that needs nothing but Python"),
    ("--latex", "FILE.tex", "write the law as LaTeX tables"),
    ("--plot", "FILE.png", f"draw the law over two real parameters ({', '.join(PICTURES)}; needs matplotlib)"),
    ("--fmu", "FILE.fmu", "write the law as a functional mock-up unit (FMI 2.0, co-simulation)"),
)


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "explicit",
        description="Solve a hybrid model predictive controller for all its parameters at once.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument("--horizon", type=int, default=2, metavar="N", help="steps that are planned (default 2)")
    add_demands(parser)
    add_shape(parser)
    for option, metavar, text in (
        ("--box", "NAME=LOW:HIGH", "range of a parameter"),
        ("--fix", "NAME=VALUE", "a parameter that is put in as a number"),
    ):
        parser.add_argument(option, metavar=metavar, action="append", default=[], help=f"{text}; may be repeated")
    parser.add_argument("--out", metavar="FILE.npz", help="write the law")
    for option, name, text in _WRITERS:
        parser.add_argument(option, metavar=name, help=text)
    parser.add_argument(
        "--section", metavar="NAME=VALUE", action="append", default=[],
        help="a parameter that --plot puts at this value instead of the middle of its box; may be repeated",
    )  # fmt: skip
    parser.add_argument("--describe", action="store_true", help="print every region with its rows and moves")
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="processes that search (default 1)")
    parser.add_argument("--time-limit", type=float, metavar="SECONDS", help="end the search after this (default none)")
    parser.add_argument("--keep-overlaps", action="store_true", help="do not remove regions that are never best")
    parser.add_argument(
        "--samples", type=int, default=50, metavar="N", help="points of the comparison with the controller (default 50)"
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of these points (default 0)")
    add_output(parser, "the summary")
    parser.set_defaults(run=run, compiles=True)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    _check(options)
    model = load_model(options)
    mpc = _controller(model, options)
    law = _law(mpc, options)
    _write(law, options)
    certificate = law.certificate(mpc, options.samples, options.seed) if options.samples else None
    if options.json:
        print_json(_summary(law, certificate))
    else:
        print(law.describe(options.describe), end="")
        print("\n".join(_words(certificate)))
    return 0 if law.complete and (certificate is None or certificate.holds()) else 1


def _write(law: HybridLaw, options: argparse.Namespace) -> None:
    """Write the law in every form that is asked for."""
    if options.out:
        law.save(options.out)
    if options.c:
        law.to_c(options.c)
    if options.python:
        law.to_python(options.python)
    if options.latex:
        law.to_latex(options.latex)
    if options.plot:
        law.plot(section=assignments(options.section, "--section")).savefig(options.plot)
    if options.fmu:
        report_unit(to_fmu(law, options.fmu))


def _check(options: argparse.Namespace) -> None:
    for option in ("out", "c", "python", "latex", "fmu"):
        if target := getattr(options, option):
            check_target(Path(target), f"--{option}")
    check_picture(options.plot, "--plot")
    if options.section and not options.plot:
        raise ArgumentError("--section says what --plot shows: add --plot FILE.png, or leave --section out")
    if options.c:
        source_path(options.c)
    if options.fmu:
        unit_path(options.fmu)
    for name, least in (("workers", 1), ("samples", 0), ("seed", 0)):
        if getattr(options, name) < least:
            raise ArgumentError(f"--{name} is {getattr(options, name)}: a number of at least {least} was expected")
    if options.time_limit is not None and not options.time_limit > 0:
        raise ArgumentError(f"--time-limit is {options.time_limit:g}: a positive number was expected")


def _controller(model: Model, options: argparse.Namespace) -> HybridMpc:
    return HybridMpc(
        model,
        options.horizon,
        cost_of(model.mld, options),
        all_limits(model.mld, options),
        blocking=blocking_of(options),
        control_horizon=options.control_horizon,
        binary_horizon=options.binary_horizon,
    )


def _law(mpc: HybridMpc, options: argparse.Namespace) -> HybridLaw:
    fixed = assignments(options.fix, "--fix")
    fixed |= {f"r({name})": value for name, value in (references_of(options) or {}).items()}
    workers = ProcessPoolExecutor(options.workers) if options.workers > 1 else nullcontext()
    progress = counter(not options.json, "{} sequences solved, {} regions, {} sequences waiting")
    with workers as pool:
        law = explicit_hybrid(
            mpc,
            spans(options.box, "--box"),
            fixed=fixed,
            executor=pool,
            progress=progress,
            settings=MpMiqpSettings(seconds=inf if options.time_limit is None else options.time_limit),
            reduce=not options.keep_overlaps,
        )
    clear_progress(progress)
    return law


def _summary(law: HybridLaw, certificate: HybridCertificate | None) -> dict[str, Any]:
    return {
        "complete": law.complete,
        "partition": law.partition,
        "parameters": list(law.names),
        "sequences": len(law.sequences),
        "regions": law.count,
        "search": asdict(law.report),
        "certificate": None if certificate is None else asdict(certificate) | {"holds": certificate.holds()},
    }


def _words(certificate: HybridCertificate | None) -> list[str]:
    if certificate is None:
        return []
    c = certificate
    return [
        f"certificate {'holds' if c.holds() else 'FAILS'}: {c.samples} random points, {c.feasible} with a plan, "
        f"{c.infeasible} without, {c.undecided} undecided",
        f"  {c.missing} missing, {c.superfluous} superfluous, cost outside the proven interval by at most "
        f"{c.cost_error:.2g}, greatest difference {c.difference:.2g} (relative)",
    ]
