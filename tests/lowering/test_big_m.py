"""Ranges contain every value, are attained at corners, and follow definitions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hysdel_py as hys
from hysdel_py.systems.affine import Affine

NUMBER = st.floats(-100, 100, allow_nan=False).map(lambda v: round(v, 3) + 0.0)


@st.composite
def forms(draw):
    """An affine form with a range for each of its variables."""
    names = draw(st.lists(st.sampled_from("abcde"), min_size=0, max_size=5, unique=True))
    ends = {name: sorted((draw(NUMBER), draw(NUMBER))) for name in names}
    return Affine(draw(NUMBER), tuple((name, draw(NUMBER)) for name in names)), ends


@settings(max_examples=200, deadline=None, derandomize=True)
@given(forms(), st.integers(0, 2**32 - 1))
def test_range_contains_samples_and_is_attained(drawn, seed):
    form, ends = drawn
    low, high = form.range(ends.__getitem__)
    generator = np.random.default_rng(seed)
    for _ in range(20):
        value = form.value({name: generator.uniform(*pair) for name, pair in ends.items()})
        assert low - 1e-9 <= value <= high + 1e-9
    coefficients = dict(form.terms)
    corners = [{n: ends[n][(coefficients[n] > 0) == top] for n in ends} for top in (False, True)]
    assert sorted(form.value(corner) for corner in corners) == pytest.approx([low, high])


def test_range_of_an_auxiliary_is_the_hull_of_its_branches_and_holds_in_simulation():
    model = hys.load(
        """SYSTEM r { INTERFACE { STATE { REAL x [-2, 3]; BOOL b; } }
          IMPLEMENTATION { AUX { REAL v, w; }
            LINEAR { v = 2*x - 1 + 3*(REAL b); }
            DA { w = {IF b THEN v ELSE -x/2}; }
            CONTINUOUS { x = w; } AUTOMATA { b = ~b; } } }"""
    )
    mld = hys.to_mld(model, big_m="interval")
    ranges = {v.name: (v.low, v.high) for v in mld.z}
    assert ranges == {"v": (-5, 8), "w": (-5, 8)}
    generator = np.random.default_rng(0)
    for _ in range(200):
        z = model.dha.step([generator.uniform(-2, 3), generator.integers(2)])[3]
        assert all(v.low <= value <= v.high for v, value in zip(mld.z, z, strict=True))


def test_declared_range_of_an_auxiliary_wins():
    model = hys.load(
        """SYSTEM r { INTERFACE { STATE { REAL x [0, 1]; } }
          IMPLEMENTATION { AUX { REAL z [-5, 5]; BOOL d; } LINEAR { z = x; } AD { d = z <= 0; }
            CONTINUOUS { x = (REAL d); } } }"""
    )
    mld = hys.to_mld(model, big_m="interval")
    assert (mld.z[0].low, mld.z[0].high) == (-5, 5)
    assert mld.E2.toarray()[2:, 0] == pytest.approx([-5 - 1e-6, 5])


def test_state_without_range_takes_that_of_its_update():
    model = hys.load(
        """SYSTEM r { INTERFACE { STATE { REAL x, w [0, 2]; } }
          IMPLEMENTATION { AUX { BOOL d; } AD { d = x <= 1; } CONTINUOUS { x = 3*w + (REAL d); w = w; } } }"""
    )
    assert (model.mld.x[0].low, model.mld.x[0].high) == (0, 7)


def test_a_range_that_nobody_needs_may_be_unknown():
    model = hys.load(
        """SYSTEM r { INTERFACE { STATE { REAL x; } INPUT { REAL u; } }
          IMPLEMENTATION { CONTINUOUS { x = x + u; } } }"""
    )
    assert model.mld.x[0].low == -np.inf
    assert model.mld.step([1e6], [1])[0] == [1e6 + 1]


def test_term_with_coefficient_zero_needs_no_range():
    model = hys.load(
        """SYSTEM r { INTERFACE { STATE { REAL x [0, 1]; } INPUT { REAL u; } }
          IMPLEMENTATION { AUX { BOOL d; } AD { d = x + 0*u <= 0.5; } CONTINUOUS { x = (REAL d); } } }"""
    )
    assert model.mld.ne == 2
