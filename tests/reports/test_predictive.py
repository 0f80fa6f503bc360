"""Certificates of predictive controllers against closed forms, runs and closed loops."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.analysis.terminal_cost import greatest_addition
from hysdel_py.demos.certified_clutch import (
    CERTIFIED_REFERENCE,
    CERTIFIED_START,
    certified_clutch_controller,
    clutch_terminal_set,
)
from hysdel_py.errors import ArgumentError
from hysdel_py.reports.plan_question import plan_question

UNSTABLE = """SYSTEM s { INTERFACE { STATE { REAL v [-10, 10]; } INPUT { REAL u [-1, 1]; } OUTPUT { REAL seen; } }
  IMPLEMENTATION { CONTINUOUS { v = 1.5*v + u; } OUTPUT { seen = v; } } }"""
"""Can be held where |v| <= 2, and brought to zero from less."""

HEATED = """SYSTEM room { INTERFACE { STATE { REAL T [0, 40]; } INPUT { REAL vent [0, 1]; BOOL heater; } }
  IMPLEMENTATION { AUX { BOOL cold; REAL heat, lost; }
    AD { cold = T <= 15; }
    DA { heat = {IF heater THEN 2 ELSE 0}; lost = {IF cold THEN 0.5 ELSE 1}; }
    CONTINUOUS { T = T + heat - lost - vent; } } }"""


def unstable_controller(end=(-1.0, 1.0), horizon=4, **options):
    limits = hys.Limits(x={"v": (-3, 3)}, terminal={} if end is None else {"v": end})
    return hys.HybridMpc(hys.load(UNSTABLE), horizon, hys.Cost(y={"seen": 1.0}), limits, gap_abs=1e-4, **options)


def named(certificate):
    return {premise.name: premise for premise in certificate.premises}


# ---- a system whose sets are known -----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def proven():
    return hys.predictive_certificate(unstable_controller(), {"v": (-1.5, 1.5)}, target="v >= -1.2 & v <= 1.2")


def test_a_certificate_of_all_premises(proven):
    assert proven.verdict == "proven"
    assert all(premise.holds for premise in proven.premises)
    assert proven.always_has_a_plan
    assert proven.decrease > 0
    assert "reached within" in str(proven)
    assert proven.to_dict()["steps"] == proven.steps


def test_closed_loops_keep_what_is_proven(proven):
    mpc = unstable_controller()
    for v in np.linspace(-1.5, 1.5, 9):
        run = hys.closed_loop(hys.load(UNSTABLE), mpc, [v], 12)
        assert run.steps == 12
        assert run.info["cost"][0] <= proven.cost + 1e-6
        outside = np.abs(run["v"][:-2]) > 1.2
        assert np.all(-np.diff(run.info["cost"])[outside] >= proven.decrease - 1e-9)
        assert np.argmax(np.abs(run["v"]) <= 1.2) <= proven.steps


@pytest.mark.parametrize(("reach", "holds"), [(2.0, True), (2.01, False)])
def test_the_end_can_be_kept_up_to_two(reach, holds):
    """1.5 v - 1 <= v exactly where v <= 2."""
    found = hys.predictive_certificate(unstable_controller((-reach, reach)), {"v": 0.0})
    assert found.terminal.holds == holds
    assert found.always_has_a_plan == holds
    if not holds:
        assert found.terminal.verdict == "violated"
        assert abs(found.terminal.state["v"]) > 2.0


def plan_exists(v, horizon, end):
    """Whether full braking brings |v| below `end` within 3 all the way."""
    v = abs(v)
    for _ in range(horizon):
        v = max(1.5 * v - 1.0, 0.0)
        if v > 3.0:
            return False
    return v <= end


def last_with_a_plan(horizon, end):
    values = np.linspace(0.0, 3.0, 30001)
    return max(v for v in values if plan_exists(v, horizon, end))


@pytest.mark.parametrize("beyond", [-1e-3, 1e-3])
def test_first_states_up_to_the_last_with_a_plan(beyond):
    edge = last_with_a_plan(4, 1.0) + beyond
    found = hys.predictive_certificate(unstable_controller(), {"v": (-0.5, edge)})
    assert found.start.holds == (beyond < 0)
    if beyond > 0:
        assert found.start.verdict == "violated"
        assert found.verdict == "violated"
        assert not plan_exists(found.start.state["v"], 4, 1.0)


def test_without_an_end_sets_of_the_whole_horizon_decide():
    """Levels that can be kept for five steps can be kept for six, though not every level within the limits can."""
    limits = hys.Limits(x={"h1": (0.0, 0.5), "h2": (0.05, 0.5)})
    mpc = hys.HybridMpc(hys.load("two_tanks"), 6, hys.Cost(y={"level2": 1.0}), limits)
    found = hys.predictive_certificate(mpc, {"h1": (0.1, 0.2), "h2": (0.1, 0.2)})
    assert found.terminal.verdict == "violated"
    assert found.next_plan.holds
    assert "feasible sets" in found.next_plan.by
    assert found.verdict == "proven"


def test_a_short_horizon_runs_out_of_plans():
    """From 2.5 full braking gives 2.75 and then 3.125, beyond the limit: after one step there is no plan."""
    found = hys.predictive_certificate(unstable_controller(None, horizon=1), {"v": (2.5, 2.6)})
    assert found.start.holds
    assert found.next_plan.verdict == "violated"
    assert found.next_plan.state["v"] > 8 / 3
    assert found.steps is None


def test_a_target_that_is_too_small_is_not_claimed():
    found = hys.predictive_certificate(unstable_controller(), {"v": (-1.5, 1.5)}, target="v >= -0.01 & v <= 0.01")
    assert found.fall.verdict == "not settled"
    assert found.steps is None
    assert found.always_has_a_plan


@pytest.mark.parametrize(
    ("options", "said"),
    [({"blocking": (2, 2)}, "blocks"), ({"binary_horizon": 2}, "relaxed")],
)
def test_plans_that_cannot_be_shifted_are_not_certified(options, said):
    found = hys.predictive_certificate(unstable_controller(**options), {"v": 0.0})
    assert found.next_plan.verdict == "not settled"
    assert said in found.next_plan.message


def test_limits_over_the_horizon_are_not_certified():
    limits = hys.Limits(x={"v": (-3, [3, 3, 2.5, 2.5])}, terminal={"v": (-1, 1)})
    mpc = hys.HybridMpc(hys.load(UNSTABLE), 4, hys.Cost(x={"v": 1}), limits)
    assert "change over the horizon" in hys.predictive_certificate(mpc, {"v": 0.0}).next_plan.message


def test_a_law_for_the_last_step_bounds_what_it_adds():
    """With the weight 3 of the last state and u = -1.4 v there, V falls: v^2 + 3 (0.1 v)^2 - 3 v^2 < 0."""
    limits = hys.Limits(x={"v": (-3, 3)}, terminal={"v": (-0.7, 0.7)})
    cost = hys.Cost(y={"seen": 1.0}, terminal={"v": 3.0})
    mpc = hys.HybridMpc(hys.load(UNSTABLE), 4, cost, limits, gap_abs=1e-4, gap_rel=0.0)
    target = "v >= -0.3 & v <= 0.3"
    free = hys.predictive_certificate(mpc, {"v": (-1, 1)}, target=target)
    assert free.fall.verdict == "not settled"  # the worst input at the end may undo everything
    led = hys.predictive_certificate(mpc, {"v": (-1, 1)}, target=target, last_law=([[-1.4]], [0.0]))
    assert led.verdict == "proven"
    assert led.decrease == pytest.approx(0.09 - 1e-4, abs=0.02)
    for v in np.linspace(-1, 1, 9):
        run = hys.closed_loop(hys.load(UNSTABLE), mpc, [v], 10)
        assert np.argmax(np.abs(run["v"]) <= 0.3) <= led.steps


@pytest.mark.parametrize(("law", "verdict"), [(([[-1.4]], [0.0]), "proven"), (([[-0.4]], [0.0]), "violated")])
def test_a_law_has_to_lead_back(law, verdict):
    found = hys.predictive_certificate(unstable_controller((-0.7, 0.7)), {"v": 0.0}, last_law=law)
    assert found.terminal.verdict == verdict


# ---- Booleans, softened limits, absolute values ----------------------------------------------------------------------


def heated_controller(**limits):
    cost = hys.Cost(x={"T": 1.0}, u={"heater": 0.1}, terminal={"T": 1.0})
    return hys.HybridMpc(hys.load(HEATED), 3, cost, hys.Limits(**limits), references=("T", "heater"))


def test_a_model_with_a_threshold_and_a_switch():
    """From [18, 21] one heated or vented step stays there: -1 - vent, or +1 - vent, with vent in [0, 1]."""
    mpc = heated_controller(x={"T": (10, 30)}, terminal={"T": (18, 21)})
    found = hys.predictive_certificate(mpc, {"T": (16.5, 23)}, ref={"T": 20, "heater": 0}, target="T >= 17 & T <= 22")
    assert found.terminal.holds
    assert found.always_has_a_plan
    for T in np.linspace(16.5, 23, 27):
        run = hys.closed_loop(hys.load(HEATED), mpc, [T], 6, {"T": 20, "heater": 0})
        assert run.steps == 6
        assert run["T"].min() >= 10


def test_an_end_that_is_too_narrow_for_the_steps():
    """Within [18, 18.5] no step is shorter than the way out: from 18.3 they lead to [16.3, 17.3] or [18.3, 19.3]."""
    found = hys.predictive_certificate(
        heated_controller(terminal={"T": (20.0, 20.2)}), {"T": 20.0}, ref={"T": 20, "heater": 0}
    )
    assert found.terminal.holds  # heated and vented as much a step may change nothing
    narrow = heated_controller(u={"vent": (0, 0.5)}, terminal={"T": (20.0, 20.2)})
    found = hys.predictive_certificate(narrow, {"T": 20.0}, ref={"T": 20, "heater": 0})
    assert found.terminal.verdict == "violated"


def test_softened_limits_are_named():
    mpc = hys.HybridMpc(
        hys.load(UNSTABLE), 4, hys.Cost(x={"v": 1}), hys.Limits(x={"v": (-3, 3)}, terminal={"v": (-1, 1)}, soft=("v",))
    )
    found = hys.predictive_certificate(mpc, {"v": 0.0})
    assert "softened" in found.limits.message
    assert found.terminal.verdict == "violated"  # the softened end is none


def test_absolute_values_have_a_plan_but_no_bound_of_the_cost():
    limits = hys.Limits(x={"v": (-3, 3)}, terminal={"v": (-1, 1)})
    mpc = hys.HybridMpc(hys.load(UNSTABLE), 3, hys.Cost(x={"v": 1}, norm=1), limits)
    found = hys.predictive_certificate(mpc, {"v": (-1, 1)}, target="v >= -0.9 & v <= 0.9")
    assert found.always_has_a_plan
    assert found.fall.verdict == "not settled"
    assert "squares" in found.fall.message


# ---- what one more step adds -----------------------------------------------------------------------------------------


def test_no_random_step_at_the_end_adds_more_than_the_bound():
    mpc = heated_controller(x={"T": (10, 30)}, terminal={"T": (13, 18)})
    model = mpc.model
    question = plan_question(mpc, model, mpc.references.table({"T": 16, "heater": 0}))
    added = greatest_addition(
        model.pwa, question.ends, question.limits, (question.stage, question.terminal), allowed=1.0, parts=1000
    )
    rng, worst = np.random.default_rng(0), -np.inf
    for _ in range(4000):
        T, u = rng.uniform(13, 18), np.array([rng.uniform(0, 1), rng.integers(0, 2)])
        after = model.dha.step([T], u)[0][0]
        if 13 <= after <= 18:
            cost = (T - 16) ** 2 + 0.1 * u[1]
            worst = max(worst, cost + (after - 16) ** 2 - (T - 16) ** 2)
    assert worst <= added.bound
    assert worst >= added.bound - 0.5
    assert added.seen <= added.bound


# ---- what no plan does -----------------------------------------------------------------------------------------------


def test_what_no_plan_does_after_its_first_step():
    mpc = unstable_controller(None)
    assert hys.plans_never(mpc, "v >= 3.01").verdict == "proven"
    found = hys.plans_never(mpc, "v >= 2.2")
    assert found.verdict == "violated"
    assert 1.5 * found.state["v"] + 1 >= 2.2 - 1e-6


def test_longer_plans_rule_out_more():
    """Above 8/3 there is no second step within 3, above 22/9 no third."""
    assert hys.plans_never(unstable_controller(None, horizon=1), "v >= 2.9").verdict == "violated"
    assert hys.plans_never(unstable_controller(None, horizon=2), "v >= 2.9").verdict == "proven"
    assert hys.plans_never(unstable_controller(None, horizon=2), "v >= 2.5").verdict == "violated"
    assert hys.plans_never(unstable_controller(None, horizon=3), "v >= 2.5").verdict == "proven"


def test_plans_of_one_step_do_not_hold_outputs():
    """The output at the next state is in no row: nothing is claimed of it."""
    mpc = hys.HybridMpc(hys.load(UNSTABLE), 1, hys.Cost(y={"seen": 1}), hys.Limits(y={"seen": (-2, 2)}))
    assert hys.plans_never(mpc, "v >= 2.5").verdict == "violated"
    found = hys.predictive_certificate(mpc, {"v": 0.0})
    assert found.limits.verdict == "not settled"
    assert "seen" in found.limits.message
    two = hys.HybridMpc(hys.load(UNSTABLE), 2, hys.Cost(y={"seen": 1}), hys.Limits(y={"seen": (-2, 2)}))
    assert hys.plans_never(two, "v >= 2.5").verdict == "proven"


def test_an_end_in_which_no_plan_ends_is_no_proof():
    """The rows of the end contradict the limits: nothing falls."""
    limits = hys.Limits(x={"v": (-3, 3)}, terminal=([[1.0]], [-4.0]))
    mpc = hys.HybridMpc(hys.load(UNSTABLE), 2, hys.Cost(y={"seen": 1}), limits)
    found = hys.predictive_certificate(mpc, {"v": 0.0}, target="v >= -1 & v <= 1")
    assert (found.terminal.verdict, found.start.verdict, found.fall.verdict) == ("violated", "violated", "not settled")


TRAPPED = """SYSTEM s { INTERFACE { STATE { REAL v [0, 30]; } INPUT { REAL u [-0.4, 0.4]; } OUTPUT { REAL seen; } }
  IMPLEMENTATION { AUX { BOOL below, above; REAL thrown; } AD { below = v <= 1.4; above = v >= 1.9; }
    DA { thrown = {IF below | above THEN 0 ELSE 20}; }
    CONTINUOUS { v = v + thrown + u; } OUTPUT { seen = v; } } }"""
"""Between 1.4 and 1.9 the state is thrown out of its limits, and no step is longer than 0.4: nobody gets below."""

STEPPED = """SYSTEM s { INTERFACE { STATE { REAL v [0, 4]; } INPUT { REAL u [-0.4, 0.4]; } OUTPUT { REAL seen; } }
  IMPLEMENTATION { CONTINUOUS { v = v + u; } OUTPUT { seen = v; } } }"""


@pytest.mark.parametrize(
    ("source", "limits", "law", "said"),
    [
        (TRAPPED, hys.Limits(x={"v": (0, 4)}), ([[0.0]], [-0.3]), "one more step is not proven"),
        (STEPPED, hys.Limits(x={"v": (2, 4)}, soft=True), ([[-0.1]], [0.0]), "price of softened limits"),
    ],
)
def test_a_loop_that_never_gets_there_is_not_proven_to(source, limits, law, said):
    """Plans end in a trap that no plan leaves, or a softened limit is dearer than what the law at the end saves."""
    model = hys.load(source)
    mpc = hys.HybridMpc(model, 2, hys.Cost(y={"seen": 1.0}, terminal={"v": 10.0}), limits, gap_abs=1e-4)
    assert hys.closed_loop(model, mpc, [3.0], 20)["v"].min() > 1.8
    found = hys.predictive_certificate(mpc, {"v": 3.0}, target="v <= 1", last_law=law)
    assert found.always_has_a_plan
    assert found.fall.verdict == "not settled"
    assert said in found.fall.message
    assert found.steps is None


def test_softened_plans_keep_declared_ranges_only():
    mpc = unstable_controller(None)
    assert hys.plans_never(mpc, "v >= 3.01", softened=True).verdict == "violated"
    assert hys.plans_never(mpc, "v >= 10.01", softened=True).verdict == "proven"


# ---- arguments -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"start": {"v": (-11, 0)}}, "leaves its range"),
        ({"start": {"w": 0}}, "there is no w"),
        ({"start": {"v": (1, 0)}}, "holds no number"),
        ({"target": "u >= 0"}, "reads more than states"),
        ({"boxes": 0}, "boxes is 0"),
        ({"parts": True}, "parts is True"),
        ({"seconds": -1}, "seconds is -1"),
        ({"ref": {"w": 0}}, "reference w"),
        ({"controller": "mpc"}, "a HybridMpc was expected"),
        ({"last_law": ([[1.0, 2.0]], [0.0])}, "last_law: K has shape"),
        ({"last_law": 3}, "last_law is 3"),
    ],
)
def test_wrong_arguments_are_told(change, said):
    given = {"controller": unstable_controller(), "start": {"v": 0.0}} | change
    with pytest.raises(ArgumentError, match=said):
        hys.predictive_certificate(given.pop("controller"), given.pop("start"), **given)


def test_a_form_without_its_source_is_refused():
    mpc = hys.HybridMpc(hys.load(UNSTABLE).mld, 2, hys.Cost(x={"v": 1}))
    with pytest.raises(ArgumentError, match="built from a Mld"):
        hys.predictive_certificate(mpc, {"v": 0.0})
    with pytest.raises(ArgumentError, match="built from a Mld"):
        hys.plans_never(mpc, "v >= 0")


# ---- the clutch ------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def clutch():
    return hys.load("clutch", we_min=60.0)


def test_the_clutch_is_proven_to_keep_its_limit_and_to_lock(clutch):
    mpc = certified_clutch_controller(clutch)
    found = hys.predictive_certificate(mpc, CERTIFIED_START, ref=CERTIFIED_REFERENCE, target="gamma <= 1")
    assert found.verdict == "proven"
    assert found.steps < 2000
    assert hys.plans_never(mpc, "we <= 79.999").verdict == "proven"


def test_random_states_at_the_end_have_a_step_back(clutch):
    """Independent of sets: inputs on a grid, simulated by the model."""
    S, T = clutch_terminal_set(clutch)
    rng, found = np.random.default_rng(0), 0
    tried = [np.array([5 * a, 0.4 * b]) for a in np.linspace(1, -1, 21) for b in (0, 1, -1)]
    for _ in range(400):
        we, gamma = rng.uniform(81, 112), rng.choice([rng.uniform(0, 2), rng.uniform(0, 40)])
        Fn = 0.67 * we + rng.uniform(8.2, 11.8)
        x = np.array([we, gamma, Fn - rng.uniform(-0.4, 8), Fn, rng.uniform(-3, 3)])
        if np.any(S @ x > T - 0.05):
            continue
        found += 1
        after = (clutch.dha.step(x, u, check=False)[0] for u in tried)
        assert any(np.all(S @ x1 <= T + 1e-9) for x1 in after), x
    assert found > 100
