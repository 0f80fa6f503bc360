"""Equal forms are found equal, faulty ones are not; by the proof alone, without random points."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from seeded_faults import (
    change_coefficient,
    change_constant,
    change_epsilon,
    drop_row,
    event_rows,
    flip_row,
    random_fault,
    shift_row,
)
from strategies import models

import hysdel_py as hys
from hysdel_py.analysis.report import CheckStatus, Question, VerifyStatus

TEXT = """SYSTEM s {
  INTERFACE { STATE { REAL x [-2, 3]; BOOL b; } INPUT { REAL u [-1, 1]; BOOL v; } OUTPUT { REAL y; BOOL w; } }
  IMPLEMENTATION {
    AUX { BOOL d, e; REAL z, q; }
    AD { d = x + u <= 0.5; }
    LOGIC { e = d & ~v | b; }
    DA { z = {IF e THEN x + 1 ELSE u - 2}; }
    LINEAR { q = z - 2*x; }
    CONTINUOUS { x = 0.5*z; }
    AUTOMATA { b = e -> v; }
    OUTPUT { y = q; w = ~d; }
    MUST { x - u <= 2.5; ~b | ~v; }
  }
}"""
FAR = 0.05


@pytest.fixture(scope="module")
def model():
    return hys.load(TEXT)


def verdict(model, mld, **options):
    return hys.verify(model, mld=mld, **{"points": 0, **options})


def rows_of(mld, item, defines=""):
    return [i for i, origin in enumerate(mld.rows) if origin.item == item and defines in ("", origin.defines)]


def test_a_model_and_its_own_form_are_equal(model):
    report = hys.verify(model, points=60, seed=3, forms=("mld",))
    assert report.status is VerifyStatus.EQUAL
    assert report.points.total == 60
    assert report.points.equal > 20
    assert report.points.infeasible > 5
    assert {check.question for check in report.checks} == {
        Question.FORBIDDEN, Question.ANOTHER_VALUE, Question.ALLOWED, Question.EQUATION,
    }  # fmt: skip
    assert len(report.checks) == model.mld.ne + model.mld.nd + model.mld.nz + 2 + 4


@pytest.mark.parametrize("name", sorted(hys.shipped_models()))
def test_shipped_models_are_equal(name):
    model = hys.load(name)
    assert verdict(model, model.mld).is_equal


@settings(max_examples=6, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models())
def test_random_models_are_equal(text):
    model = hys.load(text)
    report = hys.verify(model, points=10, forms=("mld",))
    assert report.is_equal, str(report)


def assert_confirmed(model, mld, report):
    """Every witness stands when both forms are stepped once more."""
    witnesses = [check.witness for check in report.checks if check.status is CheckStatus.DIFFERENT]
    assert witnesses
    for witness in witnesses:
        steps = []
        for form in (model.dha, mld):
            try:
                steps.append(np.concatenate(form.step(dict(witness.x), dict(witness.u))))
            except hys.SimulationError:
                steps.append(None)
        ours, theirs = steps
        assert (ours is None) != (theirs is None) or (ours is not None and abs(ours - theirs).max() > 1e-7)


def assert_different(model, mld, *questions):
    report = verdict(model, mld)
    assert report.status is VerifyStatus.DIFFERENT, str(report)
    assert {check.question for check in report.failed() if check.witness} >= set(questions)
    assert_confirmed(model, mld, report)
    return report


def test_interval_constant_too_small(model):
    second_row_of_event = event_rows(model.mld)[0] + 1
    column = [v.name for v in model.mld.d].index("d")
    smaller = change_constant(shift_row(model.mld, second_row_of_event, -0.5), second_row_of_event, -0.5, column)
    report = assert_different(model, smaller, Question.FORBIDDEN)
    check = next(c for c in report.failed() if c.question is Question.FORBIDDEN)
    assert check.rows == (second_row_of_event,)
    assert check.origins[0].line == 5
    assert not check.witness.second.exists
    assert check.witness.first.exists


def test_interval_constant_too_large_changes_nothing(model):
    i = event_rows(model.mld)[0] + 1
    larger = change_constant(shift_row(model.mld, i, 4.0), i, 4.0, [v.name for v in model.mld.d].index("d"))
    assert verdict(model, larger).is_equal


@pytest.mark.parametrize("item", ["AD", "Logic", "DA", "Linear", "Cont_must", "Logic_must"])
def test_every_dropped_row_is_noticed(model, item):
    kinds = {Question.ALLOWED} if item.endswith("must") else {Question.ANOTHER_VALUE}
    mld = hys.to_mld(model, big_m="interval")  # tighter constants imply the row of MUST
    for i in rows_of(mld, item, "e" if item == "Logic" else ""):
        assert_different(model, drop_row(mld, i), *kinds)


def test_dropped_row_that_the_rest_implies_changes_nothing(model):
    """Of b = e -> v, the clause that v implies the right side: v excludes b, and without b, v excludes e."""
    generated = rows_of(model.mld, "Logic", "__additional_1")
    verdicts = [verdict(model, drop_row(model.mld, i)).status for i in generated]
    assert verdicts == [VerifyStatus.DIFFERENT, VerifyStatus.EQUAL, VerifyStatus.DIFFERENT]


def test_dropped_copy_of_a_row_changes_nothing():
    model = hys.load(TEXT.replace("~b | ~v;", "~b | ~v; ~b | ~v;"))
    rows = rows_of(model.mld, "Logic_must")
    assert len(rows) == 2
    assert verdict(model, drop_row(model.mld, rows[0])).is_equal


@pytest.mark.parametrize("item", ["AD", "Logic", "DA", "Linear", "Cont_must"])
def test_every_flipped_row_is_noticed(model, item):
    for i in rows_of(model.mld, item):
        assert_different(model, flip_row(model.mld, i))


@pytest.mark.parametrize(("amount", "question"), [(FAR, Question.FORBIDDEN), (-FAR, Question.ANOTHER_VALUE)])
def test_wrong_epsilon(model, amount, question):
    assert_different(model, change_epsilon(model.mld, event_rows(model.mld)[0], amount), question)


def test_no_epsilon_at_all_is_noticed_on_the_threshold(model):
    mld = change_epsilon(model.mld, event_rows(model.mld)[0], -1e-6)
    witness = assert_different(model, mld, Question.ANOTHER_VALUE).failed()[0].witness
    values = dict(witness.x) | dict(witness.u)
    assert values["x"] + values["u"] == pytest.approx(0.5, abs=1e-8)


@pytest.mark.parametrize(
    ("name", "place"), [("B3", (0, 0)), ("B5", (0,)), ("B2", (1, 2)), ("D3", (0, 1)), ("A", (1, 1))]
)
def test_wrong_update_or_output(model, name, place):
    assert_different(model, change_coefficient(model.mld, name, place, FAR), Question.EQUATION)


def test_difference_below_the_tolerance_is_none(model):
    assert verdict(model, change_coefficient(model.mld, "B3", (0, 0), 1e-9)).is_equal
    assert not verdict(model, change_coefficient(model.mld, "B3", (0, 0), 1e-4)).is_equal
    wide = hys.Margins(tolerance=1e-2)
    assert verdict(model, change_coefficient(model.mld, "B3", (0, 0), 1e-4), margins=wide).is_equal


def test_points_alone_name_a_difference(model):
    report = hys.verify(model, mld=change_coefficient(model.mld, "B3", (0, 0), FAR), points=20)
    assert report.points.different
    assert report.points.different[0].differing == ("x'",)


def test_clutch_faults():
    model = hys.load("clutch")
    mld = model.mld
    event = event_rows(mld)[1]
    for faulty in (drop_row(mld, 9), flip_row(mld, 12), change_epsilon(mld, event, 1.0), shift_row(mld, 10, -5.0)):
        assert_different(model, faulty)


@settings(max_examples=6, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models(), st.integers(0, 2**32 - 1))
def test_random_faults_are_caught_or_change_nothing(text, seed):
    """Where the proof says equal, stepping at random points must not show a difference."""
    model = hys.load(text)
    fault = random_fault(model.mld, np.random.default_rng(seed))
    if fault is None:
        return
    report = verdict(model, fault[1], points=60)
    is_proven = all(check.status is CheckStatus.HOLDS for check in report.checks)
    assert not (is_proven and report.points.different), str(report)
    assert report.status is not VerifyStatus.NOT_SETTLED, str(report)


def test_time_limit_leaves_it_open(model):
    report = hys.verify(model, points=0, seconds=1e-9, forms=("mld",))
    assert report.status is VerifyStatus.NOT_SETTLED
    assert any(check.status is CheckStatus.NOT_SETTLED for check in report.checks)
    assert "not settled" in str(report)


def test_two_solutions_of_a_loop():
    text = """SYSTEM s { INTERFACE { STATE { BOOL b; } } IMPLEMENTATION { AUX { BOOL d, e; }
      LOGIC { d = e; e = d; } AUTOMATA { b = d; } } }"""
    model = hys.load(text)
    report = hys.verify(model, points=5, forms=("mld",))
    assert report.points.infeasible == 5  # neither form has a unique step anywhere
    assert report.status is VerifyStatus.NOT_SETTLED
    assert {check.status for check in report.failed()} == {CheckStatus.DOUBTFUL}


@pytest.mark.parametrize("must", ["FALSE;", "TRUE;", "1 <= 2;", "2 <= 1;", "x <= 1; FALSE;"])
def test_must_without_variables(must):
    text = "SYSTEM s { INTERFACE { STATE { REAL x [-1, 1]; } } IMPLEMENTATION { CONTINUOUS { x = x; } MUST { %s } } }"
    model = hys.load(text % must)
    assert hys.verify(model, points=4, forms=("mld",)).is_equal
    if model.mld.ne:
        assert hys.verify(model, mld=flip_row(model.mld, model.mld.ne - 1), points=4).status is VerifyStatus.DIFFERENT


def test_other_variables_are_refused(model):
    with pytest.raises(hys.ArgumentError, match=r"the Mld has the state vector .*: \(x, b\) was expected"):
        hys.verify(model, mld=hys.load("clutch").mld)


@pytest.mark.parametrize("options", [{"points": -1}, {"seconds": 0}])
def test_wrong_arguments(model, options):
    with pytest.raises(hys.ArgumentError, match="was expected"):
        hys.verify(model, **options)
    with pytest.raises(hys.ArgumentError, match="band is 0"):
        hys.Margins(band=0.0)


def test_report_is_the_same_twice_and_plain_data(model):
    faulty = drop_row(model.mld, 0)
    first, second = (hys.verify(model, mld=faulty, points=20) for _ in range(2))
    assert str(first) == str(second)
    data = first.as_data()
    assert data["status"] == "different"
    assert data["checks"][0]["lines"][0]["text"] == "d = x + u <= 0.5"
