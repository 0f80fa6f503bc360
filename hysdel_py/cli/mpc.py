"""``hysdel mpc``: control a model in a loop."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Any

from hysdel_py.cli.arguments import (
    add_model,
    add_output,
    add_start,
    assignments,
    given_vector,
    load_model,
    number,
    parts,
    span,
)
from hysdel_py.cli.output import add_files, check_files, clear_progress, emit_trajectory, progress_line
from hysdel_py.control.closed_loop import closed_loop
from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.errors import ArgumentError
from hysdel_py.model import Model
from hysdel_py.systems.mld import Mld

__all__ = ["add_parser", "limits_of"]

_EPILOG = """\
examples:
  hysdel mpc two_tanks --x0 0.1,0.4 --horizon 6 --weight level2=10 --ref level2=0.3 --steps 30
  hysdel mpc clutch --param we_min=60 --x0 100,70,20,0,0 --horizon 5 --weight y1=1,y2=4,y3=4 --ref y1=100 \\
      --limit y1=80: --soft y1 --node-limit 50 --steps 70 --plot run.png

Weights, references and limits name outputs, states, inputs or auxiliaries of the model; hysdel compile FILE lists them.
A weighted signal without a reference follows 0. The plant of the loop is the model itself. The exit status is 1 if the
loop ended early. In the column "status", 0 stands for a plan that is proven optimal and 1 for one that may not be.
"""

_WORDS = {"x": "states", "y": "outputs", "u": "inputs", "z": "real auxiliaries", "d": "Booleans"}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "mpc",
        help="control a model in a loop by hybrid model predictive control",
        description="Run a hybrid model predictive controller (2-norm) on its own model.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    add_start(parser)
    parser.add_argument("--horizon", type=int, default=10, metavar="N", help="steps that are planned (default 10)")
    parser.add_argument("--steps", type=int, default=20, metavar="N", help="steps of the loop (default 20)")
    for option, metavar, text in (
        ("--weight", "NAME=VALUE", "weight of a signal in the cost"),
        ("--terminal", "NAME=VALUE", "weight of a state at the end of the horizon"),
        ("--ref", "NAME=VALUE", "reference of a weighted signal"),
        ("--limit", "NAME=LOW:HIGH", "limit of an output, state or input; an end may be left out"),
        ("--soft", "NAME[=PRICE]", "allow a limit to be exceeded at a price (default 1e4)"),
    ):
        parser.add_argument(option, metavar=metavar, action="append", default=[], help=f"{text}; may be repeated")
    parser.add_argument("--backend", default="piqp", help="solver of the quadratic programs: piqp (default) or osqp")
    parser.add_argument("--time-limit", type=float, metavar="SECONDS", help="longest search per step (default none)")
    parser.add_argument("--node-limit", type=int, metavar="N", help="nodes of the branch and bound per step")
    parser.add_argument(
        "--on-failure", choices=["stop", "hold"], default="stop",
        help="when there is no plan: end the loop (default), or apply the last input again",
    )  # fmt: skip
    add_files(parser)
    add_output(parser, "the trajectory")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command; the exit status is 1 if the loop ended early."""
    check_files(options)
    model = load_model(options)
    controller = _controller(model, options)
    references = _references(options)
    x0 = given_vector(options.x0, model.mld.x, "--x0", "state")
    progress = progress_line(not options.json)
    trajectory = closed_loop(
        model, controller, x0, options.steps, references, on_failure=options.on_failure, progress=progress
    )
    clear_progress(progress)
    emit_trajectory(trajectory, model, options)
    if trajectory.steps == options.steps:
        return 0
    print(_ended_early(trajectory.steps, options), file=sys.stderr)
    return 1


def _ended_early(steps: int, options: argparse.Namespace) -> str:
    hints = ["--soft NAME softens a limit"] * bool(options.limit)
    hints += ["--on-failure hold goes on with the last input"] * (options.on_failure == "stop" and steps > 0)
    return f"hysdel mpc: the loop ended after {steps} of {options.steps} steps{'; ' * bool(hints)}{', '.join(hints)}"


def _controller(model: Model, options: argparse.Namespace) -> HybridMpc:
    weights = assignments(options.weight, "--weight")
    if not weights:
        raise ArgumentError(f"--weight is missing: say what to control, as in --weight {_example(model.mld)}=1")
    return HybridMpc(
        model,
        options.horizon,
        _cost(model.mld, weights, assignments(options.terminal, "--terminal")),
        _limits(model.mld, options),
        backend=options.backend,
        time_limit=options.time_limit,
        node_limit=options.node_limit,
    )


def _example(mld: Mld) -> str:
    return next((v.name for v in (*mld.y, *mld.x)), "NAME")


def _group_of(mld: Mld, name: str, keys: str, option: str) -> str:
    for key in keys:
        if any(v.name == name for v in getattr(mld, key)):
            return key
    known = [f"{_WORDS[key]} {', '.join(v.name for v in group)}" for key in keys if (group := getattr(mld, key))]
    raise ArgumentError(f"{option} {name}: there is no such signal; there are the {'; '.join(known)}")


def _cost(mld: Mld, weights: dict[str, float], terminal: dict[str, float]) -> Cost:
    groups: dict[str, dict[str, float]] = {}
    for name, value in weights.items():
        groups.setdefault(_group_of(mld, name, "yxuzd", "--weight"), {})[name] = value
    for name in terminal:
        _group_of(mld, name, "x", "--terminal")
    return Cost(**groups, **({"terminal": terminal} if terminal else {}))  # type: ignore[arg-type]


def _references(options: argparse.Namespace) -> dict[str, float] | None:
    references = assignments(options.ref, "--ref")
    weighted = assignments(options.weight, "--weight") | assignments(options.terminal, "--terminal")
    for name in references:
        if name not in weighted:
            raise ArgumentError(
                f"--ref {name}: it has no weight, so the reference would do nothing; give it one with "
                f"--weight {name}=VALUE (weighted are {', '.join(weighted)})"
            )
    return references or None


def limits_of(mld: Mld, texts: Sequence[str]) -> dict[str, Any]:
    """The limits of ``NAME=LOW:HIGH`` texts by vector."""
    groups: dict[str, Any] = {"x": {}, "y": {}, "u": {}}
    for name, value in parts(texts, "--limit", "NAME=LOW:HIGH"):
        if value is None:
            raise ArgumentError(f"--limit {name}: NAME=LOW:HIGH was expected, as in --limit {name}=0:1")
        groups[_group_of(mld, name, "yxu", "--limit")][name] = span(value, f"--limit {name}")
    return groups


def _limits(mld: Mld, options: argparse.Namespace) -> Limits:
    groups = limits_of(mld, options.limit)
    softened = dict(parts(options.soft, "--soft", "NAME or NAME=PRICE"))
    for name in softened:
        if name not in {**groups["x"], **groups["y"]}:
            known = ", ".join([*groups["y"], *groups["x"]]) or "none"
            raise ArgumentError(f"--soft {name}: it has no --limit as a state or output; those with one: {known}")
    prices = {name: number(price, f"--soft {name}") for name, price in softened.items() if price is not None}
    priced: dict[str, Any] = {"rho": prices} if prices else {}
    return Limits(**groups, soft=tuple(softened) if softened else False, **priced)
