"""The clock of a chain of searches: limits, and those who watch and may end it."""

from math import inf

import pytest

import hysdel_py as hys
from hysdel_py.analysis.clock import Clock

TANK = """SYSTEM tank { INTERFACE { STATE { REAL h [0, 1]; } INPUT { REAL q [0, 0.2]; } OUTPUT { REAL y; } }
  IMPLEMENTATION { AUX { BOOL full; REAL out; } AD { full = h >= 0.8; } DA { out = {IF full THEN 0.5*h ELSE 0.1*h}; }
  CONTINUOUS { h = h + q - out; } OUTPUT { y = h; } } }"""


def test_a_limit_runs_out_and_a_part_can_be_held_back():
    clock = Clock(1000.0)
    assert 990.0 < clock.left <= 1000.0
    clock.hold_back(0.75)
    assert 240.0 < clock.left <= 250.0
    assert not clock.is_over
    assert clock.end == "the time was over"
    assert Clock().left == inf
    assert Clock(0.0).is_over


def test_who_watches_is_told_of_each_search_and_may_end_them():
    told = []
    clock = Clock(inf, lambda searches: told.append(searches) or searches >= 3)
    assert [clock.allowance() for _ in range(4)] == [inf, inf, 0.0, 0.0]
    assert told == [1, 2, 3, 4]
    assert clock.is_over
    assert clock.end == "the search was interrupted"


def asked(progress):
    """Each question that takes such a watcher, as whether it was settled."""
    model, other = hys.load(TANK), hys.load(TANK.replace("0.8", "0.9"))
    yield hys.verify(model, points=0, progress=progress).status.value != "not settled"
    yield hys.diff(model, other, progress=progress).status.value != "not settled"
    yield not hys.well_posed(model, progress=progress).unsettled
    yield hys.explain_infeasible(model, [0.5], 4, progress=progress).verdict != "not settled"
    yield hys.observability(model, 2, progress=progress).verdict != "not settled"


def test_without_an_objection_all_is_settled():
    counts = []
    assert all(asked(counts.append))
    assert counts.count(1) == 5
    assert len(counts) > 10


def test_an_objection_leaves_the_rest_open():
    assert not any(asked(lambda searches: True))


def test_searches_of_safety_can_be_ended_too():
    model = hys.load(TANK)
    seen = []
    answer = hys.can_reach(model, {"h": 0.1}, "h >= 1", 30, progress=lambda step, _: seen.append(step) or step == 4)
    assert (answer.verdict, seen[-1]) == ("not settled", 4)
    assert "the search was interrupted after step 4" in str(answer)
    assert hys.must_reach(model, {"h": 0.1}, "h >= 1", 30, progress=lambda *_: True).verdict in (
        "not settled",
        "avoidable",
    )


def test_queries_behind_an_objection_are_not_settled():
    text = "/* extension: queries */" + TANK.replace("OUTPUT { y = h; } }", "OUTPUT { y = h; } QUERIES { %s } }")
    model = hys.load(text % ("NEVER h >= 2 WITHIN 3; " * 3))
    assert [answer.verdict for answer in hys.answer_queries(model)] == ["holds"] * 3
    answers = hys.answer_queries(model, progress=lambda answered, _: answered >= 1)
    assert [answer.verdict for answer in answers] == ["holds", "not settled", "not settled"]
    with pytest.raises(hys.ArgumentError):
        hys.answer_queries(model, seconds=0)
