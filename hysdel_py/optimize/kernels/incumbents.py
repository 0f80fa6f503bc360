"""Incumbents of the compiled search: words of binaries that are guessed, and points that are better than the best one.

`data`, `state` and `settings` are those of :func:`hysdel_py.optimize.kernels.search.run`.
"""

from __future__ import annotations

import numpy as np

from hysdel_py.compiled import compiled, leaf
from hysdel_py.optimize.kernels import places as its
from hysdel_py.optimize.kernels.certificate import excess
from hysdel_py.optimize.kernels.guessing import fix_word, follow
from hysdel_py.optimize.kernels.judging import BOUND, OBJECTIVE, worthwhile
from hysdel_py.optimize.kernels.linear import copy_to
from hysdel_py.optimize.kernels.node import value_at
from hysdel_py.optimize.kernels.tree import PENDING, WORDS

__all__ = ["look_around", "note_hinted", "note_word", "offer", "take_word", "within"]

MODULUS = 2**61 - 1
"""Words of binaries are told apart by their values as numbers modulo this."""


@leaf
def offer(data, box, w, state, settings):
    """Make a point with the binaries of a box the incumbent if it is better; False if it breaks a row."""
    problem, wide, binaries, known = data[its.PROBLEM], data[its.WIDE], data[its.BINARIES], data[its.KNOWN]
    for i in range(len(binaries)):
        w[binaries[i]] = box[0][binaries[i]]
    if not excess(problem, wide, w) <= settings[its.FEASIBILITY]:
        return False
    value = value_at(problem, w) + known[0]
    if value < state[its.NUMBERS][OBJECTIVE]:
        copy_to(state[its.INCUMBENT], w)
        state[its.NUMBERS][OBJECTIVE] = value
    return True


@compiled
def look_around(data, box, w, state, settings):
    """Guess words from a relaxed point: by its drivers, which is tried first, and by its binaries.

    What follows from the drivers is a point as well. Often it is as good as the best one with its word, and nothing
    else has to be tried; that is what is looked at first.
    """
    inside, other = (box[0].copy(), box[1].copy()), (box[0].copy(), box[1].copy())
    problem, columns, decisions, propagation = (
        data[its.PROBLEM], data[its.COLUMNS], data[its.DECISIONS], settings[its.PROPAGATION]
    )  # fmt: skip
    driven = follow(problem, columns, inside, w, decisions, True, propagation)
    if driven:
        offer(data, inside, within(inside, w), state, settings)
        if state[its.NUMBERS][BOUND] >= worthwhile(state[its.NUMBERS], settings[its.GAPS]):
            return
    if follow(problem, columns, other, w, decisions, False, propagation):
        note_word(word_of(other, data[its.BINARIES]), state)
    if driven:
        note_word(word_of(inside, data[its.BINARIES]), state)


@compiled
def note_hinted(data, box, near, state, settings):
    """Guess the word that follows from the drivers of a point that may be good."""
    inside = box[0].copy(), box[1].copy()
    if follow(data[its.PROBLEM], data[its.COLUMNS], inside, near, data[its.DECISIONS], True, settings[its.PROPAGATION]):
        note_word(word_of(inside, data[its.BINARIES]), state)


@compiled
def word_of(box, binaries):
    """Values of the binaries in a box that settles them."""
    word = np.empty(len(binaries))
    for i in range(len(binaries)):
        word[i] = box[0][binaries[i]]
    return word


@compiled
def within(box, w):
    """The point of a box that is nearest to another."""
    point = np.empty(len(w))
    for j in range(len(w)):
        point[j] = min(max(w[j], box[0][j]), box[1][j])
    return point


@leaf
def take_word(data, state, settings):
    """Fix the next word to be tried, within the bounds of the whole problem; False if the rows object."""
    counters, box = state[its.COUNTERS], state[its.BOX]
    counters[PENDING] -= 1
    copy_to(box[0], state[its.ROOT][0])
    copy_to(box[1], state[its.ROOT][1])
    word = state[its.TO_TRY][counters[PENDING]]
    return fix_word(data[its.PROBLEM], data[its.COLUMNS], box, data[its.BINARIES], word, settings[its.PROPAGATION])


@leaf
def note_word(word, state):
    """Put a word on the list of those to be tried, unless it was there before."""
    counters, words = state[its.COUNTERS], state[its.TRIED]
    code = 0
    for i in range(len(word)):
        code = (2 * code + (1 if word[i] > 0.5 else 0)) % MODULUS
    for i in range(min(counters[WORDS], len(words))):
        if words[i] == code:
            return
    words[counters[WORDS] % len(words)] = code
    counters[WORDS] += 1
    if counters[PENDING] < len(state[its.TO_TRY]):
        copy_to(state[its.TO_TRY][counters[PENDING]], word)
        counters[PENDING] += 1
