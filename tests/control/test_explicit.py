"""Explicit laws of linear controllers: parameters, slices, and agreement with the controller online."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.control.explicit import parametric_controller
from hysdel_py.control.explicit_certificate import random_points
from hysdel_py.geometry.polyhedron import Polyhedron

INTEGRATOR = hys.Lti([[1, 1], [0, 1]], [[1], [0.5]], x=("pos", "vel"), u=("force",))
SQUARE = {"x": (-6.0, 6.0)}


def regulator():
    limits = hys.LinearLimits(u=(-1, 1), y=(-5, 5), rho=np.inf)
    return hys.LinearMpc(INTEGRATOR, "regulator", 4, hys.LinearCost(u=1.0), limits)


def softened():
    limits = hys.LinearLimits(u=(-1, 1), y=(-3, 3), rho=50.0, slack="signal")
    return hys.LinearMpc(INTEGRATOR, "regulator", 3, limits=limits, control_horizon=2)


def tracking():
    lti = hys.Lti([[0.8, 0.1], [0, 0.6]], [[0.2], [0.5]], [[1, 0]], y=("level",), u=("flow",), x=("h", "q"), ts=0.5)
    limits = hys.LinearLimits(u=(-1, 1), du=(-0.4, 0.4), y=(-1, 1))
    return hys.LinearMpc(lti, "track", 5, hys.LinearCost(du=0.05), limits, control_horizon=2)


CASES = {
    "regulator": (regulator, SQUARE),
    "softened": (softened, SQUARE),
    "tracking": (tracking, {"x": (-2, 2), "u": (-1, 1), "r": (-1.5, 1.5)}),
}


@cache
def made(name):
    make, box = CASES[name]
    mpc = make()
    return mpc, hys.explicit(mpc, box), parametric_controller(mpc, box).problem


def split(mpc, zeta):
    """State, reference and last input from the parameters of a law."""
    nx, nu = mpc.lti.nx, mpc.lti.nu * mpc.uses_last_input
    return zeta[:nx], zeta[nx + nu :] if mpc.tracks else None, zeta[nx : nx + nu] if nu else None


# ------------------------------------------------------------------ agreement


@pytest.mark.parametrize("name", sorted(CASES))
def test_explicit_is_online(name):
    """At 250 random points each (benchmarks/linear_mpc.py takes 2000); feasible and infeasible ones."""
    mpc, law, _ = made(name)
    assert law.complete
    feasible = 0
    for zeta in random_points(law, 250, np.random.default_rng(3)):
        arguments = split(mpc, zeta)
        online, own = mpc.solve(*arguments), law.solve(*arguments)
        if not online.ok:
            assert np.min(law.excess(zeta)) > -1e-6
            continue
        feasible += 1
        assert own.ok or np.min(law.excess(zeta)) < 1e-6
        if own.ok:
            assert own.u == pytest.approx(online.u, abs=1e-6)
            assert own.cost == pytest.approx(online.cost, rel=1e-6, abs=1e-7)
    assert feasible > 100


@pytest.mark.parametrize("name", sorted(CASES))
def test_laws_are_continuous_and_certified(name):
    _, law, problem = made(name)
    certificate = law.certificate(problem, samples=100)
    assert certificate.holds()
    assert certificate.jump < 1e-8


@pytest.mark.parametrize("name", sorted(CASES))
def test_closed_loops_agree(name):
    mpc, law, _ = made(name)
    more = {"ref": [0.5], "last_input": [0.0]} if mpc.tracks else {}
    start = [1.0, -0.5]
    runs = [hys.closed_loop(mpc.lti, controller, start, 25, **more) for controller in (mpc, law)]
    assert runs[0].steps == runs[1].steps == 25
    assert runs[0].x == pytest.approx(runs[1].x, abs=1e-6)
    assert runs[1].t[-1] == 25 * mpc.lti.ts


# ------------------------------------------------------------------ parameters


def test_names_of_the_parameters():
    assert made("regulator")[1].names == ("pos", "vel")
    assert made("tracking")[1].names == ("h", "q", "flow(-1)", "r(level)")


def test_a_law_of_inputs_is_the_law_of_increments_plus_the_last_input():
    mpc, law, _ = made("tracking")
    inputs = hys.explicit(mpc, CASES["tracking"][1], move="input")
    assert inputs.count == law.count
    for zeta in random_points(law, 50, np.random.default_rng(1)):
        assert inputs(zeta) == pytest.approx(law(zeta) + zeta[2:3], abs=1e-9)
        assert inputs.solve(*split(mpc, zeta)).u == pytest.approx(law.solve(*split(mpc, zeta)).u, abs=1e-9)
        assert inputs.value(zeta) == pytest.approx(law.value(zeta), abs=1e-8)
    problem = parametric_controller(mpc, CASES["tracking"][1], move="input").problem
    assert inputs.certificate(problem, samples=60).holds()


def test_fixed_parameters_are_a_slice():
    mpc, law, _ = made("tracking")
    box = {"x": (-2, 2), "u": (-1, 1)}
    fixed = hys.explicit(mpc, box, fixed={"r": 0.5})
    assert fixed.names == ("h", "q", "flow(-1)")
    sliced = law.fixed({"r(level)": 0.5})
    for zeta in random_points(fixed, 50, np.random.default_rng(2)):
        assert fixed(zeta) == pytest.approx(sliced(zeta), abs=1e-8)
        for own in (fixed, sliced):
            assert own.solve(zeta[:2], None, zeta[2:]).u == pytest.approx(own(zeta) + zeta[2:])
    other = fixed.solve([0, 0], [0.7], [0.0])
    assert not other.ok
    assert "the law holds for r(level) = 0.5 only" in other.message


def test_forms_of_a_box():
    mpc = regulator()
    boxes = (
        SQUARE,
        {"pos": (-6, 6), "vel": (-6, 6)},
        ([-6, -6], [6, 6]),
        (-6, 6),
        Polyhedron.box([-6, -6], [6, 6]),
    )
    counts = {hys.explicit(mpc, box).count for box in boxes}
    assert counts == {made("regulator")[1].count}


def test_declared_ranges_stand_in_for_the_box():
    source = (
        "SYSTEM t { INTERFACE { STATE { REAL x [-9, 9]; } INPUT { REAL u [-1, 1]; } OUTPUT { REAL y; } } "
        "IMPLEMENTATION { CONTINUOUS { x = 0.9*x + u; } OUTPUT { y = x; } } }"
    )
    mpc = hys.LinearMpc(hys.load(source), "track", 3, limits=hys.LinearLimits(y=(-5, 5)))
    low, high = hys.explicit(mpc).domain.bounding_box
    assert low == pytest.approx([-9, -1, -5])
    assert high == pytest.approx([9, 1, 5])


def test_a_section_continues_regions_beyond_the_domain():
    _, law, _ = made("regulator")
    small = hys.explicit(regulator(), (-1.0, 1.0))
    window = Polyhedron.box([-3.0], [3.0])
    inside, beyond = small.fixed({"vel": 0.0}), small.section({"vel": 0.0}, window)
    assert inside([2.0]) is None
    assert beyond([2.0]) is not None
    assert beyond([0.3]) == pytest.approx(law([0.3, 0.0]), abs=1e-9)
    with pytest.raises(hys.ArgumentError, match="window has 2 columns: 1 were expected, pos"):
        small.section({"vel": 0.0}, Polyhedron.box([0, 0], [1, 1]))


# ------------------------------------------------------------------ runs, files


def test_executor_progress_and_limits_are_passed_on():
    seen = []
    with ThreadPoolExecutor(2) as pool:
        law = hys.explicit(regulator(), SQUARE, executor=pool, progress=lambda *state: seen.append(state))
    assert seen
    assert np.array_equal(law.K, made("regulator")[1].K)
    partial = hys.explicit(regulator(), SQUARE, settings=hys.MpQpSettings(regions=3))
    assert not partial.complete
    answers = [partial.solve(x) for x in random_points(law, 60, np.random.default_rng(0))]
    assert any("not complete" in move.message for move in answers if not move.ok)


def test_a_law_without_an_answer_says_why():
    law = made("regulator")[1]
    outside, hopeless = law.solve([7.0, 0.0]), law.solve([4.9, 4.0])
    assert (outside.status, outside.u) == (hys.MoveStatus.NO_PLAN, None)
    assert "pos = 7, vel = 0 lies outside the box" in outside.message
    assert hopeless.status is hys.MoveStatus.INFEASIBLE


def test_files_keep_what_the_parameters_mean(tmp_path):
    mpc, law, _ = made("tracking")
    sliced = law.fixed({"r(level)": 0.25})
    for number, own in enumerate((law, sliced)):
        own.save(tmp_path / f"{number}.npz")
        again = hys.ExplicitLaw.load(tmp_path / f"{number}.npz")
        assert again.signals == own.signals
        assert again.solve([0.1, 0.2], None, [0.0]).u == pytest.approx(own.solve([0.1, 0.2], None, [0.0]).u)
    assert law.merged().solve([0.1, 0.2], [0.3], [0.0]).u == pytest.approx(mpc.solve([0.1, 0.2], [0.3], [0.0]).u)


# ------------------------------------------------------------------ arguments


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"controller": "mpc"}, "controller is a str: a LinearMpc or HybridMpc was expected"),
        ({"box": None}, "box has no interval for h, q, and"),
        ({"box": {"speed": (0, 1)}}, "there is no parameter 'speed'; expected one of h, q, flow"),
        ({"box": {"x": (1, -1), "r": (0, 1)}}, r"box of h is \[1, -1\]"),
        ({"box": {"x": 3}}, r"box x is 3: a pair \(low, high\)"),
        ({"box": {"x": ([0, 0, 0], 1)}}, "a number or 2 numbers were expected"),
        ({"box": {"x": (-np.inf, 1)}}, "finite numbers were expected"),
        ({"box": Polyhedron.box([0], [1])}, "box has 1 columns: 4 were expected, h, q, flow"),
        ({"fixed": {"r(speed)": 1}}, r"there is no parameter 'r\(speed\)'"),
        ({"fixed": {"x": 0, "u": 0, "r": 0}}, "all parameters are fixed"),
        ({"fixed": [1]}, "a mapping of parameters"),
        ({"move": "rate"}, "move is 'rate'"),
    ],
)
def test_wrong_arguments(arguments, message):
    given = {"controller": tracking(), "box": CASES["tracking"][1]} | arguments
    with pytest.raises(hys.ArgumentError, match=message):
        hys.explicit(given.pop("controller"), given.pop("box"), **given)


def test_a_regulator_has_no_increments():
    with pytest.raises(hys.ArgumentError, match="a regulator plans inputs"):
        hys.explicit(regulator(), SQUARE, move="increment")


def test_wrong_calls_of_a_law():
    law = made("tracking")[1]
    with pytest.raises(hys.ArgumentError, match=r"the law depends on flow\(-1\)"):
        law.solve([0, 0], [0.0])
    with pytest.raises(hys.ArgumentError, match="reference speed is not known: expected level"):
        law.solve([0, 0], {"speed": 1.0}, [0.0])
    with pytest.raises(hys.ArgumentError, match="the law takes no preview"):
        law.solve([0, 0], {"level": [1.0, 2.0]}, [0.0])
    with pytest.raises(hys.ArgumentError, match=r"the reference has shape \(2,\)"):
        law.solve([0, 0], [1.0, 2.0], [0.0])
    lti = hys.Lti([[0.5]], [[1.0]], y=("level",))
    strict = hys.LinearMpc(lti, "track", 2, references=("level",))
    with pytest.raises(hys.ArgumentError, match="no reference for level"):
        hys.explicit(strict, (-1, 1)).solve([0.0], None, [0.0])
    problem = parametric_controller(tracking(), CASES["tracking"][1]).problem
    bare = hys.ExplicitLaw.of(hys.solve_mpqp(problem))
    with pytest.raises(hys.ArgumentError, match="call law"):
        bare.solve([0, 0])


def test_a_state_named_like_a_last_input_is_refused():
    delayed = hys.Lti([[0.9, 0.5], [0, 0]], [[0], [1]], [[1, 0]], x=("h", "flow(-1)"), u=("flow",), y=("level",))
    mpc = hys.LinearMpc(delayed, "track", 3, limits=hys.LinearLimits(u=(-1, 1)))
    with pytest.raises(hys.ArgumentError, match=r"two parameters of the law are called flow\(-1\)"):
        hys.explicit(mpc, {"x": (-2, 2), "u": (-1, 1), "r": (-1, 1)})


def test_a_free_move_that_changes_nothing_does_not_empty_the_law():
    lti = hys.Lti([[0.8]], [[0.5]], x=("h",), u=("flow",), y=("level",))
    mpc = hys.LinearMpc(lti, "track", 3, hys.LinearCost(du=0.0))  # the last increment acts on no output that counts
    law = hys.explicit(mpc, {"x": (-2, 2), "u": (-1, 1), "r": (-1, 1)})
    assert law.complete
    assert law.count == 1
    for zeta in ([1.5, 0.5, -1.0], [-2.0, 1.0, 0.3]):
        move = mpc.solve(*split(mpc, np.array(zeta)))
        assert law.solve(*split(mpc, np.array(zeta))).cost == pytest.approx(move.cost, abs=1e-8)
        assert law(zeta) == pytest.approx(move.u - zeta[1], abs=1e-6)


def test_a_program_whose_variables_change_nothing_has_a_law():
    lti = hys.Lti([[0.8]], [[0.5]], x=("h",), u=("flow",), y=("level",))
    mpc = hys.LinearMpc(lti, "track", 1, hys.LinearCost(du=0.0))
    law = hys.explicit(mpc, {"x": (-2, 2), "u": (-1, 1), "r": (-1, 1)})
    assert law.complete
    assert law([1.0, 0.5, 0.5]) == 0
