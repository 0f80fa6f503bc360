"""Modes are found equal to the Dha, and faults in them are found, by the proof alone without random points."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from seeded_faults import (
    PWA_FAULTS,
    change_map,
    change_region_row,
    drop_region_row,
    lose_mode,
    pwa_fault,
    swap_words,
    with_mode,
)
from strategies import models

import hysdel_py as hys
from hysdel_py.analysis import verify_pwa
from hysdel_py.analysis.report import CheckStatus, Question, VerifyStatus

TEXT = """SYSTEM s {
  INTERFACE { STATE { REAL x [-2, 3]; BOOL b; } INPUT { REAL u [-1, 1]; BOOL v; } OUTPUT { REAL y; BOOL w; } }
  IMPLEMENTATION {
    AUX { BOOL d, e; REAL z; }
    AD { d = x + u <= 0.5; }
    LOGIC { e = d & ~v; }
    DA { z = {IF e THEN x + 1 ELSE u - 2}; }
    CONTINUOUS { x = 0.5*z; }
    AUTOMATA { b = b; }
    OUTPUT { y = z; w = ~d; }
    MUST { x - u <= 2.5; ~d | ~v; }
  }
}"""


@pytest.fixture(scope="module")
def model():
    return hys.load(TEXT)


def verdict(model, pwa, **options):
    return hys.verify(model, pwa=pwa, **{"points": 0, **options})


def row_of(pwa, mode, kind):
    return next(i for i, source in enumerate(pwa.modes[mode].sources) if source.kind.value == kind)


def assert_different(model, pwa, question):
    report = verdict(model, pwa)
    assert report.status is VerifyStatus.DIFFERENT, str(report)
    witnessed = {check.question for check in report.failed() if check.witness is not None}
    assert question in witnessed, str(report)
    assert all(check.witness.form == "Pwa" for check in report.failed() if check.witness is not None)
    return report


def test_a_model_and_its_own_modes_are_equal(model):
    report = hys.verify(model, points=60, seed=3)
    assert report.is_equal, str(report)
    assert report.forms == ("Mld", "Pwa")
    assert report.points.equal > 15
    alone = verdict(model, model.pwa)
    assert {check.question for check in alone.checks} == {
        Question.LOST_MODE, Question.BEYOND, Question.MODE, Question.OVERLAP,
    }  # fmt: skip
    assert len(alone.checks) == 1 + 3 * len(model.pwa.modes) + 1
    assert "Dha, Pwa have the same steps" in str(alone)


def test_modes_found_in_other_ways_are_equal(model):
    assert all(mode.values["b"] is None for mode in model.pwa.modes)  # it is only copied
    assert verdict(model, hys.to_pwa(model, split_booleans=True)).is_equal
    assert verdict(model, hys.to_pwa(model.mld)).is_equal


@pytest.mark.parametrize("name", ["clutch", "two_tanks", "two_rooms", "three_tanks"])
def test_modes_of_shipped_models_are_equal(name):
    model = hys.load(name)
    assert verdict(model, model.pwa, points=20).is_equal


def test_mode_across_a_threshold_does_not_hold_by_the_slack_of_its_rows():
    """Where speeds are large that slack is wider than the gap, and the mode on the point's own side is forbidden.

    Every other random point lies on a threshold or beside one.
    """
    report = hys.verify(hys.load("bist_part1"), points=200)
    assert report.is_equal, str(report)


@pytest.mark.parametrize("name", ["clutch", "two_tanks"])
def test_joined_modes_are_equal(name):
    model = hys.load(name)
    joined = model.pwa.merge()
    assert len(joined.modes) < len(model.pwa.modes)
    assert verdict(model, joined, points=20).is_equal
    assert verdict(model, lose_mode(joined, 0)).status is VerifyStatus.DIFFERENT
    assert verdict(model, change_map(joined, 1, "f", 0, 0.5)).status is VerifyStatus.DIFFERENT
    assert verdict(model, change_region_row(joined, 0, 0, amount=-0.5)).status is VerifyStatus.DIFFERENT


@settings(max_examples=5, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models())
def test_modes_of_random_models_are_equal(text):
    model = hys.load(text)
    report = verdict(model, model.pwa, points=10)
    assert report.is_equal, str(report)


def test_lost_mode(model):
    report = assert_different(model, lose_mode(model.pwa, 0), Question.LOST_MODE)
    witness = next(check.witness for check in report.failed() if check.witness)
    assert witness.first.exists
    assert "in the region of no mode" in witness.second.problems[0]
    assert model.pwa.locate(dict(witness.x), dict(witness.u)) == 0


@pytest.mark.parametrize(("name", "place"), [("A", (0, 0)), ("B", (0, 0)), ("C", (0, 0)), ("f", 0), ("g", 0)])
def test_changed_map(model, name, place):
    report = assert_different(model, change_map(model.pwa, 0, name, place, 0.01), Question.MODE)
    assert report.failed()[0].subject.startswith("mode 0 (")


def test_changed_map_below_the_tolerance(model):
    assert verdict(model, change_map(model.pwa, 0, "f", 0, 1e-9)).is_equal
    assert verdict(model, change_map(model.pwa, 0, "f", 0, 1e-3), margins=hys.Margins(tolerance=1e-2)).is_equal


@pytest.mark.parametrize("kind", ["event", "must", "range", "boolean"])
def test_dropped_row(model, kind):
    pwa = model.pwa
    mode = next(m.index for m in pwa.modes if any(s.kind.value == kind for s in m.sources))
    row = row_of(pwa, mode, kind)
    if kind == "boolean":  # an end that a value of the Boolean lies beyond
        row = next(i for i, s in enumerate(pwa.modes[mode].sources)
                   if s.kind.value == kind and s.text in ("v <= 0", "v >= 1"))  # fmt: skip
    assert_different(model, drop_region_row(pwa, mode, row), Question.BEYOND)


@pytest.mark.parametrize(("amount", "question"), [(-0.1, Question.LOST_MODE), (0.1, Question.BEYOND)])
def test_moved_row(model, amount, question):
    pwa = change_region_row(model.pwa, 0, row_of(model.pwa, 0, "event"), amount=amount)
    assert_different(model, pwa, question)


def test_flipped_row_and_swapped_words(model):
    assert_different(model, change_region_row(model.pwa, 0, row_of(model.pwa, 0, "event"), sign=-1.0), Question.BEYOND)
    report = assert_different(model, swap_words(model.pwa, 0, 1), Question.BEYOND)
    overlap = next(check for check in report.checks if check.question is Question.OVERLAP)
    assert overlap.status is CheckStatus.NOT_SETTLED


def test_a_mode_twice_with_another_map_overlaps(model):
    first = change_map(model.pwa, 0, "f", 0, 0.5).modes[0]
    twice = with_mode(model.pwa, 1, region=first.region, word=first.word, sources=first.sources)
    assert_different(model, twice, Question.OVERLAP)


@pytest.mark.parametrize("kind", PWA_FAULTS)
def test_clutch_faults(kind):
    model = hys.load("clutch")
    faulty = pwa_fault(model.pwa, kind, np.random.default_rng(0))
    report = verdict(model, faulty)
    assert report.status is VerifyStatus.DIFFERENT, str(report)


@settings(max_examples=2, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models(), st.sampled_from(PWA_FAULTS), st.integers(0, 2**32 - 1))
def test_random_faults_are_caught_or_change_nothing(text, kind, seed):
    model = hys.load(text)
    faulty = pwa_fault(model.pwa, kind, np.random.default_rng(seed)) if model.pwa.modes else None
    if faulty is None:
        return
    report = verdict(model, faulty, points=60)
    is_proven = all(check.status is CheckStatus.HOLDS for check in report.checks)
    assert not (is_proven and report.points.different), str(report)
    assert report.status is not VerifyStatus.NOT_SETTLED, str(report)


def test_limits_leave_it_open(model, monkeypatch):
    report = hys.verify(model, points=0, seconds=1e-9, forms=("pwa",))
    assert report.status is VerifyStatus.NOT_SETTLED
    given = verdict(model, model.pwa, seconds=1e-9)
    assert given.status is VerifyStatus.NOT_SETTLED
    monkeypatch.setattr(verify_pwa, "MOST_MODES", 1)
    many = verdict(model, model.pwa)
    assert many.status is VerifyStatus.NOT_SETTLED
    assert "more than 1" in str(many)


def test_wrong_arguments(model):
    with pytest.raises(hys.ArgumentError, match="the Pwa has the state vector"):
        hys.verify(model, pwa=hys.load("clutch").pwa)
    with pytest.raises(hys.ArgumentError, match="mld, pwa or both were expected"):
        hys.verify(model, forms=("pwl",))
    with pytest.raises(hys.ArgumentError, match="forms leaves it out"):
        hys.verify(model, pwa=model.pwa, forms=("mld",))
