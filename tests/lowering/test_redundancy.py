"""Rows that the others imply, and only those, can go."""

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from lowering.relaxations import greatest, rows_of
from strategies import models

import hysdel_py as hys
from hysdel_py.lowering.redundancy import remove_redundant_rows


def load(implementation):
    head = "SYSTEM s { INTERFACE { STATE { REAL x [-2, 3]; BOOL b, c; } }"
    return hys.load(f"{head} IMPLEMENTATION {{ {implementation} }} }}")


@pytest.mark.parametrize(
    ("implementation", "removed"),
    [
        ("MUST { x <= 3; x <= 2; x <= 1; }", [0, 1]),
        ("MUST { b | c; b | c; }", [1]),
        ("MUST { b; b | c; }", [1]),
        ("AUX { BOOL d; } AD { d = x <= 1; }", []),
        ("AUX { BOOL d, e; } LOGIC { d = b & c; e = b & c; }", []),
        ("AUX { REAL z; } LINEAR { z = x; } MUST { z <= 4; z <= 2; }", [2]),
        ("MUST { FALSE; x <= 1; }", []),
    ],
)
def test_what_is_removed(implementation, removed):
    found = remove_redundant_rows(load(implementation).mld)
    assert [row.index for row in found.removed] == removed


def test_the_kept_rows_keep_their_origin():
    mld = load("MUST { x <= 3; x <= 1; }").mld
    found = remove_redundant_rows(mld)
    assert found.mld.rows == mld.rows[1:]
    assert [row.origin for row in found.removed] == [mld.rows[0]]
    assert found.mld.E4.toarray().tolist() == mld.E4.toarray()[1:].tolist()
    assert hys.to_mld(load("MUST { x <= 3; x <= 1; }"), compact=True).ne == 1


@settings(
    max_examples=8, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True, phases=[Phase.generate]
)
@given(models())
def test_the_relaxation_stays_the_same(text):
    mld = hys.load(text).mld
    found = remove_redundant_rows(mld)
    A, b = rows_of(mld)
    for row in found.removed:
        excess = greatest(found.mld, A[[row.index]].toarray()[0], b[row.index], integer=False)
        assert excess < 1e-6 * max(1.0, abs(b[row.index]))


def test_steps_are_the_same():
    model = hys.load("three_tanks")
    small = hys.to_mld(model, compact=True)
    generator = np.random.default_rng(3)
    for _ in range(30):
        x, u = generator.uniform(0, 5, 3), [*generator.uniform(0, 0.1, 2), *generator.integers(0, 2, 2)]
        for ours, theirs in zip(small.step(x, u), model.dha.step(x, u), strict=True):
            np.testing.assert_allclose(ours, theirs, atol=1e-9)
