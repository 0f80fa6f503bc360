"""Pictures: what is drawn, how it is labelled, and that every kind of trajectory gives one."""

import io
import re
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

import hysdel_py as hys

pytest.importorskip("matplotlib")

from hysdel_py.demos.clutch import LEAST_ENGINE_SPEED, START, engage
from hysdel_py.plotting.clutch import plot_engagement
from hysdel_py.plotting.style import COLOURS
from hysdel_py.plotting.trajectory import draw_held

REALS = """SYSTEM reals {
  INTERFACE {
    STATE { REAL v [-99, 99]; /* [m/s] speed */ REAL T [0, 99]; /* [K] heat */ REAL w [-99, 99]; /* [m/s] */ }
    INPUT { REAL push [-1, 1]; /* [N] force */ }
    OUTPUT { REAL seen; /* [m/s] */ }
    PARAMETER { REAL ts = 0.5; /* [h] */ }
  }
  IMPLEMENTATION { CONTINUOUS { v = 0.5*v + push; T = T; w = v; } OUTPUT { seen = v; } }
}"""
BOOLEANS = """SYSTEM flags {
  INTERFACE { STATE { BOOL a, b; } }
  IMPLEMENTATION { AUTOMATA { a = ~a; b = a & b; } }
}"""
MANY = """SYSTEM many {
  INTERFACE { STATE { REAL x1, x2, x3, x4, x5, x6, x7, x8, x9 [-9, 9]; } }
  IMPLEMENTATION { CONTINUOUS { x1 = 0.9*x1; } }
}"""


def panels(figure):
    return {axes.get_ylabel(): axes for axes in figure.axes}


def legend(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def curve(axes, name):
    return next(line for line in axes.get_lines() if line.get_label() == name)


def png(figure):
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=50)
    assert buffer.getvalue().startswith(b"\x89PNG")
    return buffer.getvalue()


@pytest.fixture(scope="module")
def reals():
    return hys.load(REALS).simulate([1, 20, 0], [[1], [0], [-1]])


@pytest.fixture(scope="module")
def booleans():
    return hys.load(BOOLEANS).simulate([1, 0], 4)


def test_one_panel_for_each_vector_and_unit(reals):
    figure = reals.plot()
    found = panels(figure)
    assert list(found) == ["state [m/s]", "state [K]", "input [N]", "output [m/s]"]
    assert legend(found["state [m/s]"]) == ["v", "w"]
    assert legend(found["output [m/s]"]) == ["seen"]
    assert figure.axes[-1].get_xlabel() == "time [s]"
    assert [axes.get_xlabel() for axes in figure.axes[:-1]] == ["", "", ""]


def test_curves_are_the_signals(reals):
    found = panels(reals.plot())
    states = curve(found["state [m/s]"], "v")
    assert states.get_xdata().tolist() == [0, 0.5, 1, 1.5]
    assert states.get_ydata().tolist() == reals["v"].tolist()
    held = curve(found["input [N]"], "push")
    assert held.get_drawstyle() == "steps-post"
    assert held.get_xdata().tolist() == [0, 0.5, 1, 1.5], "the last input is held to the end"
    assert held.get_ydata().tolist() == [1, 0, -1, -1]


@pytest.mark.parametrize(("unit", "label"), [("h", "time [h]"), ("", "time [s]")])
def test_unit_of_the_times(reals, unit, label):
    assert reals.plot(time_unit=unit).axes[-1].get_xlabel() == label


def test_steps_without_a_sample_time(booleans):
    axes = booleans.plot().axes[-1]
    assert axes.get_xlabel() == "step"
    assert all(tick == round(tick) for tick in axes.get_xticks()), "there is no half step"


def test_command_line_takes_the_unit_from_the_model(tmp_path, monkeypatch):
    from hysdel_py.cli.main import main
    from hysdel_py.systems.trajectory import Trajectory

    units = []
    original = Trajectory.plot

    def recorded(self, *names, time_unit=""):
        units.append(time_unit)
        return original(self, *names, time_unit=time_unit)

    monkeypatch.setattr(Trajectory, "plot", recorded)
    (tmp_path / "reals.hys").write_text(REALS)
    for model, x0, u in ((tmp_path / "reals.hys", "1,20,0", "0"), ("two_rooms", "20,20,20,0", "0,0")):
        picture = str(tmp_path / "run.svg")
        assert main(["simulate", str(model), "--x0", x0, "--input", u, "--steps", "2", "--plot", picture]) == 0
    assert units == ["h", "min"]


def test_named_signals_only(reals):
    assert list(panels(reals.plot("push", "T"))) == ["input [N]", "state [K]"]
    with pytest.raises(hys.ArgumentError, match="no signal speed: it has v, T"):
        reals.plot("speed")


def test_signals_of_a_controller_can_be_drawn():
    model = hys.load(REALS)
    mpc = hys.HybridMpc(model, 2, hys.Cost(y={"seen": 1}))
    run = hys.closed_loop(model, mpc, [1, 20, 0], 3)
    found = panels(run.plot("cost", "info.qps", "x.v"))
    assert legend(found["record"]) == ["cost", "qps"]
    assert curve(found["record"], "cost").get_ydata()[:3].tolist() == run["cost"].tolist()
    png(run.plot())


def test_name_of_a_state_and_an_output():
    text = REALS.replace("seen", "v_out").replace("CONTINUOUS", "AUX { REAL z; } LINEAR { z = v; } CONTINUOUS")
    run = hys.load(text).simulate([1, 20, 0], [[1]])
    assert list(panels(run.plot("z", "y.v_out"))) == ["auxiliary", "output [m/s]"]


def test_booleans_are_bands_where_they_are_true(booleans):
    figure = booleans.plot()
    axes = figure.axes[0]
    assert [text.get_text() for text in axes.get_yticklabels()] == ["b", "a"]
    assert legend(axes) == ["true"]
    bands = [[path.get_extents().intervalx.tolist() for path in c.get_paths()] for c in axes.collections]
    assert bands == [[], [[0, 1], [2, 3]]], "a begins true and toggles, b is never true"
    low, high = axes.get_xlim()
    assert low <= 0
    assert high >= 4, "the time axis is whole"
    assert axes.get_axisbelow() is True


def test_nothing_ever_true(booleans):
    run = hys.load(BOOLEANS.replace("~a", "a")).simulate([0, 0], 3)
    figure = run.plot()
    assert figure.axes[0].get_xlim()[1] >= 3
    png(figure)


@pytest.mark.parametrize("text", [REALS, BOOLEANS], ids=["reals", "booleans"])
def test_no_steps(text):
    model = hys.load(text)
    run = model.simulate(np.ones(len(model.dha.x)), np.zeros((0, len(model.dha.u))))
    figure = run.plot()
    assert figure.axes[-1].get_xlabel() == "step"
    png(figure)


def test_single_state_is_seen_as_a_point():
    run = hys.load(REALS).simulate([1, 20, 0], np.zeros((0, 1)))
    assert curve(panels(run.plot())["state [m/s]"], "v").get_marker() == "o"


def test_no_signal_at_all():
    run = hys.load("SYSTEM s { INTERFACE { INPUT { REAL u [0, 1]; } } IMPLEMENTATION { } }").simulate([], [[0.5]])
    png(run.plot())


def test_no_inputs_no_outputs():
    run = hys.load(MANY).simulate(np.ones(9), 3)
    figure = run.plot()
    styles = {(line.get_color(), line.get_linestyle()) for line in figure.axes[0].get_lines()}
    assert len(styles) == 9 > len(COLOURS), "no two curves look the same"
    png(figure)


def test_small_numbers_have_a_power_of_ten():
    run = hys.load("two_tanks").simulate([0.1, 0.1], [[1e-4, 0], [2e-4, 1]])
    figure = run.plot()
    figure.canvas.draw()
    axes = panels(figure)["input [m^3/s]"]
    assert re.search(r"10\^\{.4\}", axes.yaxis.get_offset_text().get_text())
    assert all(len(re.sub(r"[^\d.]", "", label.get_text())) < 6 for label in axes.get_yticklabels())


def test_nothing_overlaps_and_nothing_is_cut_off():
    """Every text, legends too, lies within the picture; no panel covers another."""
    rooms, reals = hys.load("two_rooms"), hys.load(REALS)
    for run in (rooms.simulate([15, 30, 28, 1], [[0, 1]] * 5), reals.simulate([1, 20, 0], [[1]])):
        figure = run.plot()
        figure.canvas.draw()
        whole = figure.bbox
        boxes = [axes.get_tightbbox() for axes in figure.axes]
        assert all(whole.x0 <= b.x0 and b.x1 <= whole.x1 and whole.y0 <= b.y0 and b.y1 <= whole.y1 for b in boxes)
        assert all(upper.y0 >= lower.y1 for upper, lower in pairwise(boxes))


def test_held_values_without_any():
    from matplotlib.figure import Figure

    axes = Figure().subplots()
    draw_held(axes, np.array([0.0]), np.zeros(0))
    assert axes.get_lines()[0].get_xdata().tolist() == []


def test_no_window_and_no_global_state(tmp_path):
    code = (
        "import sys, hysdel_py as hys\n"
        "run = hys.load('two_tanks').simulate([0.1, 0.1], [[1e-4, 1]])\n"
        "run.plot().savefig(sys.argv[1])\n"
        "print('matplotlib.pyplot' in sys.modules)"
    )
    command = [sys.executable, "-c", code, str(tmp_path / "run.png")]
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout == "False\n"


@pytest.fixture(scope="module")
def engagement():
    return engage(horizon=3, node_limit=10)


def test_engagement(engagement):
    figure = engagement.plot()
    speeds, torques, times, modes = figure.axes
    assert speeds.get_ylabel() == "speed [rad/s]"
    assert legend(speeds) == ["engine", "vehicle side", "relative speed", "least engine speed", "engine reference"]
    assert torques.get_ylabel() == "torque [Nm], force [N]"
    assert legend(torques) == ["engine torque", "normal force", "clutch torque"]
    assert times.get_ylabel() == "solve time [ms]"
    assert times.get_yscale() == "log"
    figure.canvas.draw()
    assert {text.get_text() for text in times.get_yticklabels(minor=True)} <= {""}, "labels of minor ticks would touch"
    assert [text.get_text() for text in modes.get_yticklabels()] == ["lockupahead", "neg_slip", "karnopp", "stick"]
    assert modes.get_xlabel() == "time [s]"
    run = engagement.trajectory
    assert curve(speeds, "vehicle side").get_ydata() == pytest.approx(run["we"] - run["gamma"])
    assert [text.get_text() for text in speeds.texts] == [f"locked, {engagement.lockup_time:.2f} s"]


def test_solve_times_are_those_of_the_predictive_controller(engagement):
    seconds = figure_times(engagement.plot())
    planned = np.isfinite(engagement.trajectory["status"])
    assert planned.sum() == engagement.hand_over < engagement.trajectory.steps
    assert seconds[:-1][planned] == pytest.approx(1e3 * engagement.trajectory["seconds"][planned])
    assert np.isnan(seconds[:-1][~planned]).all()


def figure_times(figure):
    return np.asarray(figure.axes[2].get_lines()[0].get_ydata(), dtype=float)


def test_engagement_without_lockup(engagement):
    figure = plot_engagement(engagement.trajectory, LEAST_ENGINE_SPEED, START["we"], None)
    assert list(figure.axes[0].texts) == []
    png(figure)
