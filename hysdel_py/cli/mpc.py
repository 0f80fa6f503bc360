"""``hysdel mpc``: control a model in a loop."""

from __future__ import annotations

import argparse
import sys
from typing import Any


from hysdel_py.cli.arguments import add_model, add_output, assignments, load_model, span, vector
from hysdel_py.cli.output import emit_trajectory
from hysdel_py.control.closed_loop import closed_loop
from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import as_vector

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel mpc two_tanks --x0 0.1,0.4 --horizon 6 --weight h2=10 --ref h2=0.3 --steps 30
  hysdel mpc clutch --param we_min=60 --x0 100,70,20,0,0 --horizon 10 --weight y1=1,y2=4,y3=4 --ref y1=100 \\
      --limit y1=80:200 --soft y1 --node-limit 50 --steps 80 --plot run.png

Weights, references and limits name outputs, states, inputs or auxiliaries of the model. A weighted signal without a
reference follows 0. The plant of the loop is the model itself.
"""


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
    parser.add_argument("--x0", metavar="STATE", default="", help="first state: 1,0,2 or a=1,b=0,c=2")
    parser.add_argument("--horizon", type=int, default=10, metavar="N", help="steps that are planned (default 10)")
    parser.add_argument("--steps", type=int, default=20, metavar="N", help="steps of the loop (default 20)")
    for option, metavar, text in (
        ("--weight", "NAME=VALUE", "weight of a signal in the cost"),
        ("--terminal", "NAME=VALUE", "weight of a state at the end of the horizon"),
        ("--ref", "NAME=VALUE", "reference of a weighted signal"),
        ("--limit", "NAME=LOW:HIGH", "limit of an output, state or input; an end may be left out"),
        ("--soft", "NAME[=PRICE]", "soften the limit of a signal"),
    ):
        parser.add_argument(option, metavar=metavar, action="append", default=[], help=f"{text}; may be repeated")
    parser.add_argument("--backend", default="piqp", help="solver of the quadratic programs: piqp (default) or osqp")
    parser.add_argument("--time-limit", type=float, metavar="SECONDS", help="per step")
    parser.add_argument("--node-limit", type=int, metavar="N", help="nodes of the branch and bound per step")
    parser.add_argument("--on-failure", choices=["stop", "hold"], default="stop", help="when there is no plan")
    parser.add_argument("--csv", metavar="PATH", help="write the table to a file")
    parser.add_argument("--plot", metavar="PATH", help="write a picture (needs matplotlib)")
    add_output(parser, "the trajectory")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command; the exit status is 1 if the loop ended early."""
    model = load_model(options)
    mld = model.mld
    weights = assignments(options.weight, "--weight")
    if not weights:
        raise ArgumentError(f"--weight is missing: say what to control, as in --weight {_example(mld)}=1")
    controller = HybridMpc(
        model,
        options.horizon,
        _cost(mld, weights, assignments(options.terminal, "--terminal")),
        _limits(mld, options),
        backend=options.backend,
        time_limit=options.time_limit,
        node_limit=options.node_limit,
    )
    x0 = as_vector(vector(options.x0, mld.x, "--x0"), mld.x, "state")
    progress = _show_progress if sys.stderr.isatty() and not options.json else None
    trajectory = closed_loop(
        model, controller, x0, options.steps, assignments(options.ref, "--ref") or None,
        on_failure=options.on_failure, progress=progress,
    )  # fmt: skip
    emit_trajectory(trajectory, options)
    return 0 if trajectory.steps == options.steps else 1


def _example(mld: Mld) -> str:
    return next((v.name for v in (*mld.y, *mld.x)), "NAME")


def _group_of(mld: Mld, name: str, keys: str, option: str) -> str:
    for key in keys:
        if any(v.name == name for v in getattr(mld, key)):
            return key
    known = ", ".join(v.name for key in keys for v in getattr(mld, key))
    raise ArgumentError(f"{option} {name}: there is no such signal; the signals are {known}")


def _cost(mld: Mld, weights: dict[str, float], terminal: dict[str, float]) -> Cost:
    groups: dict[str, dict[str, float]] = {}
    for name, value in weights.items():
        groups.setdefault(_group_of(mld, name, "yxuzd", "--weight"), {})[name] = value
    return Cost(**groups, **({"terminal": terminal} if terminal else {}))  # type: ignore[arg-type]


def _limits(mld: Mld, options: argparse.Namespace) -> Limits:
    groups: dict[str, Any] = {"x": {}, "y": {}, "u": {}}
    for text in (part for item in options.limit for part in item.split(",")):
        name, equals, value = text.partition("=")
        if not equals:
            raise ArgumentError(f"--limit {text}: NAME=LOW:HIGH was expected")
        groups[_group_of(mld, name, "yxu", "--limit")][name] = span(value, f"--limit {name}")
    soft, prices = [], {}
    for text in (part for item in options.soft for part in item.split(",")):
        name, equals, _ = text.partition("=")
        soft.append(name)
        if equals:
            prices |= assignments([text], "--soft")
    return Limits(**groups, soft=tuple(soft) if soft else False, **({"rho": prices} if prices else {}))


def _show_progress(k: int, steps: int) -> None:
    print(f"\rstep {k} of {steps}", end="\n" if k == steps else "", file=sys.stderr, flush=True)


