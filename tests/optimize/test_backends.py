"""The adapters: closed forms, agreement, updates of vectors, statuses."""

from __future__ import annotations

import numpy as np
import pytest

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.backends.registry import BACKENDS, get_backend
from hysdel_py.optimize.qp import Qp, QpSettings, QpStatus

every_backend = pytest.mark.parametrize("name", BACKENDS)


def projection(point, **changes):
    """The point of the triangle x, y >= 0, x + y <= 1 that is nearest to the given one."""
    data = {"A": [[1.0, 1.0]], "l": [-np.inf], "u": [1.0], "lb": [0.0, 0.0], "ub": [np.inf, np.inf]}
    return Qp(P=np.eye(2), q=-np.array(point, dtype=float), **(data | changes))


@every_backend
@pytest.mark.parametrize(
    ("point", "nearest", "y", "z"),
    [
        ((0.2, 0.3), (0.2, 0.3), 0.0, (0.0, 0.0)),
        ((1.0, 1.0), (0.5, 0.5), 0.5, (0.0, 0.0)),
        ((-1.0, 0.5), (0.0, 0.5), 0.0, (-1.0, 0.0)),
        ((3.0, 0.0), (1.0, 0.0), 2.0, (0.0, -2.0)),
    ],
)
def test_projection_on_a_triangle(name, point, nearest, y, z):
    result = get_backend(name).workspace(projection(point)).solve()
    assert result.status is QpStatus.OPTIMAL
    np.testing.assert_allclose(result.x, nearest, atol=1e-4)
    np.testing.assert_allclose(result.y, [y], atol=1e-4)
    np.testing.assert_allclose(result.z, z, atol=1e-4)
    assert result.primal_residual <= 1e-5
    assert result.dual_residual <= 1e-5


@every_backend
def test_vectors_are_updated_without_a_new_set_up(name):
    space = get_backend(name).workspace(projection((1.0, 1.0)))
    space.solve()
    assert space.solve(q=np.array([-0.1, -0.1])).x == pytest.approx([0.1, 0.1], abs=1e-4)
    assert space.solve(lb=np.array([0.3, 0.0])).x == pytest.approx([0.3, 0.1], abs=1e-4)
    assert space.solve(lb=np.array([0.3, 0.6]), ub=np.array([0.3, 9.0])).x == pytest.approx([0.3, 0.6], abs=1e-4)
    assert space.solve(u=np.array([2.0]), q=np.array([-9.0, -9.0])).x == pytest.approx([0.3, 1.7], abs=1e-4)


@every_backend
def test_an_inequality_may_become_an_equality_and_vanish(name):
    space = get_backend(name).workspace(projection((0.0, 0.0)))
    assert space.solve().x == pytest.approx([0.0, 0.0], abs=1e-4)
    assert space.solve(l=np.ones(1), u=np.ones(1)).x == pytest.approx([0.5, 0.5], abs=1e-4)
    free = np.full(1, np.inf)
    assert space.solve(l=-free, u=free, q=np.array([-4.0, -5.0])).x == pytest.approx([4.0, 5.0], abs=1e-4)


@every_backend
def test_infeasible_and_unbounded_are_statuses(name):
    infeasible = projection((1.0, 1.0), lb=[0.8, 0.8])
    assert get_backend(name).workspace(infeasible).solve().status is QpStatus.INFEASIBLE
    unbounded = Qp(np.zeros((1, 1)), [-1.0], np.zeros((0, 1)), [], [], [0.0], [np.inf])
    assert get_backend(name).workspace(unbounded).solve().status is QpStatus.UNBOUNDED


@every_backend
@pytest.mark.parametrize("changes", [{"l": [2.0]}, {"lb": [2.0, 0.0], "ub": [1.0, 1.0]}])
def test_crossed_sides_are_infeasible(name, changes):
    assert get_backend(name).workspace(projection((0.0, 0.0), **changes)).solve().status is QpStatus.INFEASIBLE


@every_backend
def test_too_few_iterations_are_a_status(name):
    settings = QpSettings(iterations=1, accuracy=1e-9)
    status = get_backend(name, settings).workspace(projection((3.0, 2.0))).solve().status
    assert status in (QpStatus.ITERATION_LIMIT, QpStatus.NUMERICAL)


@pytest.mark.parametrize("seed", range(30))
def test_back_ends_agree(seed):
    rng = np.random.default_rng(seed)
    n, m = rng.integers(1, 60), rng.integers(0, 40)
    L, A, x = rng.normal(size=(n, max(1, n // 2))), rng.normal(size=(m, n)), rng.normal(size=n)
    equal = (rng.random(m) < 0.3) & (np.arange(m) < n)
    l, u = A @ x - rng.exponential(1, m) * ~equal, A @ x + rng.exponential(1, m) * ~equal  # noqa: E741
    qp = Qp(L @ L.T, rng.normal(size=n), A, l, u, np.full(n, -30.0), np.full(n, 30.0))
    results = [get_backend(name).workspace(qp).solve() for name in BACKENDS]
    assert results[0].status is QpStatus.OPTIMAL
    if results[1].status is QpStatus.OPTIMAL:
        scale = 1 + abs(results[0].objective)
        assert results[0].objective == pytest.approx(results[1].objective, abs=1e-4 * scale)


@every_backend
def test_nothing_is_printed(name, capfd):
    get_backend(name).workspace(projection((1.0, 1.0), l=[-np.inf], u=[np.inf])).solve()
    assert capfd.readouterr() == ("", "")


def test_unknown_back_end_names_the_known_ones():
    with pytest.raises(ArgumentError, match="no QP back end 'gurobi': known are piqp, osqp"):
        get_backend("gurobi")


def test_missing_package_says_what_to_install(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "piqp", None)
    with pytest.raises(ArgumentError, match="pip install piqp"):
        get_backend("piqp")
