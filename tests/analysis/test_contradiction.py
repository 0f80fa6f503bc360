"""Contradictions over several steps: against the enumeration of subsets, and against hand-made models."""

from itertools import combinations
from math import comb, inf

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from strategies import models

import hysdel_py as hys
from hysdel_py.analysis.consistency import Clock, Consistency
from hysdel_py.analysis.contradiction import Verdict, find_contradiction
from hysdel_py.analysis.horizon import Demand, MemberKind, build_horizon
from hysdel_py.analysis.milp import Status
from hysdel_py.errors import CompileError

MOST_SUBSETS = 100


def search(dha, steps, start, **options):
    """The horizon that the finding is about, and the finding."""
    built = []

    def build(apart):
        built.append(build_horizon(dha, steps, start, apart=apart, **options))
        return built[-1]

    finding = find_contradiction(dha, build(0.0), options.get("demands", ()), kept_apart=build)
    return built[-1], finding


def contradicts(horizon, members):
    """A search of its own, without what the other remembers."""
    fresh = Consistency(horizon, Clock(inf))
    return fresh.search(frozenset(members) | fresh.ends).status is Status.NONE


def assert_smallest(horizon, finding):
    found = [horizon.members.index(m) for m in finding.members]
    count = len(horizon.members)
    assume(comb(count, max(0, len(found) - 1)) <= MOST_SUBSETS)
    assert contradicts(horizon, found)
    if found:
        assert not any(contradicts(horizon, smaller) for smaller in combinations(range(count), len(found) - 1))


@given(models(), st.floats(-2, 3.5), st.integers(0, 3))
@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
def test_random_models(text, value, word):
    assume("MUST" in text)
    try:
        dha = hys.load(text).dha
    except CompileError:
        assume(False)
    start = {v.name: float(word >> i & 1) if v.is_bool else round(value, 2) for i, v in enumerate(dha.x)}
    horizon, finding = search(dha, 1, start)
    assert finding.verdict in (Verdict.FEASIBLE, Verdict.SMALLEST)
    if finding.verdict is Verdict.SMALLEST:
        assert_smallest(horizon, finding)
    else:
        assert finding.run is not None


def model(body, interface="STATE { REAL x [0, 10]; BOOL b; } INPUT { REAL u [0, 1]; BOOL v; }"):
    return hys.load(f"SYSTEM m {{ INTERFACE {{ {interface} }} IMPLEMENTATION {{ {body} }} }}").dha


def texts(finding):
    return [(m.step, m.origin.text if m.origin else f"{m.name} = {m.value:g}") for m in finding.members]


def ends(finding):
    return [(e.step, e.variable.name, e.is_high, e.derived) for e in finding.ends]


def test_requirement_against_threshold():
    dha = model("AUX { BOOL d; } AD { d = x >= 5; } CONTINUOUS { x = x; } AUTOMATA { b = b; } MUST { ~d; }")
    horizon, finding = search(dha, 3, {"x": 7.0, "b": 0.0})
    assert texts(finding) == [(0, "x = 7"), (0, "d = x >= 5"), (0, "~d")]
    assert finding.ends == ()
    assert not any(contradicts(horizon, pair) for pair in combinations(range(len(horizon.members)), 2))


def test_range_against_update():
    dha = model("CONTINUOUS { x = x + 2 + u; } AUTOMATA { b = b; }")
    _, finding = search(dha, 5, {"x": 5.0, "b": 0.0})
    assert texts(finding) == [(0, "x = 5"), *((k, "x = x + 2 + u") for k in range(3))]
    assert ends(finding) == [(0, "u", False, False), (1, "u", False, False), (2, "u", False, False),
                             (3, "x", True, False)]  # fmt: skip
    found = {(type(r.part).__name__, getattr(r.part, "name", "") or r.part.variable.name): r.value
             for r in finding.repairs}  # fmt: skip
    assert found[("End", "u")] == pytest.approx(1.0, abs=1e-6)  # 5 + 5*(2 - 1) = 10
    assert found[("End", "x")] == pytest.approx(5.0, abs=1e-6)
    assert found[("Member", "x")] == pytest.approx(-5.0, abs=1e-6)


def test_logic_alone():
    dha = model("CONTINUOUS { x = x; } AUTOMATA { b = b; } MUST { v | b; ~v; ~b; }")
    _, finding = search(dha, 2, {"x": 1.0, "b": 0.0})
    assert len(finding.members) == 3
    assert finding.verdict is Verdict.SMALLEST
    assert {m.kind for m in finding.members} <= {MemberKind.REQUIREMENT, MemberKind.START}


def test_boolean_state_and_given_input():
    dha = model("CONTINUOUS { x = x; } AUTOMATA { b = v; } MUST { ~b; }")
    _, finding = search(dha, 3, {"x": 1.0, "b": 0.0}, inputs={"v": (0.0, 1.0, 0.0)})
    assert texts(finding) == [(1, "v = 1"), (1, "b = v"), (2, "~b")]


def test_an_item_brings_no_range_of_what_it_reads():
    dha = model(
        "AUX { REAL z; BOOL d; } LINEAR { z = 0.1*x; } AD { d = z >= 0.5; }"
        " CONTINUOUS { x = x; } AUTOMATA { b = d; } MUST { z >= 1.5; }"
    )
    _, finding = search(dha, 1, {"x": 9.0, "b": 0.0})
    assert texts(finding) == [(0, "z = 0.1*x"), (0, "z >= 1.5")]
    assert ends(finding) == [(0, "x", True, False)]


def test_algebraic_loop():
    dha = model(
        "AUX { REAL z, w; } LINEAR { z = 0.5*w + x; w = 0.5*z; } CONTINUOUS { x = x; } AUTOMATA { b = b; }"
        " MUST { z <= 1; }"
    )
    _, finding = search(dha, 1, {"x": 3.0, "b": 0.0})
    assert texts(finding) == [(0, "x = 3"), (0, "z = 0.5*w + x"), (0, "w = 0.5*z"), (0, "z <= 1")]
    assert search(dha, 1, {"x": 0.5, "b": 0.0})[1].verdict is Verdict.FEASIBLE


def test_limit_of_an_output():
    dha = model(
        "CONTINUOUS { x = x - 1 + u; } AUTOMATA { b = b; } OUTPUT { y = x; }",
        "STATE { REAL x [0, 10]; BOOL b; } INPUT { REAL u [0, 0.5]; } OUTPUT { REAL y; }",
    )
    limit = Demand("y >= 4", "y", (("y", 1.0),), 4.0, inf, (1, 2, 3))
    _, finding = search(dha, 4, {"x": 5.0, "b": 0.0}, demands=(limit,))
    assert [m.name for m in finding.members if m.kind is MemberKind.LIMIT] == ["y >= 4"]
    assert ends(finding) == [(k, "u", True, False) for k in range(3)]
    assert any(r.part.kind is MemberKind.LIMIT and r.value == pytest.approx(0.5) for r in finding.repairs
               if not hasattr(r.part, "variable"))  # fmt: skip


def test_feasible_run_is_simulated():
    dha = model("CONTINUOUS { x = x + 1 - 2*u; } AUTOMATA { b = v; } MUST { x >= 8 -> b; x >= 7.5; }")
    _, finding = search(dha, 6, {"x": 8.0, "b": 1.0})
    assert finding.verdict is Verdict.FEASIBLE
    assert not finding.borderline
    again = dha.simulate(finding.run.x[0], finding.run.u)
    assert again.x == pytest.approx(finding.run.x)


def test_borderline():
    dha = model("CONTINUOUS { x = x; } AUTOMATA { b = b; } MUST { x <= 1; }")
    _, finding = search(dha, 1, {"x": 1.000003, "b": 0.0})
    assert finding.borderline
    assert finding.violation == pytest.approx(3e-6, rel=0.5)
    assert not search(dha, 1, {"x": 1.001, "b": 0.0})[1].borderline


@pytest.mark.parametrize("strict", ["u > 1", "~(u <= 1)", "x < 0 | u > 1"])
def test_a_strict_requirement_on_the_end_of_a_range(strict):
    dha = model(f"CONTINUOUS {{ x = x; }} AUTOMATA {{ b = b; }} MUST {{ {strict}; }}")
    _, finding = search(dha, 1, {"x": 2.0, "b": 0.0})
    assert finding.verdict is Verdict.SMALLEST
    assert finding.borderline
    assert (0, strict) in texts(finding)
    assert (0, "u", True, False) in ends(finding)


def test_a_strict_requirement_just_inside_of_a_range_is_feasible():
    dha = model("CONTINUOUS { x = x; } AUTOMATA { b = b; } MUST { u > 0.9999; }")
    _, finding = search(dha, 1, {"x": 2.0, "b": 0.0})
    assert finding.verdict is Verdict.FEASIBLE
    assert finding.run.u[0][0] > 0.9999


def test_time_limit_is_said():
    dha = model("CONTINUOUS { x = x + 2 + u; } AUTOMATA { b = b; }")
    horizon = build_horizon(dha, 5, {"x": 5.0, "b": 0.0})
    finding = find_contradiction(dha, horizon, seconds=1e-9)
    assert finding.verdict is Verdict.NOT_SETTLED
    assert finding.message


def test_time_limit_of_the_search_for_a_smaller_set(monkeypatch):
    dha = model("CONTINUOUS { x = x + 2 + u; } AUTOMATA { b = b; }")
    monkeypatch.setattr("hysdel_py.analysis.contradiction._HELD_BACK", 1.0)
    finding = find_contradiction(dha, build_horizon(dha, 5, {"x": 5.0, "b": 0.0}), seconds=60.0)
    assert finding.verdict is Verdict.IRREDUCIBLE
    assert len(finding.members) == 4
    assert finding.ends
    assert "smaller set" in finding.message
