from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.influence import influenced_outputs
from hysdel_py.control.layout import Plan
from hysdel_py.control.limits import Limits
from hysdel_py.control.prediction import shifted, shifted_sides, simulated_binaries
from hysdel_py.errors import SimulationError


def heater_plan(fan, switch):
    n = len(fan)
    return Plan(
        np.zeros((n + 1, 2)), np.column_stack([fan, switch]), np.full((n, 1), 0.2), np.zeros((n, 0)), np.zeros(0)
    )


def formulation(systems):
    return HybridMpc(systems.heater(), 3, Cost(y={"felt": 1})).formulation


def test_binaries_are_those_of_the_simulation(systems):
    plan = heater_plan([0.0, 0.0, 0.0], [0.9, 0.8, 0.1])
    found = simulated_binaries(formulation(systems), systems.heater_step, np.array([0.0, 1.0]), plan)
    assert found.tolist() == [1, 1, 1, 1, 0, 0]  # switch, heat of each stage


def test_without_a_simulation_the_values_are_rounded(systems):
    plan = heater_plan([0.0, 0.0, 0.0], [0.9, 0.8, 0.1])
    found = simulated_binaries(formulation(systems), None, np.array([0.0, 1.0]), plan)
    assert found.tolist() == [1, 0, 1, 0, 0, 0]


def test_a_step_that_the_model_does_not_have_leaves_the_rest_rounded(systems):
    def step(x, u):
        if x[0] > 2:
            raise SimulationError(("too hot",))
        return systems.heater_step(x, u)

    plan = heater_plan([0.0, 0.0, 0.0], [0.9, 0.8, 0.1])
    found = simulated_binaries(formulation(systems), step, np.array([0.0, 1.0]), plan)
    assert found.tolist() == [1, 1, 1, 0, 0, 0]


def test_shifted_plan_repeats_its_last_stage():
    plan = heater_plan([0.1, 0.2, 0.3], [0, 1, 0])
    later = shifted(plan)
    assert later.u[:, 0].tolist() == [0.2, 0.3, 0.3]
    assert later.u[:, 1].tolist() == [1, 0, 0]


def test_warm_start_and_heuristic_reach_the_search(systems):
    class Heater:
        mld = systems.heater()
        dha = SimpleNamespace(x=(), d=mld.d, z=mld.z, items=(), step=lambda x, u, check: systems.heater_step(x, u))

    mpc = HybridMpc(Heater(), 3, Cost(y={"felt": 1}), backend="piqp")  # the kernels simulate by themselves
    seen = []
    solver = mpc._planner.solver
    mpc._planner.solver = SimpleNamespace(solve=lambda **call: seen.append(call) or solver.solve(**call))
    first = mpc.solve([0.0, 1.0], {"felt": 4.0})
    mpc.solve([0.0, 1.0], {"felt": 4.0}, warm=False)
    mpc.solve([0.0, 1.0], {"felt": 4.0})
    mpc.reset()
    mpc.solve([0.0, 1.0], {"felt": 4.0})
    assert [call["incumbent"] is None for call in seen] == [True, True, False, True]
    f = mpc.formulation
    v = f.layout.join(replace(heater_plan([0, 0, 0], [0.9, 0.8, 0.1])))
    assert seen[0]["heuristic"](v, f.lb, f.ub).tolist() == [1, 1, 1, 1, 0, 0]
    u = first.predicted.u[[1, 2, 2]]
    x, expected = np.array([0.0, 1.0]), []
    for row in u:
        x, _, d, _ = systems.heater_step(x, row)
        expected += [row[1], d[0]]
    assert seen[2]["incumbent"].tolist() == expected


def test_the_kernels_are_given_the_shifted_plan_and_its_active_rows(systems):
    mpc = HybridMpc(systems.heater(), 3, Cost(y={"felt": 1}), backend="dense")
    solver, seen = mpc._planner.solver, []
    mpc._planner.solver = SimpleNamespace(solve=lambda **call: seen.append(call) or solver.solve(**call))
    first = mpc.solve([0.0, 1.0], {"felt": 4.0})
    mpc.solve([0.0, 1.0], {"felt": 4.0})
    mpc.solve([0.0, 1.0], {"felt": 4.0}, warm=False)
    assert ["point" in call for call in seen] == [False, True, False]
    f, size = mpc.formulation, mpc.formulation.layout.stage_size
    v = first.case.v
    np.testing.assert_allclose(seen[1]["point"], np.concatenate([v[size:], v[-size:]]), atol=1e-9)
    assert seen[1]["active"].shape[1] == 2
    assert (seen[1]["active"][:, 0] < len(f.rows) + f.layout.n).all()


def test_rows_and_variables_know_their_partners_of_the_stage_before(systems):
    mpc = HybridMpc(systems.heater(), 3, Cost(y={"felt": 1}))
    f = mpc.formulation
    before, m, size = shifted_sides(f), len(f.rows), f.layout.stage_size
    assert before[m : m + size].tolist() == [-1] * size
    assert before[m + size : m + 2 * size].tolist() == list(range(m, m + size))
    for row in np.flatnonzero(before[:m] >= 0):
        here, there = f.rows[row], f.rows[before[row]]
        assert (here.kind, here.stage - 1, here.text) == (there.kind, there.stage, there.text)
    assert (before[:m] >= 0).any()


def test_the_last_value_of_a_preview_holds_at_the_end(systems):
    mpc = HybridMpc(systems.fold(), 3, Cost(x={"x": 1}))
    table = mpc.references.table({"x": [1.0, 2.0, 3.0]})
    assert table["x"].tolist() == [1, 2, 3, 3]
    assert mpc.references.table({"x": [1, 2, 3, 9]})["x"].tolist() == [1, 2, 3, 9]
    assert mpc.references.table(None)["x"].tolist() == [0, 0, 0, 0]


def test_constant_of_an_output_is_in_the_cost_and_the_limits(systems):
    mld = replace(systems.heater(), D5=np.array([100.0, 0.0]))
    mpc = HybridMpc(mld, 2, Cost(y={"felt": 1}), Limits(y={"felt": (90, 100.25)}))
    move = mpc.solve([0.0, 0.0], {"felt": 103.0})
    assert move.predicted.y[0, 0] == pytest.approx(100.25, abs=1e-5)
    assert move.cost == pytest.approx(2 * 2.75**2, rel=1e-3)


def test_auxiliary_without_a_definition_counts_as_free(systems):
    free = tuple(replace(row, defines="") for row in systems.fold().rows)
    mld = replace(systems.fold(), rows=free, D3=np.array([[1.0]]))
    assert influenced_outputs(mld) == (True,)


def test_slack_reaches_above_the_limit(systems):
    f = HybridMpc(systems.heater(), 2, Cost(), Limits(y={"felt": (None, 9)}, soft=True)).formulation
    assert f.ub[-1] == 41.5
