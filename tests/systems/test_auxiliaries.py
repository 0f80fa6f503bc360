"""Auxiliaries from the rows of the MLD form where the numbers are large."""

import numpy as np
import pytest

import hysdel_py as hys

CHAIN = """SYSTEM m { INTERFACE { STATE { REAL x [-1e7, 1e7]; } INPUT { BOOL v; } }
IMPLEMENTATION { AUX { REAL z; REAL w; } DA { z = {IF v THEN 3*x ELSE 0.25*x}; } LINEAR { w = 1.5*z; }
  CONTINUOUS { x = 0.1*w; } } }"""

# A sum of large numbers, an event on it and an update that is larger by another factor of a million.
SCALES = """SYSTEM m { INTERFACE { STATE { REAL a [-2e6, 3e6]; REAL b [0, 1e6]; } INPUT { BOOL v; } }
IMPLEMENTATION { AUX { REAL z; REAL w; BOOL d; } DA { z = {IF v THEN 3*b ELSE 0.25*a}; } LINEAR { w = 1.5*z; }
  AD { d = 3*w - 1 <= w + 3*z - 0.5; } CONTINUOUS { a = 6e6; b = 0.75e6*z - 0.5e6*(REAL d); } } }"""

WIDE = """SYSTEM m { INTERFACE { STATE { REAL a [-2e6, 3e6]; REAL b [0, 1e6]; } INPUT { REAL u [0, 2]; BOOL v; } }
IMPLEMENTATION { AUX { REAL z; REAL w; BOOL d; BOOL e; } AD { d = 3*w - 1 <= w + 3*z - 0.5; }
  CONTINUOUS { b = 0.75e6*z - 0.5e6*(REAL e); a = 6e6; } LINEAR { w = 1.5*z; }
  AD { e = 0.5*u - 1.5 - 0.5*z <= 1.5 - 1.5*b - 1.5*a; }
  DA { z = {IF (v & v) | (v <-> v) THEN 3*b ELSE 0.25*a + 0.5*u}; } MUST { a <= -750000; } } }"""

THRESHOLD = """SYSTEM m { INTERFACE { STATE { REAL x [-1e7, 1e7]; } }
IMPLEMENTATION { AUX { REAL z, w, q; BOOL d; } LINEAR { z = 3*x; w = 1.5*z; } AD { d = w >= 4.5; }
  DA { q = {IF d THEN w ELSE -1}; } CONTINUOUS { x = q; } } }"""

LOOP = """SYSTEM m { INTERFACE { STATE { REAL x [-1e9, 1e9]; } }
IMPLEMENTATION { AUX { REAL z, w; } LINEAR { z = 2*w + x; w = 3*z; } CONTINUOUS { x = 0.1*w; } } }"""


def random_point(model, random):
    def value(v):
        return float(random.integers(2)) if v.is_bool else random.uniform(v.low, v.high)

    return [value(v) for v in model.dha.x], [value(v) for v in model.dha.u]


@pytest.mark.parametrize("text", [CHAIN, SCALES, LOOP])
def test_large_numbers_step_alike_in_both_forms(text):
    model = hys.load(text)
    random = np.random.default_rng(0)
    for _ in range(200):
        x, u = random_point(model, random)
        for one, other in zip(model.dha.step(x, u), model.mld.step(x, u), strict=True):
            assert other == pytest.approx(one, rel=1e-9, abs=1e-6)


def test_a_point_of_the_chain_that_satisfies_every_row():
    assert hys.load(CHAIN).mld.step([-9945229.996597039], [1])[0] == pytest.approx([-9945229.996597039 * 0.45])


@pytest.mark.parametrize(("x", "d"), [(1.0, 1), (1 - 5e-7, 0), (1 - 2e-6, 0), (1 + 2e-6, 1)])
def test_a_threshold_beside_large_ranges_stays_resolved(x, d):
    model = hys.load(THRESHOLD)
    assert model.mld.step([x])[2] == model.dha.step([x])[2] == [d]


def test_the_epsilon_gap_beside_large_ranges_has_no_step():
    model = hys.load(THRESHOLD.replace("1e7", "1e5"))
    with pytest.raises(hys.SimulationError, match="the epsilon gap of d"):
        model.mld.step([1 - 1e-7])


def test_random_points_of_large_numbers_show_no_difference():
    model = hys.load(WIDE)
    model.mld.step([-1376963.1738638054, 230650.36817928564], [1.8803292456397218, 0])
    assert hys.verify(model, points=40).status.value == "equal"
