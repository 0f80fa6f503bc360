"""No word of a solver is taken on trust."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hysdel_py.optimize.backends.answer import failed_result
from hysdel_py.optimize.backends.registry import get_backend
from hysdel_py.optimize.phase_one import elastic_phase_one, recession_direction
from hysdel_py.optimize.qp import Qp, QpSettings, QpStatus
from hysdel_py.optimize.verified import VerifiedSolver, solve_qp


class Liar:
    """A work space that gives the same answer to everything."""

    def __init__(self, status, x=(0.0, 0.0), y=(0.0,)):
        self.answer = status, np.array(x), np.array(y)

    def solve(self, **vectors):
        status, x, y = self.answer
        blank = failed_result(Qp(np.zeros((2, 2)), [0, 0], [[1, 1]], [0], [0], [0, 0], [0, 0]), status, "a lie")
        return replace(blank, x=x, y=y)


def problem(**changes):
    data = {"P": np.eye(2), "q": [-1.0, -1.0], "A": [[1.0, 1.0]], "l": [-np.inf], "u": [1.0], "lb": [0.0, 0.0],
            "ub": [5.0, 5.0]}  # fmt: skip
    return Qp(**(data | changes))


def solver_with(qp, **spaces):
    """A solver whose named back ends are replaced, whatever problem they are opened for."""

    def open_space(name, problem):
        return spaces[name] if name in spaces else get_backend(name).workspace(problem)

    return VerifiedSolver(qp, "piqp", QpSettings(), open_space=open_space)


@pytest.mark.parametrize("claim", [QpStatus.INFEASIBLE, QpStatus.UNBOUNDED, QpStatus.NUMERICAL])
def test_a_false_claim_goes_to_the_other_solver(claim):
    qp = problem()
    verdict = solver_with(qp, piqp=Liar(claim, y=(3.0,))).solve(qp)
    assert verdict.optimal
    assert verdict.answer.objective == pytest.approx(-0.75, abs=1e-4)
    assert verdict.bound <= -0.75 + 1e-9


def test_two_false_claims_of_infeasibility_are_not_believed():
    qp = problem()
    liar = Liar(QpStatus.INFEASIBLE, y=(3.0,))
    verdict = solver_with(qp, piqp=liar, osqp=liar).solve(qp)
    assert verdict.answer.status is QpStatus.NUMERICAL
    assert -np.inf < verdict.bound <= -0.75


def test_infeasibility_is_proven_by_the_linear_program_when_nobody_says_so():
    qp = problem(lb=[0.6, 0.6])
    liar = Liar(QpStatus.ITERATION_LIMIT)
    verdict = solver_with(qp, piqp=liar, osqp=liar).solve(qp)
    assert verdict.infeasible
    assert verdict.bound == np.inf
    assert "HiGHS" in verdict.answer.message


@pytest.mark.parametrize("backend", ["piqp", "osqp"])
def test_statuses_of_single_problems(backend):
    assert solve_qp(problem(), backend).status is QpStatus.OPTIMAL
    assert solve_qp(problem(lb=[0.6, 0.6]), backend).status is QpStatus.INFEASIBLE
    unbounded = problem(P=np.zeros((2, 2)), A=[[1.0, -1.0]], ub=[np.inf, np.inf])
    assert solve_qp(unbounded, backend).status is QpStatus.UNBOUNDED


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6])
def test_small_gaps_are_proven_infeasible(gap):
    qp = problem(A=[[1.0, 1.0], [1.0, 1.0]], l=[1 + gap, -np.inf], u=[np.inf, 1.0])
    assert solve_qp(qp).status is QpStatus.INFEASIBLE


def test_phase_one_of_a_feasible_problem_has_no_violation():
    assert elastic_phase_one(problem()).violation == pytest.approx(0.0, abs=1e-12)
    assert elastic_phase_one(problem(lb=[2.0, 2.0])).violation == pytest.approx(3.0)
    assert elastic_phase_one(problem(lb=[9.0, 9.0])) is None


def test_direction_of_descent():
    assert recession_direction(problem()) is None
    ray = recession_direction(problem(P=np.zeros((2, 2)), A=[[1.0, -1.0]], ub=[np.inf, np.inf]))
    assert ray[0] <= ray[1] + 1e-9
    assert ray @ [-1.0, -1.0] < 0
