"""The rows of a step have the solutions that the step of the Dha has, and no others."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from strategies import models

import hysdel_py as hys
from hysdel_py.analysis.encoding import encode_step, ranges_by_definition, shared_variables
from hysdel_py.analysis.milp import Milp, Source, Status
from hysdel_py.analysis.tseitin import formula_variable
from hysdel_py.systems.dha import Event
from hysdel_py.systems.formula import Connective, Formula
from hysdel_py.systems.origin import Origin

NEAR = 1e-4


def encoded(dha, **options):
    problem = Milp()
    step = encode_step(problem, dha, shared_variables(problem, (*dha.x, *dha.u)), **options)
    return problem, step


def search_at(problem, step, point):
    there = problem.copy()
    for name, value in point.items():
        there.fix(step.values[name], value)
    answer = there.search()
    return there.refine(answer.w) if answer.status is Status.FOUND else answer


def sampled(dha, generator):
    return {
        v.name: float(generator.integers(2)) if v.is_bool else float(generator.uniform(v.low, v.high))
        for v in (*dha.x, *dha.u)
    }


def assert_same(dha, problem, step, point):
    """'step' or 'must'; None beside a threshold, where neither is asked for."""
    x, u = ({v.name: point[v.name] for v in group} for group in (dha.x, dha.u))
    _, _, d, z = dha.step(x, u, check=False)
    values = point | dict(zip((v.name for v in (*dha.d, *dha.z)), (*d, *z), strict=True))
    if any(abs(item.form.value(values)) < NEAR for item in dha.items if isinstance(item, Event)):
        return None
    answer = search_at(problem, step, point)
    try:
        x1, y, *_ = dha.step(x, u)
    except hys.SimulationError:
        assert answer.status is Status.NONE
        return "must"
    assert answer.status is Status.FOUND
    found = [[answer.w[places[v.name]] for v in group] for group, places in (
        (dha.x, step.next), (dha.y, step.outputs), (dha.d, step.values), (dha.z, step.values))]  # fmt: skip
    for ours, theirs in zip(found, (x1, y, d, z), strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-7, rtol=1e-7)
    return "step"


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models(), st.integers(0, 2**32 - 1))
def test_random_models_step_alike(text, seed):
    dha = hys.load(text).dha
    problem, step = encoded(dha)
    generator = np.random.default_rng(seed)
    for _ in range(4):
        assert_same(dha, problem, step, sampled(dha, generator))


STEPS = {"bist_part2": 2, "supply_chain": 0}
"""How many of twelve points have a step, where requirements refuse most of them; both sides must agree on the rest."""


@pytest.mark.parametrize("name", sorted(hys.shipped_models()))
def test_shipped_models_step_alike(name):
    dha = hys.load(name).dha
    problem, step = encoded(dha)
    generator = np.random.default_rng(5)
    outcomes = [assert_same(dha, problem, step, sampled(dha, generator)) for _ in range(12)]
    assert outcomes.count("step") >= STEPS.get(name, 6)


TEXT = """SYSTEM s { INTERFACE { STATE { REAL x [-2, 3]; BOOL b; } OUTPUT { REAL y; REAL never; } }
  IMPLEMENTATION { AUX { BOOL d; REAL z; } AD { d = x <= 0; } DA { z = {IF d & b THEN x ELSE 1 [0, 0.5, 0]}; }
  CONTINUOUS { x = z; } AUTOMATA { b = ~d; } OUTPUT { y = z; } MUST { x <= 2.5; } } }"""


@pytest.mark.parametrize(
    ("x", "expected"), [(-1.0, Status.FOUND), (0.0, Status.FOUND), (0.25, Status.FOUND), (2.6, Status.NONE)]
)
def test_must_forbids(x, expected):
    problem, step = encoded(hys.load(TEXT).dha)
    answer = search_at(problem, step, {"x": x, "b": 0.0})
    assert answer.status is expected
    if expected is Status.FOUND:
        assert answer.w[step.values["d"]] == float(x <= 0)
        assert answer.w[step.outputs["never"]] == 0.0
        assert answer.w[step.next["x"]] == pytest.approx(1.0)  # the stated [0, 0.5] of the branch plays no part


def test_band_and_clearance_leave_a_gap_on_each_side():
    problem, step = encoded(hys.load(TEXT).dha, band=lambda event: 0.25, below=lambda event: 0.5)
    open_at = {x: search_at(problem, step, {"x": x, "b": 1.0}).status is Status.FOUND
               for x in (-0.6, -0.5, -0.4, 0.0, 0.2, 0.25, 0.3)}  # fmt: skip
    assert open_at == {-0.6: True, -0.5: True, -0.4: False, 0.0: False, 0.2: False, 0.25: True, 0.3: True}


def test_items_can_be_left_out():
    dha = hys.load(TEXT).dha
    problem, step = encoded(dha, leave_out=lambda item: item.origin.section == "MUST")
    assert search_at(problem, step, {"x": 2.6, "b": 0.0}).status is Status.FOUND
    assert not [row for row in problem.rows if row.source and row.source.origin.section == "MUST"]


def test_rows_name_item_and_time():
    problem, _ = encoded(hys.load(TEXT).dha, step=3)
    sources = [row.source for row in problem.rows if row.source is not None]
    assert {source.step for source in sources} == {3}
    assert "d = x <= 0" in {source.origin.text for source in sources}


def test_ranges_follow_definitions_not_declarations():
    dha = hys.load(TEXT.replace("REAL z;", "REAL z [0, 0.1];")).dha
    assert ranges_by_definition(dha)["z"] == (-2.0, 3.0)


def test_endless_range_is_refused():
    text = TEXT.replace("REAL x [-2, 3]", "REAL x").replace("x <= 0;", "x <= 0 [-9, 9, 1e-6];")
    text = text.replace("THEN x ELSE 1 [0, 0.5, 0]", "THEN x [-9, 9, 0] ELSE 1 [0, 2, 0]")
    with pytest.raises(hys.ArgumentError, match="x has no finite range, which the definition of d needs"):
        encoded(hys.load(text).dha)


def test_undefined_auxiliary_is_refused_where_it_is_used():
    text = TEXT.replace("BOOL d; REAL z;", "BOOL d, e; REAL z;")
    problem, step = encoded(hys.load(text).dha)
    assert search_at(problem, step, {"x": 1.0, "b": 1.0}).w[step.values["e"]] == 0.0
    with pytest.raises(hys.ArgumentError, match="e is used but never defined"):
        encoded(hys.load(text.replace("b = ~d", "b = e")).dha)


FORMULAS = st.recursive(
    st.sampled_from(["a", "b", True, False]).map(lambda leaf: (leaf,)),
    lambda inner: st.one_of(
        inner.map(lambda f: (*f, Connective.NOT)),
        st.tuples(inner, inner, st.sampled_from([c for c in Connective if c is not Connective.NOT])).map(
            lambda parts: (*parts[0], *parts[1], parts[2])
        ),
    ),
    max_leaves=5,
)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(FORMULAS, st.booleans(), st.booleans())
def test_logic_has_the_truth_of_the_formula(postfix, a, b):
    formula, problem = Formula(postfix), Milp()
    values = {"a": problem.boolean(), "b": problem.boolean()}
    root = formula_variable(problem, formula, values, Source(Origin()))
    for name, value in (("a", a), ("b", b)):
        problem.fix(values[name], float(value))
    truth = float(formula.value({"a": float(a), "b": float(b)}))
    assert problem.search({root: 1.0}).w[root] == pytest.approx(truth)
    assert problem.search({root: -1.0}).w[root] == pytest.approx(truth)
