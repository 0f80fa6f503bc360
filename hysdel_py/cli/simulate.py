"""``hysdel simulate``: run a model under given inputs."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hysdel_py.cli.arguments import (
    add_model,
    add_output,
    add_start,
    example_values,
    given_vector,
    load_model,
)
from hysdel_py.cli.data_error import DataError
from hysdel_py.cli.input_file import read_inputs
from hysdel_py.cli.output import add_files, check_files, emit_trajectory
from hysdel_py.cli.progress import clear_progress, progress_line
from hysdel_py.errors import ArgumentError, Interrupted, SimulationError
from hysdel_py.systems.signals import Variable
from hysdel_py.systems.simulation import MAX_STEPS, simulate

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel simulate two_tanks --x0 0.1,0.2 --input 1e-4,1 --steps 50
  hysdel simulate two_tanks --x0 h1=0.1,h2=0.2 --input q=1e-4,valve=1 --steps 50 --plot run.png
  hysdel simulate two_tanks --x0 0.1,0.2 --inputs inputs.csv --csv run.csv

hysdel compile FILE lists the states and inputs in their order, with their ranges. A file of inputs has one line per
step. A first line of names may give the order of its columns; columns that are no inputs are then passed over.
"""

_DEFAULT_STEPS = 20
_CAN_BE_IGNORED = ("outside its range", "leaves its stated range", "MUST is violated")


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "simulate",
        description="Simulate a model. Give states and inputs in the order of declaration, reals first, or by name.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    add_start(parser)
    source = parser.add_mutually_exclusive_group()
    source.add_argument("--input", metavar="INPUT", default="", help="constant input: 1,0 or u=1,v=0")
    source.add_argument("--inputs", metavar="CSV", help="file with one line of inputs per step")
    parser.add_argument("--steps", type=int, metavar="N", help="number of steps (default: lines of the file, else 20)")
    parser.add_argument("--form", choices=["dha", "mld"], default="dha", help="which form is run (default dha)")
    parser.add_argument("--no-check", action="store_true", help="go on outside declared ranges and violated MUST")
    add_files(parser)
    add_output(parser, "the trajectory")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command; the exit status is 1 if Ctrl-C ended the run early."""
    check_files(options)
    model = load_model(options)
    form = getattr(model, options.form)
    x0 = given_vector(options.x0, form.x, "--x0", "state")
    inputs = _inputs(options, form.u)
    progress = progress_line(not options.json)
    status = 0
    try:
        trajectory = simulate(form, x0, inputs, ts=model.sample_time, check=not options.no_check, progress=progress)
    except SimulationError as error:
        raise SimulationError(_with_help(error.problems)) from None
    except Interrupted as stopped:
        trajectory, status = stopped.partial, 1
    finally:
        clear_progress(progress)
    emit_trajectory(trajectory, model, options)
    return status


def _with_help(problems: tuple[str, ...]) -> tuple[str, ...]:
    """The problems of a step and, where there is one, the way to go on all the same."""
    if all(any(words in problem for words in _CAN_BE_IGNORED) for problem in problems):
        return (*problems, "help: change the start or the inputs, or go on all the same with --no-check")
    return problems


def _inputs(options: argparse.Namespace, variables: tuple[Variable, ...]) -> NDArray[np.float64]:
    steps = options.steps
    if steps is not None and steps > MAX_STEPS:
        raise ArgumentError(f"--steps is {steps}: at most {MAX_STEPS} are simulated")
    if steps is not None and steps < 0:
        raise ArgumentError(f"--steps is {steps}: zero or more was expected")
    if options.inputs:
        table = read_inputs(Path(options.inputs), variables)
        if steps is not None and steps > len(table):
            raise DataError(f"--steps is {steps}, but {options.inputs} has only {len(table)} lines of inputs")
        return table[:steps]
    if variables and not options.input.strip():
        example = example_values(variables)
        raise ArgumentError(f"--input is missing: give a constant one, as in --input {example}, or --inputs CSV")
    control = given_vector(options.input, variables, "--input", "input")
    return np.tile(control, (_DEFAULT_STEPS if steps is None else steps, 1))
