"""Lyapunov functions: along random runs, against a closed form, and where there is none."""

import numpy as np
import pytest
from scipy.linalg import expm

import hysdel_py as hys
from hysdel_py.errors import ArgumentError

LINEAR = """SYSTEM s {{ INTERFACE {{ STATE {{ REAL p [-1, 1]; REAL v [-1, 1]; }} }}
IMPLEMENTATION {{ CONTINUOUS {{ p = {a}*p + {b}*v; v = {c}*p + {d}*v; }} }} }}"""

FLOWER = """SYSTEM flower {{
INTERFACE {{ STATE {{ REAL p [-1, 1]; REAL v [-1, 1]; }} }}
IMPLEMENTATION {{
  AUX {{ BOOL a, b; REAL z1, z2; }}
  AD {{ a = p + v >= 0; b = p - v >= 0; }}
  DA {{ z1 = {{IF (a & b) | (~a & ~b) THEN {0} ELSE {1}}}; z2 = {{IF (a & b) | (~a & ~b) THEN {2} ELSE {3}}}; }}
  CONTINUOUS {{ p = z1; v = z2; }}
}} }}"""


def flower(h=0.1, damping=0.1):
    """Two spirals that change over at the diagonals, sampled: stable, but not with one quadratic function."""
    maps = [expm(h * np.array([[-damping, a], [-b, -damping]])) for a, b in ((5, 1), (1, 5))]
    rows = [f"{A[i, 0]:.17g}*p + {A[i, 1]:.17g}*v" for i in range(2) for A in maps]
    return hys.load(FLOWER.format(*rows))


@pytest.fixture
def _solver():
    pytest.importorskip("clarabel", reason="linear matrix inequalities need clarabel")


@pytest.mark.usefixtures("_solver")
def test_linear_system_has_a_quadratic_function():
    model = hys.load(LINEAR.format(a=0.7, b=0.3, c=-0.3, d=0.7))
    found = hys.lyapunov(model, "quadratic")
    assert found.found
    assert found.proves_stability
    A = np.array([[0.7, 0.3], [-0.3, 0.7]])
    P = found.P[0][:2, :2]
    assert np.linalg.eigvalsh(P - A.T @ P @ A)[0] > 0.5


@pytest.mark.usefixtures("_solver")
def test_unstable_system_has_none():
    found = hys.lyapunov(hys.load(LINEAR.format(a=1.01, b=0, c=0, d=0.5)), "quadratic")
    assert not found.found
    with pytest.raises(ArgumentError, match="no function"):
        found.value([0, 0])


@pytest.mark.usefixtures("_solver")
def test_one_function_is_not_enough_four_are():
    model = flower()
    assert not hys.lyapunov(model, "quadratic").found
    found = hys.lyapunov(model)
    assert found.found
    rng = np.random.default_rng(0)
    for x in rng.uniform(-0.4, 0.4, (300, 2)):
        after = model.dha.step(x)[0]
        assert found.value(after) <= found.value(x) - 0.9 * float(x @ x)
        assert found.value(x) >= 0.9 * float(x @ x)


@pytest.mark.usefixtures("_solver")
def test_decrease_is_no_proof_where_runs_leave():
    found = hys.lyapunov(flower())
    assert not found.is_kept
    assert not found.proves_stability


@pytest.mark.usefixtures("_solver")
def test_closed_loop_with_an_explicit_law():
    model = hys.load(
        "SYSTEM s { INTERFACE { STATE { REAL p [-1, 1]; } INPUT { REAL u [-0.5, 0.5]; } }"
        " IMPLEMENTATION { CONTINUOUS { p = 1.2*p + u; } } }"
    )
    problem = hys.MpQp(
        H=[[2.2]], f=[0.0], F=[[2.4]], G=[[1.0], [-1.0]], w=[0.5, 0.5], S=[[0.0], [0.0]],
        theta=hys.Polyhedron.box([-1], [1]),
    )  # fmt: skip
    law = hys.ExplicitLaw.of(hys.solve_mpqp(problem), moves=1, names=("p",))
    found = hys.lyapunov(model, law=law)
    assert len(found.cells) == 3
    assert found.proves_stability
    for x in np.linspace(-1, 1, 101):
        after = 1.2 * x + float(law([x])[0])
        assert x == 0 or found.value([after]) < found.value([x])


@pytest.mark.usefixtures("_solver")
def test_equilibrium_elsewhere():
    model = hys.load(
        "SYSTEM s { INTERFACE { STATE { REAL p [-4, 4]; } } IMPLEMENTATION { CONTINUOUS { p = 0.5*p + 1; } } }"
    )
    found = hys.lyapunov(model, equilibrium=[2.0])
    assert found.proves_stability
    assert found.value([2.0]) == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(ArgumentError, match="no equilibrium"):
        hys.lyapunov(model)


def test_what_is_missing_is_told(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "clarabel", None)
    with pytest.raises(ArgumentError, match="stability"):
        hys.lyapunov(hys.load(LINEAR.format(a=0.5, b=0, c=0, d=0.5)))


@pytest.mark.parametrize(
    ("name", "more", "words"),
    [
        ("two_tanks", {}, "Boolean"),
        (LINEAR.format(a=0.5, b=0, c=0, d=0.5), {"kind": "cubic"}, "quadratic"),
        (LINEAR.format(a=0.5, b=0, c=0, d=0.5), {"equilibrium": [1]}, "2 finite numbers"),
    ],
)
def test_wrong_arguments(name, more, words):
    with pytest.raises(ArgumentError, match=words):
        hys.lyapunov(hys.load(name), **more)
