"""Closed loops as piecewise affine systems, value functions, affine Lyapunov functions and limit cycles."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.analysis.cells import Cell, cells_of, escape
from hysdel_py.analysis.quadratic_bound import Quadratic, is_nowhere_positive
from hysdel_py.analysis.value_decrease import DecreaseSettings, decrease_of
from hysdel_py.errors import ArgumentError

SCALAR = """SYSTEM s {{ INTERFACE {{ STATE {{ REAL p [-1, 1]; }} INPUT {{ REAL u [-0.5, 0.5]; }} OUTPUT {{ REAL y; }} }}
  IMPLEMENTATION {{ CONTINUOUS {{ p = {a}*p + u; }} OUTPUT {{ y = 2*p + u; }} }} }}"""
PLANE = """SYSTEM s {{ INTERFACE {{ STATE {{ REAL p [-1, 1]; REAL v [-1, 1]; }} }} IMPLEMENTATION {{
  AUX {{ BOOL s; REAL a; }} AD {{ s = p >= 0; }} DA {{ a = {{IF s THEN {a}*p ELSE {b}*p}}; }}
  CONTINUOUS {{ p = 0.3*p + {c}*v; v = a + 0.3*v; }} }} }}"""


def saturated(weight=1.0):
    """One step ahead for ``p+ = 1.2 p + u``: cost ``weight (p+)^2 + 0.1 u^2 + p^2``, inputs within a half."""
    problem = hys.MpQp(
        H=[[2 * (weight + 0.1)]], f=[0.0], F=[[2.4 * weight]], G=[[1.0], [-1.0]], w=[0.5, 0.5], S=[[0.0], [0.0]],
        theta=hys.Polyhedron.box([-1], [1]), Y=[[2 * (1.44 * weight + 1)]],
    )  # fmt: skip
    return hys.ExplicitLaw.of(hys.solve_mpqp(problem), moves=1, names=("p",))


@pytest.fixture(scope="module")
def law():
    return saturated()


def test_closed_loop_is_plant_and_law(law):
    model = hys.load(SCALAR.format(a=1.2))
    loop = hys.closed_loop_pwa(model, law)
    assert loop.u == ()
    for p in np.linspace(-1, 1, 41):
        after, y, _ = model.dha.step([p], law([p]))[:3]
        found, seen, _ = loop.step([p])
        assert found == pytest.approx(after)
        assert seen == pytest.approx(y)
    inside = hys.reach(loop, {"p": (-0.9, 0.9)}, steps=3)
    run = [0.9]
    for _ in range(3):
        run.append(1.2 * run[-1] + float(law([run[-1]])[0]))
    assert inside.sets[3].ranges()["p"][1] == pytest.approx(run[3], abs=1e-7)


def test_value_function_proves_stability(law):
    found = hys.lyapunov(hys.load(SCALAR.format(a=1.2)), "value", law=law)
    assert found.proves_stability, found.message
    for p in np.linspace(-1, 1, 101):
        assert found.value([p]) == pytest.approx(law.value([p]))
        assert p == 0 or found.value([1.2 * p + float(law([p])[0])]) < found.value([p])


def test_value_function_that_does_not_fall_has_a_witness(law):
    found = hys.lyapunov(hys.load(SCALAR.format(a=1.9)), "value", law=law)
    assert not found.found
    p = found.witness
    after = 1.9 * p + law(p)
    assert found.value(after) >= found.value(p) if abs(after[0]) <= 1 else found.escape is not None


def test_quadratic_bound_agrees_with_a_grid():
    draw = np.random.default_rng(3)
    square = hys.Polyhedron.box([-1, -1], [1, 1])
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 81)] * 2), -1).reshape(-1, 2)
    for _ in range(40):
        H = draw.normal(size=(2, 2))
        function = Quadratic(H + H.T, draw.normal(size=2), float(draw.normal()))
        top = float(function(grid).max())
        for shift, holds in ((top + 0.02, True), (top - 0.02, False)):
            moved = Quadratic(function.H, function.g, function.c - shift)
            found = is_nowhere_positive(moved, square, 0.0, 5000)
            assert found.holds is holds
            assert holds or moved(found.witness[None])[0] > 0


@pytest.mark.parametrize("seed", range(4))
def test_affine_function_falls_along_runs(seed):
    draw = np.random.default_rng(seed)
    a, b, c = draw.uniform(-0.4, 0.4, 3).round(2)
    model = hys.load(PLANE.format(a=a, b=b, c=c))
    found = hys.lyapunov(model, "affine", cuts=1)
    assert found.proves_stability
    for x in draw.uniform(-1, 1, (100, 2)):
        after = model.dha.step(x)[0]
        assert found.value(after) <= found.value(x) - 0.9 * np.abs(x).max() + 1e-9


def test_cuts_give_the_saturated_double_integrator_an_affine_function():
    model = hys.load("""SYSTEM s { INTERFACE { STATE { REAL p [-5, 5]; REAL v [-2, 2]; } } IMPLEMENTATION {
      AUX { BOOL hi, lo; REAL up, down; } AD { hi = 0.4*p + 1.2*v < -1; lo = 0.4*p + 1.2*v > 1; }
      DA { up = {IF hi THEN 1 + 0.4*p + 1.2*v ELSE 0}; down = {IF lo THEN 0.4*p + 1.2*v - 1 ELSE 0}; }
      CONTINUOUS { p = p + v; v = v - 0.4*p - 1.2*v + up + down; } } }""")
    assert not hys.lyapunov(model, "affine").found
    found = hys.lyapunov(model, "affine", cuts=1)
    assert found.found
    assert not found.is_kept  # from the corners runs leave the ranges
    kept = 0
    for x in np.random.default_rng(1).uniform([-5, -2], [5, 2], (60, 2)):
        after = model.dha.step(x)[0]
        if np.all(np.abs(after) <= [5, 2]):
            kept += 1
            assert found.value(after) < found.value(x)
    assert kept > 20


def test_affine_function_is_not_found_where_runs_grow():
    found = hys.lyapunov(hys.load(PLANE.format(a=2, b=-2, c=1)), "affine", cuts=1)
    assert not found.found
    assert not found.proves_stability
    assert found.escape is not None


@pytest.mark.parametrize("cuts", [0, 1, 2])
def test_cuts_lose_no_states(cuts):
    # Steps from two corners leave the square, and no step leads into these corners.
    model = hys.load(PLANE.format(a=0, b=0, c=0.9))
    found = hys.lyapunov(model, "affine", cuts=cuts)
    assert found.found
    assert not found.proves_stability
    assert np.abs(model.dha.step(found.escape)[0]).max() > 1
    assert found.value([0.99, 0.99]) > 0


def test_escape_is_found_where_a_step_flattens_the_cells():
    text = "SYSTEM s { INTERFACE { STATE { REAL p [-1, 1]; } } IMPLEMENTATION { CONTINUOUS { p = %s; } } }"
    assert escape(cells_of(hys.load(text % "0*p + 0.5").pwa)) is None
    assert escape(cells_of(hys.load(text % "0*p + 5").pwa)) is not None


RELAY = """SYSTEM s {{ INTERFACE {{ STATE {{ REAL v [-4, 4]; }} }} IMPLEMENTATION {{ AUX {{ BOOL up; REAL z; }}
  AD {{ up = v >= 0; }} DA {{ z = {{IF up THEN {low} ELSE {high}}}; }} CONTINUOUS {{ v = {a}*v + z; }} }} }}"""


@pytest.mark.parametrize(("a", "low", "high"), [(0.5, -1, 1), (0.8, -1, 0.5), (0.7, -0.3, 1.1), (-0.5, 0.4, 0.4)])
def test_cycles_are_those_that_runs_settle_in(a, low, high):
    model = hys.load(RELAY.format(a=a, low=low, high=high))
    found = hys.limit_cycles(model, 8)
    for cycle in found.cycles:
        run = model.simulate(cycle.states[0], 3 * cycle.period, check=False)
        assert np.allclose(run.x[cycle.period :: cycle.period], cycle.states[0], atol=1e-6)
    v = model.simulate([0.3], 400, check=False).x[-8:, 0]
    period = next((k for k in range(1, 8) if np.allclose(v[k:], v[:-k], atol=1e-9)), None)
    if period is not None:
        assert any(c.period == period and np.min(np.abs(c.states[:, 0] - v[-1])) < 1e-6 for c in found.cycles)
    assert found.is_complete


def test_no_cycle_is_a_complete_answer(law):
    found = hys.limit_cycles(hys.load(SCALAR.format(a=1.2)), 5, law=law)
    assert found.is_complete
    assert not found.oscillations
    assert [c.states[0, 0] for c in found.equilibria if abs(c.states[0, 0]) < 1e-9]


def test_a_line_of_equilibria_is_not_complete():
    text = "SYSTEM s { INTERFACE { STATE { REAL p [-1, 1]; } } IMPLEMENTATION { CONTINUOUS { p = p; } } }"
    assert not hys.limit_cycles(hys.load(text), 1).is_complete


def test_wrong_arguments(law):
    model = hys.load(SCALAR.format(a=1.2))
    with pytest.raises(ArgumentError, match="value function"):
        hys.lyapunov(model, "value", law=law.without_value())
    with pytest.raises(ArgumentError, match="cuts"):
        hys.lyapunov(model, "affine", law=law, cuts=-1)
    with pytest.raises(ArgumentError, match="1 finite numbers"):
        hys.lyapunov(model, "affine", law=law, equilibrium="a")
    with pytest.raises(ArgumentError, match="in no cell"):
        hys.lyapunov(model, "affine", law=law, equilibrium=[7])
    with pytest.raises(ArgumentError, match="longest is 0: a whole number of at least 1"):
        hys.limit_cycles(model, 0, law=law)
    with pytest.raises(ArgumentError, match="a int was given"):
        hys.lyapunov(model, "affine", law=3)
    with pytest.raises(ArgumentError, match="give a law"):
        hys.limit_cycles(model, 2)


def test_a_fixed_point_on_the_wrong_side_of_a_threshold_is_none():
    # Below 0 the map has its fixed point at 0, which belongs to the other side.
    found = hys.limit_cycles(hys.load(RELAY.format(a=0.5, low=-1, high=0)), 3)
    assert not any(abs(cycle.states[0, 0]) < 1e-9 for cycle in found.equilibria)
    assert not found.is_complete  # on a threshold rounding decides


def test_whole_numbers_of_numpy_are_taken(law):
    model = hys.load(SCALAR.format(a=1.2))
    assert hys.limit_cycles(model, np.int64(1), law=law).cycles
    assert hys.lyapunov(model, "affine", law=law, cuts=np.int64(0)).found


def test_modes_without_inner_points_take_part_in_cycles():
    equal = """SYSTEM s { INTERFACE { STATE { REAL p [-1, 1]; REAL q [-1, 1]; } }
      IMPLEMENTATION { CONTINUOUS { p = -0.5*p; q = -0.5*q; } MUST { p == q; } } }"""
    assert [cycle.states.tolist() for cycle in hys.limit_cycles(hys.load(equal), 2).cycles] == [[[0, 0]]]
    both = """SYSTEM s { INTERFACE { STATE { REAL p [-1, 1]; } } IMPLEMENTATION { AUX { BOOL a, b; REAL z; }
      AD { a = p >= 0; b = p <= 0; } DA { z = {IF a & b THEN 0 ELSE 0.9}; } CONTINUOUS { p = z - 0.5*p; } } }"""
    assert sorted(cycle.states[0, 0] for cycle in hys.limit_cycles(hys.load(both), 1).cycles) == pytest.approx([0, 0.6])


@pytest.mark.parametrize(
    ("threshold", "there", "words"),
    [(0, 0.9, "no equilibrium"), (0.5, 0.25, "inner points"), (0.5, 0, None), (0, 0, None)],
)
def test_a_mode_of_single_states_is_not_passed_over(threshold, there, words):
    # With 0.25 a run from 1 comes to rest at the threshold 0.5.
    model = hys.load(f"""SYSTEM s {{ INTERFACE {{ STATE {{ REAL p [-1, 1]; }} }} IMPLEMENTATION {{ AUX {{ BOOL a, b;
      REAL z; }} AD {{ a = p >= {threshold}; b = p <= {threshold}; }} DA {{ z = {{IF a & b THEN {there} ELSE 0}}; }}
      CONTINUOUS {{ p = 0.5*p + z; }} }} }}""")
    if words is None:
        assert hys.lyapunov(model, "affine").proves_stability
    else:
        with pytest.raises(ArgumentError, match=words):
            hys.lyapunov(model, "affine")


def test_closed_loop_keeps_modes_without_inner_points(law):
    text = SCALAR.format(a=1.2).replace("OUTPUT { y", "MUST { u == -p; } OUTPUT { y").replace("[-0.5, 0.5]", "[-1, 1]")
    twin = hys.ExplicitLaw.of(
        hys.solve_mpqp(
            hys.MpQp(H=[[2.0]], f=[0.0], F=[[2.0]], G=[[1.0], [-1.0]], w=[2.0, 2.0], S=[[0.0], [0.0]],
                     theta=hys.Polyhedron.box([-1], [1]), Y=[[2.0]])
        ), moves=1, names=("p",),
    )  # fmt: skip
    loop = hys.closed_loop_pwa(hys.load(text), twin)
    assert loop.step([0.5])[0] == pytest.approx([0.1])


def test_unbounded_cells_prove_nothing():
    quadrant = hys.Polyhedron(-np.eye(2), np.zeros(2))
    cell = Cell(quadrant, 3 * np.eye(2), np.zeros(2), 0)
    found = decrease_of([cell], np.diag([1.0, 1.0, 0.0])[None], DecreaseSettings())
    assert not found.holds
    assert "not bounded" in found.message
