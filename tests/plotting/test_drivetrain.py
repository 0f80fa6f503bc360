"""Pictures of drivetrains."""

import hysdel_py as hys


def test_a_run_is_drawn():
    line = hys.Drivetrain(
        hys.Inertia("a", 1), hys.Inertia("b", 1), hys.Clutch("c", "a", "b", 5), hys.SpringDamper("s", "b", "ground", 10)
    )
    figure = line.simulate({"a": 1, "b": 0}, 0.5).plot()
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == ["speed [rad/s]", "slip [rad/s]", "torque [Nm]", "sticks"]
    assert len(figure.axes[0].lines) == 2
