"""The modes of a model: on random models and points all three forms agree, and both ways to the modes do."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from strategies import models

import hysdel_py as hys

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


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
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


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
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


@pytest.mark.parametrize("name", ["clutch", "two_tanks", "two_rooms", "three_tanks"])
def test_shipped_models_at_random_points(name):
    model = hys.load(name)
    generator = np.random.default_rng(1)
    found = [
        compare(model, model.pwa, random_point(model.pwa.x, generator), random_point(model.pwa.u, generator))
        for _ in range(100)
    ]
    assert sum(found) > 60
