"""Pictures of modes: bands, timeline and moves of a run."""

from itertools import pairwise

import pytest

import hysdel_py as hys

pytest.importorskip("matplotlib")

from hysdel_py.plotting.mode_runs import mode_names, plot_bands, plot_timeline, plot_visits

SWITCHES = ("heater_on", "cooler_on")


@pytest.fixture(scope="module")
def run():
    return hys.load("heat_and_cool").simulate([5.0, 20.0, 40.0], [[18.0]] * 12)


def changes(words):
    return sum(a != b for a, b in pairwise(words))


def test_modes_have_the_names_of_what_is_on(run):
    words = mode_names(run, SWITCHES)
    assert len(words) == 12
    assert set(words) == {"heater_on", "cooler_on", "all off"}
    assert [word == "heater_on" for word in words] == [value > 0.5 for value in run["heater_on"]]
    assert mode_names(run)[0].split()[0] == "cold(1)"


def test_a_run_without_booleans_has_no_modes():
    with pytest.raises(hys.ArgumentError, match="the run has none"):
        mode_names(hys.load("linear_clutch").simulate([120.0, 60.0, 80.0], [[0.0]] * 2))


@pytest.mark.parametrize("names", [("T(9)",), ("T(1)",)])
def test_what_is_no_boolean_is_refused(run, names):
    with pytest.raises(hys.ArgumentError, match="is no Boolean auxiliary: there are cold"):
        mode_names(run, names)


def test_bands_change_with_the_mode_in_every_panel(run):
    figure = plot_bands(run, ("T(1)", "T_room"), booleans=SWITCHES, time_unit="min")
    for axes in figure.axes:
        assert len(axes.patches) == changes(mode_names(run, SWITCHES)) + 1
        edges = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in axes.patches]
        assert edges[0][0] == run.t[0]
        assert edges[-1][1] == run.t[-1]
    assert figure.axes[-1].get_xlabel() == "time [min]"
    assert {text.get_text() for text in figure.legends[0].get_texts()} == set(mode_names(run, SWITCHES))


def test_timeline_has_a_line_for_each_mode(run):
    (axes,) = plot_timeline(run, booleans=SWITCHES).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == ["all off", "cooler_on", "heater_on"]
    bars = sum(len(collection.get_paths()) for collection in axes.collections)
    assert bars == changes(mode_names(run, SWITCHES)) + 1


def test_visits_count_steps_and_moves(run):
    texts = [text.get_text() for text in plot_visits(run, booleans=SWITCHES).axes[0].texts]
    words = mode_names(run, SWITCHES)
    assert f"heater_on\n{words.count('heater_on')} steps" in texts
    assert sum(int(text) for text in texts if text.isdigit()) == changes(words)
