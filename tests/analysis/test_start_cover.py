"""Covers of boxes by words that their corners share, for programs whose answers are known."""

from dataclasses import dataclass, field

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.analysis.consistency import Clock
from hysdel_py.analysis.start_cover import at_thresholds, cover_of


@dataclass
class Halfplanes:
    """Word 1 serves where x + y <= `right`, word 0 where x + y >= `left`; each plan costs x^2 + y^2."""

    left: float
    right: float
    asked: list = field(default_factory=list)

    def word(self, x):
        self.asked.append(x)
        if x.sum() >= self.left:
            return np.array([0.0])
        return np.array([1.0]) if x.sum() <= self.right else None

    def cost(self, x, word):
        fits = x.sum() <= self.right if word[0] else x.sum() >= self.left
        return float(x @ x) if fits else np.inf


BOX = np.array([-1.0, -1.0]), np.array([1.0, 2.0])


def test_one_word_serves_the_whole_box():
    found = cover_of(Halfplanes(-5.0, -5.0), BOX, Clock(60.0), most=10)
    assert (found.is_complete, found.parts, found.cost) == (True, 1, 5.0)


def test_parts_with_two_words_cover_the_box():
    found = cover_of(Halfplanes(0.0, 0.3), BOX, Clock(60.0), most=500)
    assert found.is_complete
    assert found.parts > 2
    assert found.cost == pytest.approx(5.0)


def test_a_gap_between_the_words_is_found():
    found = cover_of(Halfplanes(0.3, 0.0), BOX, Clock(60.0), most=500)
    assert not found.is_complete
    assert 0.0 < found.without.sum() < 0.3


def test_words_that_only_touch_are_not_settled():
    found = cover_of(Halfplanes(0.1234, 0.1234), BOX, Clock(60.0), most=60)
    assert not found.is_complete
    assert found.without is None
    assert found.open is not None


def test_the_word_of_a_corner_saves_a_cut():
    """The centre has word 0, which the corner at (-1, -1) lacks; word 1, which that corner has, serves all."""
    found = cover_of(Halfplanes(-1.0, 3.0), BOX, Clock(60.0), most=10)
    assert (found.is_complete, found.parts) == (True, 1)


def test_a_point_is_a_box():
    programs = Halfplanes(0.0, 0.0)
    assert cover_of(programs, (np.ones(2), np.ones(2)), Clock(60.0), most=3).cost == 2.0
    assert len(programs.asked) == 1


def test_thresholds_of_single_states_cut_a_box():
    model = hys.load(
        "SYSTEM s { INTERFACE { STATE { REAL v [-4, 4]; REAL w [-4, 4]; } } IMPLEMENTATION { AUX { BOOL a, b; REAL z; }"
        " AD { a = v >= 1; b = v + w <= 0; } DA { z = {IF a & b THEN 0.1 ELSE 0}; }"
        " CONTINUOUS { v = 0.5*v + z; w = w; } } }"
    )
    parts = at_thresholds((np.array([-2.0, 0.0]), np.array([3.0, 1.0])), model.dha)
    assert len(parts) == 2
    (low, middle), (above, high) = sorted(parts, key=lambda part: part[0][0])
    assert (low[0], high[0], above[0]) == (-2.0, 3.0, 1.0)
    assert 0.0 < above[0] - middle[0] < 1e-3
    assert at_thresholds((np.zeros(2), np.full(2, 0.5)), model.dha)[0][1][0] == 0.5
