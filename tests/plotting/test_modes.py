"""Pictures of modes: what they show, not how."""

import pytest

import hysdel_py as hys
from hysdel_py.plotting.modes import plot_graph, plot_section


@pytest.fixture(scope="module")
def clutch():
    return hys.load("clutch").pwa.merge()


def test_graph_shows_every_mode_and_every_edge(clutch):
    graph = clutch.transitions()
    (axes,) = plot_graph(clutch, graph).axes
    shown = [text.get_text() for text in axes.texts]
    assert sum("gamma > reltol (line 52)" in text for text in shown) == 1
    assert {text.split(":")[0] for text in shown} == {str(mode.index) for mode in clutch.modes}
    arrows = [patch for patch in axes.patches if type(patch).__name__ == "FancyArrowPatch"]
    assert len(arrows) == sum(first != second for first, second in graph.edges)


def test_section_has_units_and_the_modes_that_it_meets(clutch):
    (axes,) = plot_section(clutch, "gamma", "Fn", {"we": 150, "Te": 60}).axes
    assert axes.get_xlabel() == "gamma [rad/s]"
    assert axes.get_ylabel() == "Fn [N]"
    assert len(axes.patches) == 5
    area = sum(_area(patch.get_xy()) for patch in axes.patches)
    assert area == pytest.approx(201 * 180, rel=1e-6)


def _area(corners):
    x, y = corners[:, 0], corners[:, 1]
    return abs(sum(x[k - 1] * y[k] - x[k] * y[k - 1] for k in range(len(x)))) / 2


def test_wrong_names(clutch):
    with pytest.raises(hys.ArgumentError, match="speed is no real state or input"):
        plot_section(clutch, "speed", "Fn")
    with pytest.raises(hys.ArgumentError, match="no state or input speed"):
        plot_section(clutch, "gamma", "Fn", {"speed": 1.0})
