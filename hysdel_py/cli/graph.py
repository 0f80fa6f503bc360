"""``hysdel graph``: which modes lie side by side, and which can follow on which."""

from __future__ import annotations

import argparse
from pathlib import Path

from hysdel_py.cli.arguments import add_model, load_model
from hysdel_py.cli.output import check_target
from hysdel_py.errors import ArgumentError
from hysdel_py.export.dot import dot_text

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel graph clutch                            print the graph in the DOT language
  hysdel graph clutch -o clutch.svg              draw it
  hysdel graph clutch --kind adjacency --merge -o clutch.dot
"""
_PICTURES = (".svg", ".png", ".pdf")


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "graph",
        description="Graph of the modes of a model: i -> j where some state and input of mode i lead to a state for "
        "which mode j has an input, or, with --kind adjacency, modes whose regions share a facet.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument("-o", "--output", metavar="PATH", help=f"write a file (.dot, {', '.join(_PICTURES)})")
    parser.add_argument("--kind", choices=["transitions", "adjacency"], default="transitions", help="which graph")
    parser.add_argument("--merge", action="store_true", help="join modes that do the same first")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    suffix = Path(options.output).suffix if options.output else ".dot"
    if suffix not in (".dot", *_PICTURES):
        raise ArgumentError(f"--output {options.output}: a name that ends in .dot, {', '.join(_PICTURES)} was expected")
    if options.output:
        check_target(Path(options.output), "--output")
    model = load_model(options)
    pwa = model.pwa.merge() if options.merge else model.pwa
    graph = pwa.adjacency() if options.kind == "adjacency" else pwa.transitions()
    if not options.output:
        print(dot_text(pwa, graph), end="")
        return 0
    if suffix == ".dot":
        Path(options.output).write_text(dot_text(pwa, graph), encoding="utf-8")
    else:
        from hysdel_py.plotting.modes import plot_graph

        plot_graph(pwa, graph).savefig(options.output)
    print(f"{options.output}: {len(graph)} modes, {graph.number_of_edges()} edges")
    return 0
