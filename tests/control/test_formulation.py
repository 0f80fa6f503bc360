from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hysdel_py.control.costs import Cost
from hysdel_py.control.formulation import formulate
from hysdel_py.control.influence import influenced_outputs
from hysdel_py.control.limits import Limits


def build(mld, horizon, cost, limits=None):
    return formulate(mld, horizon, cost.resolve(mld), (limits or Limits()).resolve(mld))


def simulate(formulation, step, x0, inputs, slack=()):
    """Decision variables of a simulated run."""
    v, x = [], np.array(x0, dtype=float)
    for u in np.atleast_2d(inputs):
        x1, _, d, z = step(x, u)
        v += [u, d, z, x1]
        x = x1
    return np.concatenate([*v, slack])


@pytest.mark.parametrize("x0", [3.0, -4.0, 0.0])
def test_simulated_run_satisfies_rows_and_bounds(systems, x0):
    f = build(systems.fold(), 4, Cost(y={"seen": 1}))
    v = simulate(f, systems.fold_step(), [x0], [[0.5], [-1.0], [1.0], [0.2]])
    vectors = f.vectors(np.array([x0]), {})
    assert f.residual(v, vectors) < 1e-12
    v[1] = 1 - v[1]  # the wrong side at the first step
    assert f.residual(v, vectors) > 1e-7


def test_objective_is_the_cost_of_the_docstring(systems):
    mld, x0 = systems.heater(), np.array([2.0, 1.0])
    Qy = np.array([[2.0, 0.3], [0.3, 1.0]])
    cost = Cost(y=Qy, x={"T": 0.7}, u=[0.2, 0.4], d={"heat": 5.0}, terminal={"T": 11.0})
    f = build(mld, 3, cost)
    inputs = np.array([[0.5, 1.0], [-1.0, 1.0], [1.0, 0.0]])
    v = simulate(f, systems.heater_step, x0, inputs)
    refs = {"felt": np.array([1.0, 2.0, 3.0, 9.0]), "hot": np.full(4, 0.5), "T": np.array([7.0, 1.0, 2.0, 3.0])}
    expected, x = 0.0, x0
    for k, u in enumerate(inputs):
        x1, y, d, _ = systems.heater_step(x, u)
        e = y - [refs["felt"][k], refs["hot"][k]]
        expected += e @ Qy @ e + 0.2 * u[0] ** 2 + 0.4 * u[1] ** 2 + 5.0 * d[0] ** 2
        expected += 0.7 * (x[0] - refs["T"][k]) ** 2 if k else 0.0
        x = x1
    expected += 11.0 * (x[0] - refs["T"][3]) ** 2
    q = f.vectors(x0, refs)
    assert 0.5 * v @ (f.objective.P @ v) + q.q @ v + q.constant == pytest.approx(expected, rel=1e-12)


def test_terminal_weight_defaults_to_the_state_weight(systems):
    def last(cost):
        f = build(systems.fold(), 2, cost)
        i = f.layout.start("x", 2)
        return f.objective.P[i, i]

    assert last(Cost(x={"x": 3})) == 6.0
    assert last(Cost(x={"x": 3}, terminal={"x": 5})) == 10.0
    assert last(Cost(x={"x": 3}, terminal={})) == 0.0


def test_variables_and_rows_say_what_they_are(systems):
    f = build(systems.fold(), 3, Cost(), Limits(y={"seen": (-1, 2)}, soft=True))
    words = [f.describe_variable(i) for i in range(f.layout.n)]
    assert words[4:9] == ["u[1] push", "d[1] side (line 7)", "z[1] part (line 9)", "x[2] x", "u[2] push"]
    assert words[-1] == "slack of seen"
    rows = [f.describe_row(i) for i in range(f.A.shape[0])]
    assert len(f.rows) == f.A.shape[0]
    assert "update[1] x: x = ... (line 20)" in rows
    assert "model[2] row 5: part = {IF side THEN x}; (line 9)" in rows
    assert rows.count("limit[1] y seen in [-1, 2]") == 2  # one row for each side
    assert not any(row.startswith("limit[0]") for row in rows)


def test_binaries_are_ordered_by_stage(systems):
    f = build(systems.heater(), 3, Cost())
    assert [f.describe_variable(i) for i in f.binaries[:2]] == ["u[0] switch", "d[0] heat (line 5)"]
    assert f.stages.tolist() == [0, 0, 1, 1, 2, 2]


def test_boolean_state_of_a_fractional_update_is_branched_on(systems):
    mld = systems.assemble(
        "odd", (systems.variable("b", systems.heater().x[0].kind, boolean=True),),
        (systems.variable("v", systems.heater().u[0].kind, 0, 1),), (), (), (),
        ([[0]], [[1]], [], [], [0]), ([], [], [], [], []), [],
    )  # fmt: skip
    f = build(mld, 2, Cost())
    assert [f.describe_variable(i) for i in f.binaries] == ["x[1] b", "x[2] b"]


def test_outputs_that_an_input_moves_at_once(systems):
    assert influenced_outputs(systems.heater()) == (True, True)
    assert influenced_outputs(systems.fold()) == (False,)


def test_hard_limits_are_bounds_and_soft_ones_rows(systems):
    hard = build(systems.fold(), 2, Cost(), Limits(x={"x": (-2, None)}, u={"push": (0, 0.5)}, terminal={"x": (0, 1)}))
    x1, x2 = hard.layout.start("x", 1), hard.layout.start("x", 2)
    assert (hard.lb[x1], hard.ub[x1]) == (-2, 10)
    assert (hard.lb[x2], hard.ub[x2]) == (0, 1)
    assert (hard.lb[0], hard.ub[0]) == (0, 0.5)
    soft = build(systems.fold(), 2, Cost(), Limits(x={"x": (-2, None)}, soft=True, rho=7))
    assert (soft.lb[x1], soft.ub[x1]) == (-10, 10)
    assert soft.objective.P[soft.layout.n - 1, soft.layout.n - 1] == 14.0
    assert (soft.lb[-1], soft.ub[-1]) == (0.0, 8.0)  # the range ends 8 below the limit


def test_slack_bounds_cover_every_violation_that_the_ranges_allow(systems):
    f = build(systems.heater(), 2, Cost(), Limits(y={"felt": (0, 9)}, terminal=([[2.0, 1.0]], [30.0]), soft=True))
    assert f.ub[-2:].tolist() == [50.5, 71.0]  # felt = T + 0.5 fan is at least -50.5; 2 * 50 + 1 - 30 at most


def test_split_and_join_are_inverse(systems):
    f = build(systems.heater(), 3, Cost(), Limits(y={"felt": (0, 1)}, soft=True))
    v = np.arange(f.layout.n, dtype=float)
    plan = f.layout.split(v, np.array([1.0, 0.0]))
    assert plan.x.shape == (4, 2)
    assert np.array_equal(f.layout.join(plan), v)
    assert plan.slack.tolist() == [f.layout.n - 1]


def test_limit_of_an_input_stays_hard_when_an_output_of_its_name_is_softened(systems):
    mld = systems.heater()
    twin = replace(mld, y=(replace(mld.y[0], name="fan"), mld.y[1]))
    f = build(twin, 2, Cost(), Limits(y={"fan": (0, 9)}, u={"fan": (0, 0.5)}, soft=True))
    assert f.layout.slacks == ("fan",)
    assert (f.lb[0], f.ub[0]) == (0, 0.5)
