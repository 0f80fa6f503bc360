"""The Pwa: steps, reasons, runs, merging and graphs."""

import re
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.systems.mode import RowKind

STATE, INPUT = [150, 40, 60, 100, 0], [5, -8]
TEXT = """SYSTEM s {
  INTERFACE { STATE { REAL x [-2, 2]; } INPUT { BOOL v; REAL u [-1, 1]; } }
  IMPLEMENTATION { AUX { BOOL low; REAL z; }
    AD { low = x <= 0; }
    DA { z = {IF low & v THEN x ELSE 2*x}; }
    CONTINUOUS { x = 0.5*z; }
    MUST { low | ~v;
      x <= 1.5; } } }"""


@pytest.fixture(scope="module")
def clutch():
    return hys.load("clutch").pwa


def test_step_names_the_mode(clutch):
    x1, y, mode = clutch.step(STATE, INPUT)
    expected = hys.load("clutch").dha.step(STATE, INPUT)
    np.testing.assert_allclose(x1, expected[0], rtol=1e-12)
    np.testing.assert_allclose(y, expected[1], rtol=1e-12)
    assert clutch.modes[mode].values["lockupahead"] is False
    assert clutch.locate(STATE, INPUT) == mode


@pytest.mark.parametrize(
    ("x", "u", "reason"),
    [
        ([-3.0], [0, 0], "outside its range"),
        ([5e-7], [0, 0], "epsilon gap of low, in line 4: x <= 0"),
        ([1.0], [0.0, 1.0], "MUST is violated in line 7: low | ~v"),
        ([1.7], [0, 0], "MUST is violated in line 8: x <= 1.5"),
    ],
)
def test_reasons_in_words_of_the_source(x, u, reason):
    pwa = hys.load(TEXT).pwa
    with pytest.raises(hys.SimulationError, match=re.escape(reason)):
        pwa.step(x, u)
    assert pwa.locate(x, u) is None


def test_wrong_arguments():
    with pytest.raises(hys.ArgumentError, match="2 entries were expected"):
        hys.load(TEXT).pwa.step([0.0], [1.0])


def test_simulation_gives_the_trajectory_of_the_mld(clutch):
    inputs = np.tile([1.0, -0.5], (12, 1))
    run, expected = clutch.simulate(STATE, inputs), hys.load("clutch").mld.simulate(STATE, inputs)
    for name in ("x", "u", "y", "d", "z"):
        np.testing.assert_allclose(getattr(run, name), getattr(expected, name), atol=1e-9)
    assert run["mode"].tolist() == [clutch.locate(x, u) for x, u in zip(run.x, run.u, strict=False)]


def test_each_row_has_a_source(clutch):
    for mode in clutch.modes:
        assert len(mode.sources) == mode.region.m
        assert {source.kind for source in mode.sources} <= {RowKind.EVENT, RowKind.RANGE}
        assert all(source.line > 0 for source in mode.sources)


def test_tree_is_shallower_than_the_list_of_modes_is_long(clutch):
    assert clutch.tree.depth <= 4 < len(clutch.modes)
    engage = hys.load("three_tanks").pwa
    assert engage.tree.depth < len(engage.modes) / 4


def test_merge_keeps_the_behaviour(clutch):
    merged = clutch.merge()
    assert len(merged.modes) == 5
    assert [mode.bits for mode in merged.modes] == ["11*101", "101100", "100100", "0*0110", "0*0000"]
    generator = np.random.default_rng(3)
    for _ in range(60):
        x = [generator.uniform(v.low, v.high) for v in clutch.x]
        u = [generator.uniform(v.low, v.high) for v in clutch.u]
        found, expected = merged.step(x, u), clutch.step(x, u)
        for ours, theirs in zip(found[:2], expected[:2], strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-12)
        for ours, theirs in zip(merged.auxiliaries(x, u), clutch.auxiliaries(x, u), strict=True):
            np.testing.assert_array_equal(ours, theirs)


def test_merged_modes_close_the_gap_between_them(clutch):
    in_gap = [150, 5e-7, 0.0, 100, 0]  # between neg_slip and its negation, both stuck
    with pytest.raises(hys.SimulationError, match="gap of neg_slip"):
        clutch.step(in_gap, [0, 0])
    assert clutch.merge().step(in_gap, [0, 0])[2] == 0


def test_modes_of_different_booleans_join_where_nothing_depends_on_them():
    merged = hys.load("two_rooms").pwa.merge()
    assert len(merged.modes) == 8
    assert merged.modes[0].bits == "*101*10"


def test_modes_around_a_corner_do_not_join():
    """Three quadrants of equal dynamics are no convex set."""
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-1, 1], y [-1, 1]; } }
      IMPLEMENTATION { AUX { BOOL a, b; REAL z; } AD { a = x <= 0; b = y <= 0; }
      DA { z = {IF a & b THEN 1 ELSE 0}; } CONTINUOUS { x = z; y = y; } } }"""
    merged = hys.load(text).pwa.merge()
    assert [mode.bits for mode in merged.modes] == ["111", "*00", "010"]


SMALL_INPUT = """SYSTEM s { INTERFACE { STATE { REAL x [0, 1]; BOOL b; } INPUT { REAL u [0, 1e-9]; } }
  IMPLEMENTATION { AUX { BOOL d; } AD { d = x <= 0.5; } CONTINUOUS { x = 2e9*u; } AUTOMATA { b = d; } } }"""
SMALL_OUTPUT = """SYSTEM s { INTERFACE { STATE { REAL x [0, 1]; } OUTPUT { REAL y; } }
  IMPLEMENTATION { AUX { BOOL d; REAL z; } AD { d = x <= 0.5; } DA { z = {IF d THEN 5e-10 ELSE 0}; }
  CONTINUOUS { x = x; } OUTPUT { y = z; } } }"""


@pytest.mark.parametrize(("text", "rest"), [(SMALL_INPUT, ([0], [4e-10])), (SMALL_OUTPUT, ([], []))])
def test_maps_differ_in_their_smallest_row(text, rest):
    """A Boolean beside a coefficient of 2e9, and an output that is 5e-10 in all."""
    booleans, u = rest
    model = hys.load(text)
    for pwa in (model.pwa, hys.to_pwa(model.mld)):
        assert len(pwa.dynamics) == 2
        for x in ([0.2, *booleans], [0.8, *booleans]):
            for ours, theirs in zip(pwa.merge().step(x, u)[:2], model.dha.step(x, u)[:2], strict=True):
                np.testing.assert_allclose(ours, theirs, rtol=1e-12)


def test_maps_that_differ_by_rounding_alone_are_equal():
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-1, 1]; } }
      IMPLEMENTATION { AUX { BOOL d; REAL z; } AD { d = x <= 0; }
      DA { z = {IF d THEN 0.1*x + 0.2*x ELSE 0.3*x}; } CONTINUOUS { x = z; } } }"""
    pwa = hys.load(text).pwa
    assert pwa.modes[0].A[0, 0] != pwa.modes[1].A[0, 0]
    assert len(pwa.dynamics) == len(pwa.merge().modes) == 1


def test_a_variable_without_a_finite_range_is_compared_by_its_coefficient(clutch):
    first = clutch.modes[0]
    second = replace(first, index=1, A=first.A + 1e-6 * np.eye(5))
    endless = tuple(replace(v, low=-np.inf, high=np.inf) for v in clutch.x)
    assert replace(clutch, x=endless, modes=(first, replace(first, index=1))).dynamics == ((0, 1),)
    assert replace(clutch, x=endless, modes=(first, second)).dynamics == ((0,), (1,))


def test_modes_of_booleans_alone_join():
    text = """SYSTEM s { INTERFACE { STATE { BOOL b; } INPUT { BOOL v; } }
      IMPLEMENTATION { AUX { BOOL d; } LOGIC { d = b | v; } AUTOMATA { b = d; } } }"""
    pwa = hys.load(text).pwa
    merged = pwa.merge()
    assert [mode.bits for mode in merged.modes] == ["1*1", "011", "000"]
    for b, v in product((0, 1), repeat=2):
        np.testing.assert_array_equal(merged.step([b], [v])[0], [b | v])


def test_merged_modes_without_a_tree_step():
    """Nothing tells which of the joined modes a point was in: that matters for auxiliaries, not for the step."""
    text = """SYSTEM s { INTERFACE { STATE { BOOL b; } INPUT { BOOL v; } }
      IMPLEMENTATION { AUX { BOOL d, e; } LOGIC { d = b | v; e = b & v; } AUTOMATA { b = d; } } }"""
    pwa = hys.to_pwa(hys.load(text).mld)
    merged = pwa.merge()
    assert pwa.tree is None
    assert len(merged.modes) < len(pwa.modes)
    for b, v in product((0, 1), repeat=2):
        np.testing.assert_array_equal(merged.step([b], [v])[0], [b | v])
    assert merged.auxiliaries([0], [0])[0].tolist() == [0, 0]
    both = [mode.index for mode in merged.modes if merged.owner.count(mode.index) > 1]
    point = next(w for w in product((0, 1), repeat=2) if merged.locate(w[:1], w[1:]) in both)
    with pytest.raises(hys.SimulationError, match="before merge"):
        merged.auxiliaries(point[:1], point[1:])


def test_adjacency_is_a_chain_of_thresholds():
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-1, 5]; } }
      IMPLEMENTATION { AUX { BOOL a, b; } AD { a = x <= 0; b = x <= 2; } CONTINUOUS { x = x + 1.5*(REAL b); } } }"""
    pwa = hys.load(text).pwa
    words = [mode.bits for mode in pwa.modes]
    assert words == ["11", "01", "00"]
    assert sorted(pwa.adjacency().edges) == [(0, 1), (1, 2)]
    assert pwa.adjacency().edges[0, 1]["across"] == "x <= 0"
    assert sorted(pwa.transitions().edges) == [(0, 1), (1, 1), (1, 2), (2, 2)]


def test_transitions_of_the_clutch_hold_what_runs_show(clutch):
    edges = set(clutch.transitions().edges)
    assert len(edges) == 34
    generator = np.random.default_rng(5)
    seen = set()
    for _ in range(300):
        x = [generator.uniform(v.low, v.high) for v in clutch.x]
        u, after = ([generator.uniform(v.low, v.high) for v in clutch.u] for _ in range(2))
        x1, _, mode = clutch.step(x, u)
        follower = clutch.locate(x1, after)
        seen |= {(mode, follower)} if follower is not None else set()
    assert seen <= edges
    assert len(seen) > 8


def test_description(clutch):
    text = clutch.describe()
    assert text.startswith("clutch: piecewise affine form, 8 modes, 4 different dynamics\n")
    assert "  equal dynamics: modes 3, 5, 7\n" in text
    assert "    if gamma > reltol (line 52)\n" in text
