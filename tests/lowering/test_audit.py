"""The audit: constants by both rules, the ranges behind them, and what never changes."""

import math

import pytest

import hysdel_py as hys

TEXT = """SYSTEM s {
  INTERFACE { STATE { REAL x [-2, 3]; REAL w [-1000, 1000]; BOOL b; } }
  IMPLEMENTATION {
    AUX { BOOL d, e; REAL z, v; }
    AD { d = x <= 0; e = w <= 5; }
    LINEAR { v = w + x; }
    DA { z = {IF d THEN -x ELSE x};
    }
    MUST { w <= 4; (x <= 0) | b; }
    CONTINUOUS { x = z; w = (REAL (v <= 0)); }
  }
}"""


@pytest.fixture(scope="module")
def report():
    return hys.audit(hys.load(TEXT))


def row(report, defines, subindex):
    return next(r for r in report.rows if (r.origin.defines, r.origin.subindex) == (defines, subindex))


def test_every_row_of_ad_and_da_is_there_the_loosest_first(report):
    assert {(r.origin.defines, r.origin.subindex) for r in report.rows} >= {
        *((name, k) for name in "de" for k in (1, 2)),
        *(("z", k) for k in (1, 2, 3, 4)),
    }
    looseness = [r.looseness for r in report.rows]
    assert looseness == sorted(looseness, reverse=True)
    assert looseness[0] == math.inf


def test_numbers_of_a_row(report):
    second = row(report, "z", 2)
    assert (second.interval, second.lp) == pytest.approx((6, 6))
    first = row(report, "z", 1)
    assert first.interval == pytest.approx(4)
    assert first.lp == 0
    threshold = row(report, "d", 2)
    assert (threshold.largest, threshold.smallest, threshold.condition) == pytest.approx((3, 1, 3))
    assert threshold.epsilon == 1e-6
    assert threshold.resolution == pytest.approx(1e-6 / 3)


def test_the_range_that_matters_is_named_through_definitions(report):
    assert row(report, "d", 1).sources[0].declared.name == "x"
    generated = next(r for r in report.rows if r.origin.item == "AD" and "v <= 0" in r.origin.text)
    assert generated.advice == "1009 of 1009 comes through v from the range [-1000, 1000] of w, line 2"


def test_what_never_changes_is_told(report):
    assert [d.message for d in report.decided] == ["e is always true: definitions and MUST leave no other value"]


def test_shared_and_redundant(report):
    assert set(report.merged.values()) == {"d"}
    assert all(0 <= r.index < hys.load(TEXT).mld.ne for r in report.redundant)
    assert "big-M constants" in report.summary


def test_only_a_model_can_be_audited():
    with pytest.raises(hys.ArgumentError, match="a Model was expected"):
        hys.audit("clutch")


def test_a_model_without_constants():
    report = hys.audit(hys.load("SYSTEM s { INTERFACE { STATE { REAL x [0, 1]; } } IMPLEMENTATION { } }"))
    assert report.rows == ()
    assert report.tighter == 0
