"""Generated Booleans of equal definition become one, and nothing else changes."""

import numpy as np
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from lowering.test_dha_equals_mld import random_point
from strategies import models

import hysdel_py as hys
from hysdel_py.lowering.sharing import share

TEXT = """SYSTEM s { INTERFACE { STATE { REAL x [-2, 3]; BOOL b, c; } }
  IMPLEMENTATION { AUX { BOOL d, e; REAL z, w, v; }
    AD { d = x <= 1; }
    LOGIC { e = b & ~c; }
    DA { z = {IF b & c THEN x ELSE 0};
         w = {IF b & c THEN 1 ELSE x};
         v = {IF b & ~c THEN x ELSE (REAL (x <= 1) | c)}; }
    CONTINUOUS { x = z + w + v + (REAL (b & c)); } AUTOMATA { b = (x <= 1) & c; c = (x <= 2) | d & e; } } }"""


def test_equal_definitions_become_one():
    dha = hys.load(TEXT).dha
    found = share(dha)
    kept = {v.name for v in found.dha.d}
    assert len(dha.d) - len(found.dha.d) == len(found.merged) >= 4
    assert not set(found.merged) & kept
    assert set(found.merged.values()) <= kept


def test_a_generated_one_gives_way_to_a_declared_one():
    merged = set(share(hys.load(TEXT).dha).merged.values())
    assert {"d", "e"} <= merged


def test_merging_may_make_others_equal():
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-2, 3]; BOOL b; } }
      IMPLEMENTATION { AUX { REAL z, w; }
        DA { z = {IF (x <= 1) & b THEN x ELSE 0}; w = {IF (x <= 1) & b THEN 2*x ELSE 1}; }
        CONTINUOUS { x = z + w; } AUTOMATA { b = b; } } }"""
    dha = hys.load(text).dha
    assert (len(dha.d), len(share(dha).dha.d)) == (4, 2)


def test_epsilon_tells_thresholds_apart():
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-2, 3]; } }
      IMPLEMENTATION { AUX { BOOL d; REAL z; } AD { d = x <= 0 [-2, 3, 1e-3]; }
        DA { z = {IF (x <= 0) THEN x ELSE 1}; } CONTINUOUS { x = z + (REAL d); } } }"""
    assert not share(hys.load(text).dha).merged


def test_option_and_step():
    model = hys.load(TEXT)
    small = hys.to_mld(model, share=True)
    assert small.nd < model.mld.nd
    assert small.ne < model.mld.ne
    for x in ([0.5, 1, 0], [1.5, 1, 1], [-2, 0, 1]):
        np.testing.assert_allclose(small.step(x)[0], model.dha.step(x)[0], atol=1e-9)


@settings(
    max_examples=12, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True, phases=[Phase.generate]
)
@given(models(), st.integers(0, 2**32 - 1))
def test_steps_are_the_same(text, seed):
    dha = hys.load(text).dha
    small = share(dha).dha
    generator = np.random.default_rng(seed)
    for _ in range(5):
        x, u = random_point(dha.x, generator), random_point(dha.u, generator)
        before, after = dha.step(x, u, check=False), small.step(x, u, check=False)
        np.testing.assert_allclose(after[0], before[0], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(after[1], before[1], rtol=1e-12, atol=1e-12)
