"""What a controller of the command line is to do: options for cost, limits and the shape of its plans."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from hysdel_py.cli.arguments import assignments, number, parts, span
from hysdel_py.control.costs import Cost
from hysdel_py.control.limits import Limits
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld

__all__ = [
    "add_demands", "add_shape", "all_limits", "blocking_of", "cost_of", "limits_of", "references_of", "spans",
]  # fmt: skip

_WORDS = {"x": "states", "y": "outputs", "u": "inputs", "z": "real auxiliaries", "d": "Booleans"}


def add_demands(parser: argparse.ArgumentParser) -> None:
    """Add weights, references and limits."""
    for option, metavar, text in (
        ("--weight", "NAME=VALUE", "weight of a signal in the cost"),
        ("--terminal", "NAME=VALUE", "weight of a state at the end of the horizon"),
        ("--ref", "NAME=VALUE", "reference of a weighted signal"),
        ("--limit", "NAME=LOW:HIGH", "limit of an output, state or input; an end may be left out"),
        ("--soft", "NAME[=PRICE]", "allow a limit to be exceeded at a price (default 1e4)"),
        ("--weight-change", "NAME=VALUE", "weight of the change of an input from step to step"),
        ("--limit-change", "NAME=LOW:HIGH", "limit of the change of an input from step to step"),
    ):
        parser.add_argument(option, metavar=metavar, action="append", default=[], help=f"{text}; may be repeated")


def add_shape(parser: argparse.ArgumentParser) -> None:
    """Add the norm of the cost and what a plan may look like."""
    parser.add_argument("--norm", default="2", choices=["1", "2", "inf"], help="norm of the cost (default 2)")
    parser.add_argument("--blocking", metavar="N,N,...", help="lengths of the blocks of equal inputs, as in 1,1,2,4")
    parser.add_argument("--control-horizon", type=int, metavar="N", help="inputs that are decided; the last is held")
    parser.add_argument("--binary-horizon", type=int, metavar="N", help="steps whose switches are decided exactly")


def blocking_of(options: argparse.Namespace) -> list[int] | None:
    """Lengths of the blocks of equal inputs, None without any."""
    if options.blocking is None:
        return None
    lengths = [number(part, "--blocking") for part in options.blocking.split(",")]
    if any(length != round(length) for length in lengths):
        raise ArgumentError(f"--blocking is '{options.blocking}': whole numbers were expected, as in 1,1,2,4")
    return [round(length) for length in lengths]


def _example(mld: Mld) -> str:
    return next((v.name for v in (*mld.y, *mld.x)), "NAME")


def _group_of(mld: Mld, name: str, keys: str, option: str) -> str:
    for key in keys:
        if any(v.name == name for v in getattr(mld, key)):
            return key
    known = [f"{_WORDS[key]} {', '.join(v.name for v in group)}" for key in keys if (group := getattr(mld, key))]
    raise ArgumentError(f"{option} {name}: there is no such signal; there are the {'; '.join(known)}")


def cost_of(mld: Mld, options: argparse.Namespace) -> Cost:
    """The cost that the options ask for."""
    weights = assignments(options.weight, "--weight")
    if not weights:
        raise ArgumentError(f"--weight is missing: say what to control, as in --weight {_example(mld)}=1")
    terminal = assignments(options.terminal, "--terminal")
    changes = assignments(options.weight_change, "--weight-change")
    groups: dict[str, dict[str, float]] = {}
    for name, value in weights.items():
        groups.setdefault(_group_of(mld, name, "yxuzd", "--weight"), {})[name] = value
    for name in terminal:
        _group_of(mld, name, "x", "--terminal")
    for name in changes:
        _group_of(mld, name, "u", "--weight-change")
    last: dict[str, Any] = {"terminal": terminal} if terminal else {}
    return Cost(**groups, **last, du=changes, norm=options.norm)


def references_of(options: argparse.Namespace) -> dict[str, float] | None:
    """References of weighted signals, None without any."""
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
    for name, ends in spans(texts, "--limit").items():
        groups[_group_of(mld, name, "yxu", "--limit")][name] = ends
    return groups


def all_limits(mld: Mld, options: argparse.Namespace) -> Limits:
    """The limits that the options ask for, softened where they say so."""
    changes = spans(options.limit_change, "--limit-change")
    for name in changes:
        _group_of(mld, name, "u", "--limit-change")
    groups = limits_of(mld, options.limit)
    softened = dict(parts(options.soft, "--soft", "NAME or NAME=PRICE"))
    for name in softened:
        if name not in {**groups["x"], **groups["y"]}:
            known = ", ".join([*groups["y"], *groups["x"]]) or "none"
            raise ArgumentError(f"--soft {name}: it has no --limit as a state or output; those with one: {known}")
    prices = {name: number(price, f"--soft {name}") for name, price in softened.items() if price is not None}
    priced: dict[str, Any] = {"rho": prices} if prices else {}
    return Limits(**groups, du=changes, soft=tuple(softened) if softened else False, **priced)


def spans(texts: Sequence[str], option: str) -> dict[str, tuple[float, float]]:
    """Intervals of ``NAME=LOW:HIGH`` texts."""
    found = {}
    for name, value in parts(texts, option, "NAME=LOW:HIGH"):
        if value is None:
            raise ArgumentError(f"{option} {name}: NAME=LOW:HIGH was expected, as in {option} {name}=0:1")
        found[name] = span(value, f"{option} {name}")
    return found
