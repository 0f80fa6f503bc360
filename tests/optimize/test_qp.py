"""The canonical program: what is checked, and how residuals are measured."""

from __future__ import annotations

import numpy as np
import pytest

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.qp import Qp, QpSettings, is_convex, objective_value, residuals, violation


def simple(**changes):
    data = {"P": np.eye(2), "q": [-1.0, 0.0], "A": [[1.0, 1.0]], "l": [-np.inf], "u": [1.0], "lb": [-1.0, -1.0],
            "ub": [2.0, 2.0], "constant": 0.5}  # fmt: skip
    return Qp(**(data | changes))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"q": [1.0, np.nan]}, r"q\[1\] is not a number"),
        ({"q": [1.0, np.inf]}, "q has an infinite entry"),
        ({"q": [[1.0, 2.0]]}, "q has shape"),
        ({"P": np.eye(3)}, r"P has shape \(3, 3\): \(2, 2\) was expected"),
        ({"P": [[1.0, 1.0], [0.0, 1.0]]}, "P is not symmetric"),
        ({"A": [[1.0, 1.0, 1.0]]}, "A has 3 columns: 2 were expected"),
        ({"A": [[1.0, np.inf]]}, "A has an entry that is not finite"),
        ({"l": [0.0, 0.0]}, r"l has shape \(2,\): shape \(1,\) was expected"),
        ({"u": [np.nan]}, r"u\[0\] is not a number"),
        ({"ub": [1.0]}, r"ub has shape \(1,\)"),
        ({"constant": np.inf}, "constant is inf"),
    ],
)
def test_wrong_data_is_named(changes, message):
    with pytest.raises(ArgumentError, match=message):
        simple(**changes)


def test_crossed_sides_are_a_problem_and_not_an_error():
    assert simple(l=[3.0]).l[0] == 3.0


def test_vectors_are_replaced_and_matrices_shared():
    qp = simple()
    other = qp.with_vectors(u=[5.0], constant=2.0)
    assert other.P is qp.P
    assert (other.u[0], other.constant, qp.u[0]) == (5.0, 2.0, 1.0)
    with pytest.raises(ArgumentError, match="lb has shape"):
        qp.with_vectors(lb=[0.0])


def test_objective_and_residuals_of_a_known_solution():
    qp = simple()
    x = np.array([1.0, 0.0])
    assert objective_value(qp, x) == 0.0
    at = residuals(qp, x, np.zeros(1), np.zeros(2))
    assert (at.primal, at.dual) == (0.0, 0.0)
    off = residuals(qp, np.array([3.0, 0.0]), np.array([0.5]), np.zeros(2))
    assert (off.primal, off.dual) == (2.0, 2.5)


def test_violation_is_relative_to_the_side():
    assert violation(simple(u=[9.0], ub=[99.0, 99.0]), np.array([10.0, 0.0])) == pytest.approx(0.1)


def test_convexity_is_checked_when_asked():
    assert is_convex(simple())
    assert is_convex(simple(P=[[1.0, 1.0], [1.0, 1.0]]))
    assert not is_convex(simple(P=[[1.0, 2.0], [2.0, 1.0]]))


def test_settings_are_checked():
    with pytest.raises(ArgumentError, match="accuracy is 0"):
        QpSettings(accuracy=0.0)
