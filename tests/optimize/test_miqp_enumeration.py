"""Branch and bound against the enumeration of all binaries and faces."""

from __future__ import annotations

import numpy as np
import pytest

from hysdel_py.optimize.miqp import MiqpSettings, MiqpStatus, solve_miqp
from hysdel_py.optimize.qp import violation


def check(miqp, expected, backend):
    result = solve_miqp(miqp, MiqpSettings(backend=backend))
    if expected == np.inf:
        assert result.status is MiqpStatus.INFEASIBLE
        assert result.x is None
        return "infeasible"
    tolerance = 1e-5 * (1 + abs(expected))
    assert result.status is MiqpStatus.OPTIMAL, result.message
    assert result.bound <= expected + 1e-8 * (1 + abs(expected))
    assert abs(result.objective - expected) <= tolerance
    assert violation(miqp.qp, result.x) <= 1e-7
    assert set(result.x[miqp.binaries]) <= {0.0, 1.0}
    return "feasible"


@pytest.mark.parametrize("backend", ["dense", "piqp", "osqp"])
@pytest.mark.parametrize("block", range(10))
def test_optimum_of_random_problems_is_that_of_the_enumeration(small_problem, oracle, backend, block):
    kinds = []
    for seed in range(24 * block, 24 * block + 24):
        miqp = small_problem(seed)
        kinds.append(check(miqp, oracle(seed), backend))
    assert kinds.count("feasible") >= 5
    assert kinds.count("infeasible") >= 1
