"""``hysdel simulate``: run a model under given inputs."""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hysdel_py.cli.arguments import add_model, add_output, load_model, number, vector
from hysdel_py.cli.output import emit_trajectory
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Variable, as_vector

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel simulate model.hys --x0 1,0 --steps 50
  hysdel simulate model.hys --x0 level=0.5,on=1 --input pump=0.2 --steps 50 --plot run.png
  hysdel simulate model.hys --x0 1,0 --inputs inputs.csv --csv run.csv

A file of inputs has one line per step; a first line of names may give their order.
"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "simulate",
        help="run a model under given inputs",
        description="Simulate a model. States and inputs are given in the order of declaration (reals first) or by name.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument("--x0", metavar="STATE", default="", help="first state: 1,0,2 or a=1,b=0,c=2")
    source = parser.add_mutually_exclusive_group()
    source.add_argument("--input", metavar="INPUT", default="", help="constant input: 1,0 or u=1,v=0")
    source.add_argument("--inputs", metavar="FILE", help="CSV file with one line of inputs per step")
    parser.add_argument("--steps", type=int, metavar="N", help="number of steps (default: lines of the file, else 20)")
    parser.add_argument("--form", choices=["dha", "mld"], default="dha", help="which form steps (default dha)")
    parser.add_argument("--no-check", action="store_true", help="go on outside declared ranges and violated MUST")
    parser.add_argument("--csv", metavar="PATH", help="write the table to a file")
    parser.add_argument("--plot", metavar="PATH", help="write a picture (needs matplotlib)")
    add_output(parser, "the trajectory")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    model = load_model(options)
    form = getattr(model, options.form)
    x0 = as_vector(vector(options.x0, form.x, "--x0"), form.x, "state")
    inputs = _inputs(options, form.u)
    trajectory = form.simulate(x0, inputs, ts=model.sample_time, check=not options.no_check)
    emit_trajectory(trajectory, options)
    return 0


def _inputs(options: argparse.Namespace, variables: tuple[Variable, ...]) -> NDArray[np.float64]:
    steps = options.steps
    if steps is not None and steps < 0:
        raise ArgumentError(f"--steps is {steps}: zero or more was expected")
    if options.inputs:
        table = _read_table(Path(options.inputs), variables)
        if steps is not None and steps > len(table):
            raise ArgumentError(f"--steps is {steps}, but {options.inputs} has only {len(table)} lines of inputs")
        return table[:steps]
    control = as_vector(vector(options.input, variables, "--input"), variables, "input")
    return np.tile(control, (20 if steps is None else steps, 1))


def _read_table(path: Path, variables: tuple[Variable, ...]) -> NDArray[np.float64]:
    """Inputs of a CSV file in the order of the model."""
    with path.open(newline="", encoding="utf-8") as file:
        lines = [line for line in csv.reader(file) if line]
    names = [v.name for v in variables]
    order = list(range(len(names)))
    if lines and any(cell.strip() in names for cell in lines[0]):
        header = [cell.strip() for cell in lines.pop(0)]
        missing = [name for name in names if name not in header]
        if missing:
            raise ArgumentError(f"{path}: there is no column for the input {', '.join(missing)}")
        order = [header.index(name) for name in names]
    rows = []
    for index, line in enumerate(lines, start=1):
        if len(line) <= max(order, default=-1):
            raise ArgumentError(f"{path}: line {index} of inputs has {len(line)} values, {len(names)} were expected")
        rows.append([number(line[column], f"{path}, line {index}, {names[i]}") for i, column in enumerate(order)])
    return np.array(rows, dtype=float).reshape(len(rows), len(names))
