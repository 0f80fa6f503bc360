"""The modes of a model: on random models and points all three forms agree, and both ways to the modes do."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from strategies import models

import hysdel_py as hys

DATA = Path(__file__).parents[1] / "data" / "modes"
AGREEMENT = 1e-9
POINTS_PER_MODEL = 15


def random_point(variables, generator):
    """Values within the declared ranges, on a coarse grid half of the time so that thresholds are hit exactly."""
    exact = generator.integers(2)
    values = []
    for v in variables:
        if v.is_bool:
            values.append(float(generator.integers(2)))
        else:
            value = generator.uniform(v.low, v.high)
            values.append(float(np.clip(np.round(value * 2) / 2, v.low, v.high) if exact else value))
    return np.array(values)


def stepped(form, x, u):
    try:
        return form.step(x, u)
    except hys.SimulationError:
        return None


def compare(model, pwa, x, u):
    """Step in all forms; whether there is a step."""
    found, expected = stepped(pwa, x, u), stepped(model.mld, x, u)
    assert (found is None) == (expected is None), (x, u, found, expected)
    if found is None or expected is None:
        return False
    d, z = pwa.auxiliaries(x, u)
    dha = model.dha.step(x, u)
    for ours, mld, meant in zip((*found[:2], d, z), expected, dha, strict=True):
        np.testing.assert_allclose(ours, mld, atol=AGREEMENT, rtol=AGREEMENT)
        np.testing.assert_allclose(ours, meant, atol=AGREEMENT, rtol=AGREEMENT)
    return True


def holding(pwa, x, u, margin):
    """Modes whose region holds a point with room to spare."""
    w = np.concatenate([x, u])
    reals = [i for i, v in enumerate((*pwa.x, *pwa.u)) if not v.is_bool]
    rows = [np.any(mode.region.A[:, reals] != 0, axis=1) for mode in pwa.modes]
    return [m.index for m, r in zip(pwa.modes, rows, strict=True) if np.all(m.region.slack(w) >= margin * r)]


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models(), st.integers(0, 2**32 - 1), st.booleans())
def test_three_forms_agree_on_random_models(text, seed, split):
    model = hys.load(text)
    pwa = hys.to_pwa(model, split_booleans=split)
    generator = np.random.default_rng(seed)
    for _ in range(POINTS_PER_MODEL):
        x, u = random_point(pwa.x, generator), random_point(pwa.u, generator)
        compare(model, pwa, x, u)
        assert len(holding(pwa, x, u, 1e-8)) <= 1


def by_word(pwa):
    """Modes by the Booleans of their word that are in the source or generated."""
    return {tuple(sorted(mode.word)): mode for mode in pwa.modes}


@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models())
def test_both_ways_find_the_same_modes(text):
    model = hys.load(text)
    explored, searched = (by_word(hys.to_pwa(form, split_booleans=True)) for form in (model.dha, model.mld))
    assert set(explored) == set(searched)
    for word, mode in explored.items():
        other = searched[word]
        assert mode.is_flat == other.is_flat
        for inner, outer in ((mode, other), (other, mode)):
            for a, b in zip(outer.region.A, outer.region.b, strict=True):
                assert inner.region.maximise(a).value <= b + 1e-7 * np.linalg.norm(a)


def test_clutch_has_eight_modes_with_four_dynamics():
    pwa = hys.load("clutch").pwa
    assert len(pwa.modes) == 8
    assert not any(mode.is_flat for mode in pwa.modes)
    assert len(pwa.dynamics) == 4
    assert pwa.modes[1].conditions == (
        "gamma <= reltol (line 52)",
        "(Te*Jv + b*(we - gamma)*Je)/(Je + Jv) <= mu*Fn (line 53)",
        "gamma > 0 (line 54)",
    )


@pytest.mark.parametrize(("name", "modes"), [("bist_release", 7), ("bist_engage", 18)])
def test_gear_shift_has_the_modes_of_the_document(name, modes):
    model = hys.load(DATA / f"{name}.hys")
    for pwa in (model.pwa, hys.to_pwa(model.mld)):
        assert len(pwa.modes) == modes
        assert len(pwa.dynamics) == 2
        assert not any(mode.is_flat for mode in pwa.modes)
    assert set(by_word(model.pwa)) == set(by_word(hys.to_pwa(model.mld)))


def test_flat_modes_are_kept_and_marked():
    """x = -2 is the only point where the threshold holds, and the MLD form has a step there."""
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-2, 3]; } }
      IMPLEMENTATION { AUX { BOOL low; } AD { low = x <= -2; } CONTINUOUS { x = (REAL low); } } }"""
    model = hys.load(text)
    assert [(mode.bits, mode.is_flat) for mode in model.pwa.modes] == [("1", True), ("0", False)]
    assert model.pwa.step([-2.0])[2] == 0
    assert compare(model, model.pwa, np.array([-2.0]), np.zeros(0))
    assert not compare(model, model.pwa, np.array([-2.0 + 5e-7]), np.zeros(0))


def test_booleans_that_only_pass_through_stay_free():
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-2, 3]; BOOL b, c; } INPUT { BOOL v; } }
      IMPLEMENTATION { AUX { REAL z; } LINEAR { z = x + 2*(REAL b); } CONTINUOUS { x = z; }
      AUTOMATA { b = ~v; c = c & b; } } }"""
    pwa = hys.load(text).pwa
    assert [name for name, _ in pwa.modes[0].word] == ["b", "c", "v", "__additional_1"]
    assert [mode.bits for mode in pwa.modes] == ["11*1", "10*0", "01*0", "00*0"]
    assert len(hys.to_pwa(hys.load(text), split_booleans=True).modes) == 8
    np.testing.assert_allclose(pwa.step([0.5, 1, 1], [0])[0], [2.5, 1, 1])


def test_a_boolean_behind_a_threshold_is_split():
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-2, 3]; BOOL b; } }
      IMPLEMENTATION { AUX { REAL z; BOOL d; } LINEAR { z = x + 2*(REAL b); } AD { d = z >= 1; }
      CONTINUOUS { x = (REAL d); } AUTOMATA { b = b; } } }"""
    model = hys.load(text)
    assert [mode.bits for mode in model.pwa.modes] == ["11", "10", "01", "00"]
    for x in (-1.5, 0.0, 2.0):
        for b in (0, 1):
            assert compare(model, model.pwa, np.array([x, b]), np.zeros(0))


COPIED = """SYSTEM s { INTERFACE { STATE { BOOL b; } } IMPLEMENTATION { AUX { BOOL d; } LOGIC { d = b; }
  AUTOMATA { b = d; } } }"""
TWO_EQUATIONS = """SYSTEM s { INTERFACE { STATE { REAL x [0, 2]; BOOL b, c; } } IMPLEMENTATION { AUX { REAL z; }
  LINEAR { z = x + (REAL b); } CONTINUOUS { x = z; } AUTOMATA { b = b; c = c; } %s } }"""


@pytest.mark.parametrize(
    "text",
    [
        COPIED,
        COPIED.replace("d = b;", "d = ~b;"),
        TWO_EQUATIONS % "MUST { z - x - (REAL c) <= 0; z - x - (REAL c) >= 0; }",
        TWO_EQUATIONS % "MUST { (REAL b) <= (REAL c); (REAL b) >= (REAL c); }",
    ],
)
def test_a_boolean_that_a_row_reads_is_never_lost(text):
    model = hys.load(text)
    pwa = hys.to_pwa(model.mld)
    for booleans in product((0, 1), repeat=sum(v.is_bool for v in pwa.x)):
        x = np.array([*(0.3 for v in pwa.x if not v.is_bool), *booleans])
        compare(model, pwa, x, np.zeros(0))


def test_rounding_of_the_auxiliaries_cuts_no_mode_away():
    """z1 = 3.75 comes with 1.5e-16 x from the elimination of the other five, which is no threshold of x."""
    model = hys.load(DATA / "rounding.hys")
    explored, searched = (hys.to_pwa(form, split_booleans=True) for form in (model, model.mld))
    assert set(by_word(explored)) == set(by_word(searched))
    assert len(searched.modes) == 8
    for mode in searched.modes:
        sizes = np.abs(np.concatenate([mode.region.A.ravel(), mode.dynamics.ravel()]))
        assert np.all((sizes == 0) | (sizes > 1e-3))


LOOP = """SYSTEM s { INTERFACE { STATE { REAL x [-4, 4]; } }
  IMPLEMENTATION { AUX { REAL z, w; BOOL d; } LINEAR { z = %s*w + x; w = z - (REAL d); } AD { d = w >= 1; }
  CONTINUOUS { x = 0.5*z; } } }"""


def test_algebraic_loop_is_settled_in_each_mode():
    model = hys.load(LOOP % "-1")
    assert model.dha.algebraic_loop
    pwa = model.pwa
    assert pwa.tree is None
    for x in (-3.0, 0.3, 1.9, 3.5):
        found, expected = stepped(pwa, [x], []), stepped(model.dha, [x], [])
        assert (found is None) == (expected is None)
        if found is not None:
            np.testing.assert_allclose(found[0], expected[0], atol=1e-12)


def test_singular_loop_is_an_error():
    with pytest.raises(hys.SimulationError, match=r"loop through .* singular"):
        _ = hys.load(LOOP % "1").pwa


def test_search_stops_at_the_limit_and_says_so():
    seen = []
    pwa = hys.to_pwa(hys.load("clutch"), max_modes=3, progress=lambda *counts: seen.append(counts))
    assert (len(pwa.modes), pwa.is_complete) == (3, False)
    assert [modes for modes, _, _ in seen] == [1, 2, 3]
    assert "not complete" in pwa.describe()
    with pytest.raises(hys.SimulationError, match="stopped by its limit"):
        pwa.step([150, 40, 60, 100, 0], [5, -8])
    for wrong in (0, 2.5):
        with pytest.raises(hys.ArgumentError, match="positive whole number"):
            hys.to_pwa(hys.load("clutch"), max_modes=wrong)
    with pytest.raises(hys.ArgumentError, match="Model, Dha or Mld"):
        hys.to_pwa("clutch")


def test_few_programs_for_each_mode():
    pwa = hys.load("clutch").pwa
    assert pwa.effort.programs <= 3 * len(pwa.modes)
    assert hys.load("two_rooms").pwa.effort.programs == 0


def test_an_mld_with_an_open_real_auxiliary_is_refused():
    mld = hys.load("SYSTEM s { INTERFACE { STATE { REAL x [0, 1]; } } IMPLEMENTATION { AUX { REAL z [0, 1]; }"
                   " CONTINUOUS { x = z; } MUST { z <= x; } } }").mld  # fmt: skip
    with pytest.raises(hys.SimulationError, match="do not determine the real auxiliaries"):
        hys.to_pwa(mld)


@pytest.mark.parametrize("name", ["clutch", "two_tanks", "two_rooms", "three_tanks"])
def test_shipped_models_at_random_points(name):
    model = hys.load(name)
    generator = np.random.default_rng(1)
    found = [
        compare(model, model.pwa, random_point(model.pwa.x, generator), random_point(model.pwa.u, generator))
        for _ in range(60)
    ]
    assert sum(found) > 30
