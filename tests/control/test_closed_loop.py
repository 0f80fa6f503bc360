from __future__ import annotations

import numpy as np
import pytest

from hysdel_py.control.closed_loop import closed_loop
from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.errors import SimulationError


def drift(x, u):
    return x + u


def give_up(after):
    calls = []

    def controller(x, ref):
        calls.append(x)
        return [1.0] if len(calls) <= after else None

    return controller


def test_fold_reaches_its_reference(systems):
    mpc = HybridMpc(systems.fold(), 4, Cost(y={"seen": 1}))
    run = closed_loop(systems.fold_step(), mpc, [-9.0], 25, {"seen": 0.5})
    assert run.steps == 25
    assert run["x"][-1] == pytest.approx(0.5, abs=1e-3)
    assert run.messages == ()
    assert run.info["status"].tolist() == [MoveStatus.OPTIMAL.code] * 25
    assert {"cost", "bound", "gap", "nodes", "qps", "seconds", "status", "fallback"} == set(run.info)
    assert (run.info["qps"] >= 0).all()
    assert run.names["u"] == ("push",)


def test_plant_with_outputs_and_names(systems):
    class Plant:
        step = staticmethod(systems.heater_step)
        x, u, y, d, z = (getattr(systems.heater(), key) for key in "xuydz")

    mpc = HybridMpc(systems.heater(), 4, Cost(y={"felt": 1}))
    run = closed_loop(Plant(), mpc, {"T": 0.0, "on": 0.0}, 10, lambda k: {"felt": 5.0 if k < 5 else 0.0})
    assert run.y.shape == (10, 2)
    assert run["heat"].max() == 1.0
    assert run["felt"][4] > 3.0
    assert run["felt"][9] < run["felt"][4]
    assert run.columns().keys() >= {"T", "on", "fan", "switch", "felt", "hot", "heat", "cost"}


def test_preview_acts_before_the_step(systems):
    ref = np.array([0.0] * 5 + [1.0] * 20)

    def error(preview):
        mpc = HybridMpc(systems.fold(power=0.3, left=1.0, right=1.0), 4, Cost(y={"seen": 1}))
        value = (lambda k: {"seen": ref[k : k + 4]}) if preview else (lambda k: {"seen": ref[k]})
        run = closed_loop(drift, mpc, [0.0], 12, value)
        return float(((run.x[:12, 0] - ref[:12]) ** 2).sum())

    assert error(True) < 0.8 * error(False)


def test_failure_stops_the_run_and_says_so():
    run = closed_loop(drift, give_up(3), [0.0], 10)
    assert run.steps == 3
    assert run.x[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0]
    assert run.messages == ("step 3: stopped, the controller returned no input",)


def test_failure_holds_the_last_input_and_says_so():
    run = closed_loop(drift, give_up(1), [0.0], 3, on_failure="hold")
    assert run.x[-1, 0] == 3.0
    assert [m.split(":")[0] for m in run.messages] == ["step 1", "step 2"]
    assert "held" in run.messages[0]


def test_failure_at_the_first_step_cannot_hold():
    run = closed_loop(drift, give_up(0), [0.0], 3, on_failure="hold")
    assert run.steps == 0
    assert "stopped" in run.messages[0]
    assert run.u.shape == (0, 0)


def test_failure_asks_the_fallback():
    run = closed_loop(drift, give_up(1), [0.0], 3, on_failure=lambda k, x, move: -x)
    assert run.x[:, 0].tolist() == [0.0, 1.0, 0.0, 0.0]
    assert "on_failure chose" in run.messages[0]


def test_infeasible_move_ends_the_run_with_its_message(systems):
    mpc = HybridMpc(systems.fold(), 3, Cost(y={"seen": 1}), Limits(x={"x": (-1, 1)}))
    run = closed_loop(systems.fold_step(), mpc, [-10.0], 5)
    assert run.steps == 0
    assert "infeasible" in run.messages[0]
    assert "x x in [-1, 1]" in run.messages[0]


def test_suboptimal_moves_are_listed():
    move = Move(MoveStatus.FEASIBLE, "feasible: by hand", u=np.array([1.0]), cost=2.0, gap=0.5)
    run = closed_loop(drift, lambda x, ref: move, [0.0], 2)
    assert run.messages == ("step 0: feasible: by hand", "step 1: feasible: by hand")
    assert run.info["gap"].tolist() == [0.5, 0.5]
    assert run.info["status"].tolist() == [1.0, 1.0]


def test_plant_without_a_step_ends_the_run():
    def plant(x, u):
        if x[0] >= 2:
            raise SimulationError(("x is out of range",))
        return x + u

    run = closed_loop(plant, lambda x, ref: [1.0], [0.0], 5)
    assert run.steps == 2
    assert run.messages == ("step 2: stopped, the plant has no step here: x is out of range",)


def test_stop_and_progress():
    seen = []
    run = closed_loop(
        drift, lambda x, ref: [1.0], [0.0], 9, stop=lambda k, x: x[0] >= 4, progress=lambda k, n: seen.append((k, n))
    )
    assert run.steps == 4
    assert seen == [(1, 9), (2, 9), (3, 9), (4, 9)]
    assert run.messages == ("step 4: stopped as asked",)


def test_controller_sees_the_reference_of_its_step():
    seen = []
    closed_loop(drift, lambda x, ref: seen.append(ref) or [0.0], [0.0], 3, lambda k: {"a": k})
    assert seen == [{"a": 0}, {"a": 1}, {"a": 2}]


def test_state_that_a_residual_carries_over_its_range_is_put_back(systems):
    class Plant:
        x, u, y, d, z = (getattr(systems.fold(), key) for key in "xuydz")

        def step(self, x, u):
            if abs(x[0]) > 10:
                raise SimulationError(("out of range",))
            return np.array([10 + self.excess]), x, np.zeros(1), np.zeros(1)

    plant = Plant()
    plant.excess = 5e-7
    run = closed_loop(plant, lambda x, ref: [0.0], [0.0], 3)
    assert run.steps == 3
    assert run.x[1:, 0].tolist() == [10.0] * 3
    plant.excess = 1e-3
    run = closed_loop(plant, lambda x, ref: [0.0], [0.0], 3)
    assert run.steps == 1
    assert "out of range" in run.messages[0]


def test_times_follow_the_sample_time(systems):
    mpc = HybridMpc(systems.fold(), 2, Cost(y={"seen": 1}))
    mpc.sample_time = 0.5
    assert mpc.solve([1.0]).predicted.t.tolist() == [0.0, 0.5, 1.0]
    assert closed_loop(systems.fold_step(), mpc, [1.0], 2).t.tolist() == [0.0, 0.5, 1.0]
