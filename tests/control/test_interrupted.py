"""Ctrl-C during a run leaves the steps that were made."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.control.run import Run
from hysdel_py.systems.simulation import simulate

PLANT = """SYSTEM s {
  INTERFACE { STATE { REAL v [-9, 9]; } INPUT { REAL u [-1, 1]; } }
  IMPLEMENTATION { CONTINUOUS { v = 0.5*v + u; } }
}"""


@pytest.fixture(scope="module")
def plant():
    return hys.load(PLANT)


def interrupt(k, _):
    if k == 3:
        raise KeyboardInterrupt


def test_simulation(plant):
    with pytest.raises(hys.Interrupted) as caught:
        simulate(plant.dha, [1.0], np.ones((9, 1)), progress=interrupt)
    partial = caught.value.partial
    assert partial.x.tolist() == plant.simulate([1.0], np.ones((3, 1))).x.tolist()
    assert partial.messages == ("step 3: interrupted",)


@pytest.mark.parametrize("where", ["controller", "plant", "progress"])
def test_closed_loop(plant, where):
    def stopping(place, value):
        counts[place] = counts.get(place, -1) + 1
        if place == where and counts[place] == 3:
            raise KeyboardInterrupt
        return value

    counts = {}
    with pytest.raises(hys.Interrupted) as caught:
        hys.closed_loop(
            lambda x, u: stopping("plant", 0.5 * x + u), lambda x, _: stopping("controller", -0.1 * x), [1.0], 9,
            progress=lambda *_: stopping("progress", None),
        )  # fmt: skip
    partial = caught.value.partial
    steps = 4 if where == "progress" else 3
    assert partial.steps == len(partial.info["seconds"]) == steps
    assert partial["x1"] == pytest.approx(0.4 ** np.arange(steps + 1))
    assert partial.messages == (f"step {steps}: interrupted",)


def test_scripts_end_as_on_any_other_interrupt():
    assert issubclass(hys.Interrupted, KeyboardInterrupt)
    assert not issubclass(hys.Interrupted, Exception)


def test_a_step_that_was_half_written_down_is_left_out():
    run = Run(np.array([1.0]))
    run.advance(0, lambda x, u: (x + u, x, x[:0], x[:0]), np.array([2.0]), (0.0,) * 8)
    run.x.append(np.array([9.0]))
    run.u.append(np.array([9.0]))
    run.interrupt()
    assert run.trajectory({}).x.tolist() == [[1.0], [3.0]]
    assert run.trajectory({}).u.tolist() == [[2.0]]
