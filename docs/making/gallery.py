"""The pictures of docs/gallery.md: ``python docs/making/gallery.py`` writes them to docs/pictures/gallery.

The site makes them anew when it is built. Each function is one picture; none needs compiled kernels.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import hysdel_py as hys
from hysdel_py.plotting.mode_runs import plot_bands, plot_timeline, plot_visits
from hysdel_py.plotting.modes import plot_graph, plot_section
from hysdel_py.plotting.reach import plot_reach
from hysdel_py.plotting.spy import plot_spy
from hysdel_py.plotting.tree import plot_tree

FOLDER = Path(__file__).resolve().parents[1] / "pictures" / "gallery"
SWITCHES = ("heater_on", "cooler_on")


@cache
def heating() -> Any:
    """Three bodies under a falling and rising room temperature."""
    model = hys.load("heat_and_cool")
    room = [[18.0 + 14.0 * ((k // 20) % 2)] for k in range(80)]
    return model, model.simulate([5.0, 20.0, 40.0], room)


@cache
def searched() -> Any:
    """The first search of a controller of three tanks, and what its variables are called."""
    log = hys.NodeLog()
    mpc = hys.HybridMpc(
        hys.load("three_tanks"), 3, hys.Cost(y={"level(2)": 1}), progress=log, backend="piqp", node_limit=25
    )
    mpc.solve([1, 2, 1], {"level(2)": 3})
    return log, [mpc.formulation.describe_variable(i) for i in range(mpc.formulation.layout.n)]


@cache
def integrator_law() -> Any:
    """The explicit law of a double integrator, and a run."""
    plant = hys.Lti([[1, 1], [0, 1]], [[1], [0.5]], x=("pos [m]", "vel [m/s]"), u=("acc [m/s2]",), ts=1.0)
    mpc = hys.LinearMpc(plant, "regulator", 4, limits=hys.LinearLimits(u=(-1, 1), y=(-5, 5)))
    law = hys.explicit(mpc, {"pos": (-5, 5), "vel": (-3, 3)})
    return law, hys.closed_loop(plant, law, [-4, 0], 12)


def bands() -> Any:
    _, run = heating()
    return plot_bands(run, ("T(1)", "T(2)", "T(3)", "T_room"), booleans=SWITCHES, time_unit="min")


def timeline() -> Any:
    return plot_timeline(heating()[1], booleans=SWITCHES, time_unit="min")


def visits() -> Any:
    return plot_visits(heating()[1], booleans=SWITCHES)


def booleans() -> Any:
    return heating()[1].plot("T(1)", "T(2)", "T(3)", "cold(1)", "hot(1)", "hot(3)", *SWITCHES, time_unit="min")


def transitions() -> Any:
    pwa = hys.load("two_tanks").pwa.merge()
    return plot_graph(pwa, pwa.transitions())


def section() -> Any:
    return plot_section(hys.load("heat_and_cool").pwa.merge(), "T(1)", "T(2)", {"T(3)": 20.0, "T_room": 20.0})


def clutch_section() -> Any:
    return plot_section(hys.load("clutch").pwa, "gamma", "Fn", {"we": 150, "Te": 60})


def partition() -> Any:
    law, run = integrator_law()
    return law.plot(units=("m", "m/s"), move_label="acc [m/s²]", trace=run.x)


def surface() -> Any:
    return integrator_law()[0].plot("move", units=("m", "m/s"), move_label="acc [m/s²]")


def tree() -> Any:
    log, names = searched()
    return plot_tree(log.entries, names, "three tanks, one step")


def spy() -> Any:
    return plot_spy(hys.load("two_rooms").mld)


def reachable() -> Any:
    tanks = hys.load("two_tanks")
    return plot_reach(hys.reach(tanks, {"h1": (0.1, 0.2), "h2": (0.3, 0.32)}, 3, inputs={"valve": 0}), ("h1", "h2"))


PICTURES: tuple[Callable[[], Any], ...] = (
    bands, timeline, visits, booleans, transitions, section, clutch_section, partition, surface, tree, spy, reachable,
)  # fmt: skip


def pictures() -> Iterator[tuple[str, bytes]]:
    """Name and content of each file, the same bytes each time with one version of matplotlib."""
    for draw in PICTURES:
        buffer = io.BytesIO()
        draw().savefig(buffer, format="png", dpi=80, metadata={"Software": None})
        yield f"{draw.__name__.replace('_', '-')}.png", buffer.getvalue()


def main() -> None:
    """Write the pictures of the repository."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, content in pictures():
        (FOLDER / name).write_bytes(content)


if __name__ == "__main__":
    main()
