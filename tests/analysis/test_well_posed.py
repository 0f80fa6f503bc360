"""What a search over all states and inputs finds, each confirmed by stepping; and what it must not find."""

import pytest
from hypothesis import HealthCheck, given, settings
from strategies import models

import hysdel_py as hys
from hysdel_py.diagnostics.codes import Code


def text(body, aux="", must="", output=""):
    return f"""SYSTEM s {{
  INTERFACE {{ STATE {{ REAL x [-1, 1]; BOOL b; }} INPUT {{ REAL u [-1, 1]; }} OUTPUT {{ REAL y; }} }}
  IMPLEMENTATION {{ {f"AUX {{ {aux} }}" if aux else ""}
    {body}
    CONTINUOUS {{ x = 0.5*x; }} AUTOMATA {{ b = b; }} OUTPUT {{ y = {output or "x"}; }}
    {f"MUST {{ {must} }}" if must else ""}
  }}
}}"""


def codes(source, **options):
    report = hys.well_posed(hys.load(source), **options)
    assert not report.unsettled, report.unsettled
    return [finding.diagnostic.code for finding in report.findings]


def only(source):
    report = hys.well_posed(hys.load(source))
    (finding,) = report.findings
    return finding


def test_nothing_to_find():
    report = hys.well_posed(hys.load(text("AD { d = x <= u; } DA { z = {IF d THEN x ELSE u}; }", "BOOL d; REAL z;")))
    assert report.is_sound
    assert report.diagnostics == ()


@pytest.mark.parametrize("declared", ["REAL z [-1, 2];", "REAL z [-2, 1];"])
def test_range_of_an_auxiliary_too_narrow(declared):
    source = text("LINEAR { z = 2*x; } AD { d = z <= 0; }", declared + " BOOL d;", output="(REAL d)")
    finding = only(source)
    model = hys.load(source)
    x, u = dict(finding.point.x), dict(finding.point.u)
    model.dha.step(x, u)
    with pytest.raises(hys.SimulationError):
        model.mld.step(x, u)
    assert finding.diagnostic.code is Code.STEP_FORBIDDEN
    span = finding.diagnostic.labels[0].span
    assert source[span.start : span.end] == "z"
    assert source[: span.start].endswith("REAL ")


def test_stated_range_too_narrow():
    assert codes(text("AD { d = x + u <= 0 [-1, 2, 1e-6]; }", "BOOL d;")) == [Code.STEP_FORBIDDEN]
    assert codes(text("AD { d = x + u <= 0 [-2, 2, 1e-6]; }", "BOOL d;")) == []


def test_loop_with_two_solutions():
    source = text("LOGIC { d = e | b; e = d; }", "BOOL d, e;")
    finding = only(source)
    assert finding.diagnostic.code is Code.NOT_UNIQUE
    assert dict(finding.point.x)["b"] == 0.0  # where b holds the solution is unique
    assert "several solutions" in finding.point.outcome.problems[0]


def test_loop_with_one_solution():
    assert codes(text("LOGIC { d = e & ~e | b; e = d; }", "BOOL d, e;")) == []


@pytest.mark.parametrize(("must", "word"), [("x >= 0.5;", "never true"), ("x <= -0.5;", "never false")])
def test_event_that_never_changes(must, word):
    finding = only(text("AD { d = x <= 0; }", "BOOL d;", must))
    assert finding.diagnostic.code is Code.EVENT_CONSTANT
    assert word in finding.diagnostic.message


def test_event_that_is_true_on_its_threshold_alone():
    assert codes(text("AD { d = x <= -1; }", "BOOL d;")) == []
    assert codes(text("AD { d = x <= 0; }", "BOOL d;", "x >= 0;")) == []


def test_dead_branches():
    body = "AD { low = x <= -0.5; high = x >= 0.5; } DA { z = {IF low & high THEN 0 ELSE x}; }"
    finding = only(text(body, "BOOL low, high; REAL z;"))
    assert finding.diagnostic.code is Code.BRANCH_UNREACHABLE
    assert "THEN branch" in finding.diagnostic.message
    alive = body.replace("-0.5", "0.75").replace("low & high", "low & high & b")
    assert codes(text(alive, "BOOL low, high; REAL z;")) == []


def test_contradiction_is_irreducible():
    source = text("", "", "x + u >= 1; x - u <= 2; x <= 0.25; u <= 0.5;")
    finding = only(source)
    assert finding.diagnostic.code is Code.NOTHING_ALLOWED
    spans = [finding.diagnostic.span, *(label.span for label in finding.diagnostic.labels)]
    assert {source[s.start : s.end] for s in spans} == {"x + u >= 1", "x <= 0.25", "u <= 0.5"}


def test_contradiction_through_a_definition():
    source = text("AD { d = x <= 0; }", "BOOL d;", "d; x >= 0.5;")
    finding = only(source)
    spans = [finding.diagnostic.span, *(label.span for label in finding.diagnostic.labels)]
    assert {source[s.start : s.end] for s in spans} == {"d", "x >= 0.5", "d = x <= 0"}


def test_model_that_lives_on_a_threshold_is_no_contradiction():
    assert Code.NOTHING_ALLOWED not in codes(text("AD { d = x <= -1; }", "BOOL d;", "d;"))


def test_must_that_restricts_nothing():
    finding = only(text("", "", "x + u <= 0.5; 2*x + 2*u <= 1.5;"))
    assert finding.diagnostic.code is Code.MUST_IMPLIED
    assert codes(text("", "", "x + u <= 0.5; 2*x + u <= 1.25;")) == []
    assert codes(text("", "", "x <= 1;")) == []  # the compiler notes that itself


def test_state_that_leaves_its_range():
    source = text("").replace("x = 0.5*x", "x = 0.5*x + u")
    report = hys.well_posed(hys.load(source))
    assert [f.diagnostic.code for f in report.findings] == [Code.LEAVES_RANGE] * 2
    for finding in report.findings:
        x1 = hys.load(source).dha.step(dict(finding.point.x), dict(finding.point.u))[0]
        assert not -1 <= x1[0] <= 1
    assert codes(text("", must="0.5*x + u <= 1; 0.5*x + u >= -1;").replace("x = 0.5*x", "x = 0.5*x + u")) == []


def test_time_limit_leaves_questions_open():
    report = hys.well_posed(hys.load(text("AD { d = x <= 0; }", "BOOL d;", "x >= 0.5;")), seconds=1e-9)
    assert report.unsettled
    assert not report.is_sound
    with pytest.raises(hys.ArgumentError, match="seconds is 0"):
        hys.well_posed(hys.load("clutch"), seconds=0)


@settings(max_examples=8, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models())
def test_random_models_have_neither_gaps_nor_several_solutions(source):
    """Their auxiliaries have no declared ranges and no loops."""
    report = hys.well_posed(hys.load(source))
    found = {finding.diagnostic.code for finding in report.findings}
    assert not found & {Code.STEP_FORBIDDEN, Code.NOT_UNIQUE}
