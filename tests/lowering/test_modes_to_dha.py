"""A Pwa as a Dha, as an Mld and as a text: all of them step as the Pwa does."""

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from strategies import models

import hysdel_py as hys
from hysdel_py.export.hysdel_text import hysdel_text
from hysdel_py.lowering.modes_to_dha import pwa_to_dha
from hysdel_py.syntax.formatter import format_text


def random_point(variables, generator):
    return [float(generator.integers(2)) if v.is_bool else generator.uniform(v.low, v.high) for v in variables]


def stepped(form, x, u):
    try:
        return form.step(x, u)[:2]
    except hys.SimulationError:
        return None


def same_steps(pwa, forms, generator, points):
    """Number of points that have a step."""
    defined = 0
    for _ in range(points):
        x, u = random_point(pwa.x, generator), random_point(pwa.u, generator)
        expected = stepped(pwa, x, u)
        for form in forms:
            found = stepped(form, x, u)
            assert (found is None) == (expected is None), (x, u)
            for ours, theirs in zip(found or (), expected or (), strict=True):
                np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-9)
        defined += expected is not None
    return defined


@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models(), st.integers(0, 2**32 - 1), st.booleans())
def test_random_models_survive_the_way_through_their_modes(text, seed, merged):
    pwa = hys.load(text).pwa
    assume(0 < len(pwa.modes) <= 40)
    pwa = pwa.merge() if merged else pwa
    written = hys.load(hysdel_text(pwa_to_dha(pwa)))
    forms = (pwa_to_dha(pwa), hys.to_mld(pwa), written.dha)
    same_steps(pwa, forms, np.random.default_rng(seed), 5)


@pytest.mark.parametrize("name", ["clutch", "two_tanks", "two_rooms"])
def test_shipped_models(name):
    pwa = hys.load(name).pwa.merge()
    text = hysdel_text(pwa_to_dha(pwa))
    assert format_text(text) == text
    written = hys.load(text)
    assert same_steps(pwa, (written.dha, hys.to_mld(pwa)), np.random.default_rng(2), 20) > 5
    assert len(written.pwa.merge().modes) == len(pwa.modes)


def test_names_of_thresholds_stay():
    text = hysdel_text(pwa_to_dha(hys.load("clutch").pwa))
    for name in ("stick", "karnopp", "neg_slip", "lockupahead"):
        assert f"      BOOL {name};\n" in text
    assert text.count("<= 0;") == 4


@pytest.mark.parametrize("name", ["clutch", "two_rooms", "three_tanks"])
def test_text_of_the_dha_itself(name):
    dha = hys.load(name).dha
    again = hys.load(hysdel_text(dha)).dha
    generator = np.random.default_rng(0)
    for _ in range(20):
        x, u = random_point(dha.x, generator), random_point(dha.u, generator)
        found, expected = stepped(again, x, u), stepped(dha, x, u)
        assert (found is None) == (expected is None)
        for ours, theirs in zip(found or (), expected or (), strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12)


def test_epsilons_that_differ_are_written_as_triples():
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-1, 1]; } } IMPLEMENTATION { AUX { BOOL a, b; }
      AD { a = x <= 0 [-1, 1, 1e-3]; b = x - 0.5 <= 0; } CONTINUOUS { x = (REAL a) + (REAL b); } } }"""
    written = hysdel_text(hys.load(text).dha)
    assert "a = x <= 0 [-1, 1, 0.001];" in written
    assert {item.epsilon for item in hys.load(written).dha.items if hasattr(item, "epsilon")} == {1e-3, 1e-6}


def test_one_common_epsilon_is_a_parameter():
    text = """SYSTEM s { INTERFACE { PARAMETER { REAL MLD_epsilon = 0.01; } STATE { REAL x [-1, 1]; } }
      IMPLEMENTATION { AUX { BOOL a; } AD { a = x <= 0; } CONTINUOUS { x = (REAL a); } } }"""
    assert "REAL MLD_epsilon = 0.01;" in hysdel_text(hys.load(text).dha)
