"""Explicit laws of hybrid controllers against enumeration of all sequences and the controller online."""

from concurrent.futures import ThreadPoolExecutor
from itertools import product

import numpy as np
import pytest
from scipy.optimize import linprog

import hysdel_py as hys
from hysdel_py.control.explicit_hybrid import explicit_hybrid
from hysdel_py.control.explicit_parameters import choose_parameters
from hysdel_py.control.hybrid_dominance import upper_bound
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.optimize.mpmiqp import MpMiqpSettings

TIGHT = {"gap_rel": 1e-9, "gap_abs": 1e-8}


def fold_controller(systems, norm=2, N=2, **options):
    cost = hys.Cost(x=[1.0], u=[0.3], norm=norm)
    return hys.HybridMpc(systems.fold(power=2.0), N, cost, **TIGHT, **options)


def heater_controller(systems, norm=2, **options):
    cost = hys.Cost(y={"felt": 1}, u={"switch": 0.5, "fan": 0.2}, norm=norm)
    return hys.HybridMpc(systems.heater(), 2, cost, references=("felt",), **TIGHT, **options)


def enumerated(mpc, x, ref=None, last=None):
    """Least cost over all values of the binaries, each by a program of its own (no propagation, no pruning)."""
    program = mpc.problem(x, ref, last_input=last)
    at, best = program.binaries, np.inf
    for bits in product((0.0, 1.0), repeat=len(at)):
        lb, ub = program.qp.lb.copy(), program.qp.ub.copy()
        lb[at] = ub[at] = bits
        best = min(best, least(program.qp.with_vectors(lb=lb, ub=ub)))
    return best


def least(qp):
    if not qp.P.nnz:
        A = np.vstack([qp.A.toarray(), -qp.A.toarray()])
        b = np.concatenate([qp.u, -qp.l])
        real = np.isfinite(b)
        answer = linprog(qp.q, A[real], b[real], bounds=np.column_stack([qp.lb, qp.ub]))
        return answer.fun + qp.constant if answer.status == 0 else np.inf
    from hysdel_py.optimize.qp import QpSettings
    from hysdel_py.optimize.verified import VerifiedSolver

    settings = QpSettings(accuracy=1e-10, feasibility=1e-8, stationarity=1e-7)
    answer = VerifiedSolver(qp, "piqp", settings).solve(qp).answer
    return answer.objective if answer.status.value == "optimal" else np.inf


@pytest.mark.parametrize("norm", [2, 1, np.inf])
def test_value_is_that_of_the_best_sequence(systems, norm):
    mpc = fold_controller(systems, norm)
    law = hys.explicit(mpc, {"x": (-6, 6)})
    whole = explicit_hybrid(mpc, {"x": (-6, 6)}, reduce=False)
    assert law.complete
    several = 0
    for x in np.random.default_rng(3).uniform(-6, 6, 15):
        best = enumerated(mpc, [x])
        values = [sequence.law.value([x]) for sequence in whole.sequences]
        several += np.ptp([value for value in values if np.isfinite(value)] or [0.0]) > 1e-3
        assert law.value([x]) == pytest.approx(best, abs=1e-6)
        assert whole.value([x]) == pytest.approx(best, abs=1e-6)
    assert several > 3 or norm != 2  # with the other norms sequences that overlap cost the same here


def test_boolean_states_inputs_and_references(systems):
    mpc = heater_controller(systems, limits=hys.Limits(x={"T": (-8, 8)}))
    law = hys.explicit(mpc, {"T": (-5, 5), "felt": (-2, 2)})
    assert law.names == ("T", "on", "r(felt)")
    rng = np.random.default_rng(5)
    for _ in range(12):
        T, on, ref = rng.uniform(-5, 5), float(rng.integers(0, 2)), rng.uniform(-2, 2)
        zeta = {"T": T, "on": on, "r(felt)": ref}
        assert law.value(zeta) == pytest.approx(enumerated(mpc, [T, on], [ref]), abs=1e-6)
        u = law(zeta)
        assert u[1] in (0.0, 1.0)
    assert law([0.0, 0.5, 0.0]) is None


@pytest.mark.parametrize("norm", [2, 1])
def test_certificate_with_soft_limits_blocks_increments_and_a_terminal_set(systems, norm):
    cost = hys.Cost(x=[1.0], du=[0.3], norm=norm)
    limits = hys.Limits(x={"x": (-3, 3)}, du={"push": (-1, 1)}, terminal={"x": (-2.5, 2.5)}, soft=("x",), rho=20.0)
    mpc = hys.HybridMpc(systems.fold(power=2.0), 3, cost, limits, blocking=(1, 2), **TIGHT)
    law = hys.explicit(mpc, {"x": (-5, 5)})
    assert law.names == ("x", "push(-1)")
    found = law.certificate(mpc, 40, seed=2)
    assert found.holds(), found
    assert found.feasible


def test_certificate_counts_points_without_a_plan(systems):
    mpc = fold_controller(systems, limits=hys.Limits(x={"x": (-1, 1)}))
    law = hys.explicit(mpc)
    found = law.certificate(mpc, 40, seed=1)
    assert found.holds()
    assert found.infeasible
    outside = law.evaluate([9.0])
    assert outside.status is hys.MoveStatus.INFEASIBLE
    assert outside.u is None
    assert law.evaluate([11.0]).status is hys.MoveStatus.NO_PLAN


def test_certificate_sees_a_missing_sequence(systems):
    from dataclasses import replace

    mpc = fold_controller(systems)
    law = hys.explicit(mpc)
    broken = replace(law, sequences=law.sequences[1:])
    assert not broken.certificate(mpc, 30).holds()


def test_relaxed_switches(systems):
    mpc = fold_controller(systems, N=3, binary_horizon=1)
    law = hys.explicit(mpc, {"x": (-6, 6)})
    assert law.certificate(mpc, 20).holds()
    assert law.evaluate([1.0]).approximate_from == 1
    assert all(len(sequence.word) == 1 for sequence in law.sequences)


@pytest.mark.parametrize("norm", [2, 1, np.inf])
def test_removing_overlaps_keeps_the_value(systems, norm):
    mpc = fold_controller(systems, norm, N=3)
    whole = explicit_hybrid(mpc, {"x": (-6, 6)}, reduce=False)
    law = whole.reduced()
    assert law.count < whole.count or law.partition
    for x in np.linspace(-6, 6, 400):
        assert law.value([x]) == pytest.approx(whole.value([x]), abs=1e-9)
    if norm != 2:
        single = law.single()
        doubled = [x for x in np.linspace(-6, 6, 997) if np.sum(single.excess([x]) < -1e-7) > 1]
        assert not doubled
        assert single.value([1.3]) == pytest.approx(law.value([1.3]), abs=1e-12)


def test_same_bytes_with_an_executor(systems, tmp_path):
    mpc = heater_controller(systems)
    box = {"T": (-5, 5), "felt": (-2, 2)}
    alone = explicit_hybrid(mpc, box)
    with ThreadPoolExecutor(2) as pool:
        spread = explicit_hybrid(mpc, box, executor=pool)
    for name in ("A", "b", "K", "k", "P", "q", "r"):
        for one, other in zip(alone.sequences, spread.sequences, strict=True):
            assert np.array_equal(getattr(one.law, name), getattr(other.law, name))


def test_interrupt_leaves_a_usable_law(systems):
    calls = []

    def interrupt(*numbers):
        calls.append(numbers)
        if numbers[0] >= 2:
            raise KeyboardInterrupt

    law = explicit_hybrid(
        fold_controller(systems, N=3), {"x": (-6, 6)}, progress=interrupt, settings=MpMiqpSettings(chunk=1)
    )
    assert not law.complete
    assert law.sequences
    assert law.report.stop == "interrupted"
    moves = [law.evaluate([x]) for x in np.linspace(-6, 6, 50)]
    statuses = {move.status for move in moves}
    assert statuses == {hys.MoveStatus.FEASIBLE, hys.MoveStatus.NO_PLAN}


def test_save_and_load(systems, tmp_path):
    law = hys.explicit(heater_controller(systems), {"T": (-5, 5), "felt": (-2, 2)})
    law.save(tmp_path / "law.npz")
    again = HybridLaw.load(tmp_path / "law.npz")
    assert again.describe(True) == law.describe(True)
    for zeta in np.random.default_rng(0).uniform([-5, 0, -2], [5, 0, 2], (20, 3)):
        assert again.locate(zeta) == law.locate(zeta)
    law.save(tmp_path / "other.npz")
    assert (tmp_path / "other.npz").read_bytes() == (tmp_path / "law.npz").read_bytes()
    np.savez(tmp_path / "odd.npz", a=1)
    with pytest.raises(hys.ArgumentError, match="no explicit hybrid law"):
        HybridLaw.load(tmp_path / "odd.npz")


def test_closed_loop_takes_the_law(systems):
    mpc = heater_controller(systems)
    law = hys.explicit(mpc, {"T": (-10, 10), "felt": (-2, 2)})
    run, online = (hys.closed_loop(systems.heater(), c, [-4, 0], 6, {"felt": 1.0}) for c in (law, mpc))
    assert run.steps == 6
    assert np.allclose(run.info["cost"], online.info["cost"], atol=1e-6)


def test_ties_go_to_the_first_sequence(systems):
    law = explicit_hybrid(fold_controller(systems), {"x": (-6, 6)}, reduce=False)
    doubled = HybridLaw(**{name: getattr(law, name) for name in law.__dataclass_fields__})
    object.__setattr__(doubled, "sequences", (*law.sequences, *law.sequences))
    for x in np.linspace(-6, 6, 60):
        place = doubled.locate([x])
        assert place is None or place == law.locate([x])


@pytest.mark.parametrize(
    ("box", "fixed", "message"),
    [
        ({"y": (0, 1)}, None, "y is no parameter"),
        ({"x": (2, 1)}, None, "low <= high"),
        ({"x": (20, 30)}, None, "number in"),
        ({"x": 3}, None, "pair"),
        ({"x": (np.nan, 1)}, None, "NaN"),
        ({"x": (0, 1)}, {"x": 1}, "has a box and is fixed"),
        (None, {"x": 1}, "every real parameter is fixed"),
        (None, {"x": 11}, "number in"),
    ],
)
def test_wrong_parameters(systems, box, fixed, message):
    with pytest.raises(hys.ArgumentError, match=message):
        hys.explicit(fold_controller(systems), box, fixed=fixed)


def test_a_reference_needs_a_box_or_a_value(systems):
    with pytest.raises(hys.ArgumentError, match=r"r\(felt\) has no bounded range"):
        hys.explicit(heater_controller(systems))
    law = hys.explicit(heater_controller(systems), fixed={"felt": 1.0, "on": 0})
    assert law.names == ("T",)
    with pytest.raises(hys.ArgumentError, match="fixed value 1"):
        law.solve([0, 0], {"felt": 2.0})
    with pytest.raises(hys.ArgumentError, match="varies"):
        law.solve([0, 0], {"felt": [1.0, 2.0]})


def test_bound_of_a_difference_is_one(systems):
    rng = np.random.default_rng(4)
    rows = np.vstack([np.eye(3), -np.eye(3)]), np.full(6, 0.8)
    for _ in range(20):
        M = rng.normal(size=(3, 3))
        P, q = M + M.T, rng.normal(size=3)
        points = rng.uniform(-0.8, 0.8, (2000, 3))
        values = 0.5 * np.einsum("ij,jk,ik->i", points, P, points) + points @ q
        assert upper_bound((P, q, 0.0), rows)[0] >= values.max()


def test_bound_of_a_concave_form_is_close():
    rows = np.vstack([np.eye(2), -np.eye(2)]), np.ones(4)
    assert upper_bound((-np.eye(2), np.zeros(2), -0.25), rows)[0] == pytest.approx(-0.25, abs=1e-6)


def test_a_cost_that_no_input_changes(systems):
    """Over one step without weight on the last state only the measured one counts: (x - 0)^2, whatever the input."""
    mpc = hys.HybridMpc(systems.fold(), 1, hys.Cost(y=[1.0]), **TIGHT)
    law = hys.explicit(mpc)
    for x in (-3.0, 0.5, 7.0):
        assert law.value([x]) == pytest.approx(x * x)


def test_settings_and_points_of_another_kind_are_named(systems):
    controller = fold_controller(systems)
    with pytest.raises(hys.ArgumentError, match="settings is a int: a MpMiqpSettings was expected"):
        hys.explicit(controller, {"x": (0, 1)}, settings=3)
    with pytest.raises(hys.ArgumentError, match="zeta is 'a'"):
        choose_parameters(controller, {"x": (0, 1)}, None).point("a")
