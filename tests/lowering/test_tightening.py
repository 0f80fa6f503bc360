"""Constants by linear programs: tighter where the model allows it, and no point is lost."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from lowering.relaxations import lost_by, near_a_threshold, violated
from lowering.test_dha_equals_mld import random_point
from strategies import models

import hysdel_py as hys
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.big_m import Ranges
from hysdel_py.lowering.relaxation import Effort, Relaxation
from hysdel_py.lowering.tightening import tighten
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.describe import inequalities

RANDOM = {
    "deadline": None,
    "suppress_health_check": list(HealthCheck),
    "derandomize": True,
    "phases": [Phase.explicit, Phase.generate],
}


def load(implementation, state="REAL x [-2, 3]; BOOL b;"):
    head = f"SYSTEM s {{ INTERFACE {{ STATE {{ {state} }} INPUT {{ REAL u [0, 1]; BOOL v; }} }}"
    return hys.load(f"{head} IMPLEMENTATION {{ {implementation} }} }}")


def rows(implementation, **options):
    return inequalities(hys.to_mld(load(implementation), **options))


ABSOLUTE = "AUX { BOOL d; REAL z; } AD { d = x <= 0; } DA { z = {IF d THEN -x ELSE x}; } CONTINUOUS { x = z; }"


def test_absolute_value_gets_its_hull():
    assert hys.to_mld(load(ABSOLUTE), big_m="interval").E2.toarray()[2:, 0].tolist() == [4, 6, -6, -4]
    tight = hys.to_mld(load(ABSOLUTE))
    # |x| over [-2, 3]: where x > 0, -x - z <= 0 and z + x <= 6; where x <= 0, x - z <= 0 and z - x <= 4
    assert tight.E2.toarray()[2:, 0] == pytest.approx([0.0, 6.0, 0.0, -4.0], abs=1e-5)
    assert (tight.z[0].low, tight.z[0].high) == pytest.approx((0, 3), abs=1e-5)


def test_requirements_count():
    text = "AUX { BOOL d; } AD { d = x <= u; } MUST { x + u <= 1; }"
    loose, tight = hys.to_mld(load(text), big_m="interval"), hys.to_mld(load(text))
    assert loose.E2.toarray()[1, 0] == pytest.approx(3)
    assert tight.E2.toarray()[1, 0] == pytest.approx(1)


def test_auxiliaries_are_tied_to_their_definitions():
    text = "AUX { BOOL d; REAL z; } LINEAR { z = 2*x; } AD { d = z - x <= 0; }"
    assert hys.to_mld(load(text), big_m="interval").E2.toarray()[3, 0] == pytest.approx(8)
    assert hys.to_mld(load(text)).E2.toarray()[3, 0] == pytest.approx(3)


def test_no_improvement_keeps_the_number_of_the_interval_rule():
    text = "AUX { BOOL d; REAL z; } AD { d = x <= 1; } DA { z = {IF b THEN x ELSE u}; }"
    assert rows(text) == rows(text, big_m="interval")


@pytest.mark.parametrize(("stated", "kept"), [("-2, 1, 1e-6", 1), ("-9, 9, 1e-6", 3)])
def test_stated_ranges_are_kept_where_they_are_tighter(stated, kept):
    mld = hys.to_mld(load(f"AUX {{ BOOL d; }} AD {{ d = x <= 0 [{stated}]; }}"))
    assert mld.E2.toarray()[1, 0] == pytest.approx(kept)


def test_a_promise_that_does_not_hold_does_no_harm_to_other_rows():
    text = "AUX { REAL z [0, 1]; BOOL d, e; } LINEAR { z = x; } AD { d = z <= 0.5; e = x <= 2.5; }"
    loose, tight = hys.to_mld(load(text), big_m="interval"), hys.to_mld(load(text))
    assert (loose.E2 != tight.E2).nnz == 0
    assert (tight.E5 == loose.E5).all()


@pytest.mark.parametrize(
    ("implementation", "ends"),
    [
        ("AUX { BOOL d; } AD { d = x <= 2; } MUST { x <= u; }", (1, 1)),
        ("AUX { BOOL d; } AD { d = x <= 2 - 5; }", (0, 0)),
        ("AUX { BOOL d; } AD { d = x <= 2; }", (0, 1)),
    ],
)
def test_a_threshold_that_never_switches_fixes_its_boolean(implementation, ends):
    mld = hys.to_mld(load(implementation))
    assert (mld.d[0].low, mld.d[0].high) == ends


def test_a_dead_branch_is_noted_with_its_line_and_switched_on_for_good():
    model = load("""AUX { BOOL d; REAL z; } AD { d = x <= 2; }
        DA { z = {IF d THEN x ELSE 100*u}; }
        MUST { x <= u; } CONTINUOUS { x = z; }""")
    loose = hys.to_mld(model, big_m="interval")
    mld = model.mld
    notes = [d for d in model.diagnostics if d.code is Code.DEAD_BRANCH]
    assert {model.typed.source.position(d.span.start)[0] for d in notes} == {1, 2}
    assert abs(loose.E2.toarray()[2:4, 0]).max() > 90
    assert mld.E2.toarray()[2:4, 0].tolist() == [0, 0]  # z = x outright
    assert mld.z[0].high <= 1 + 1e-9
    assert not lost_by(loose, mld)


def test_a_model_without_any_point_stays_as_it_is():
    text = "AUX { BOOL d; REAL z; } AD { d = x <= u; } DA { z = {IF d THEN x ELSE u}; } MUST { x + u <= -5; }"
    assert rows(text) == rows(text, big_m="interval")


def test_loops_through_auxiliaries_are_no_trouble():
    text = "AUX { BOOL d; REAL z; } AD { d = z <= 0; } DA { z = {IF d THEN -x - 3 ELSE x + 3}; } MUST { d | ~d; }"
    loose, tight = hys.to_mld(load(text), big_m="interval"), hys.to_mld(load(text))
    assert not lost_by(loose, tight)


def test_endless_ranges_of_what_is_not_needed():
    mld = hys.to_mld(load("AUX { BOOL d; } AD { d = x <= 0; } MUST { x + w <= 1; }", "REAL x [-1, 1], w; BOOL b;"))
    assert mld.E2.toarray()[1, 0] == pytest.approx(1)


def test_a_question_reaches_no_further_than_it_may():
    model = load(ABSOLUTE)
    boxes = {v.name: (v.low, v.high) for v in (*model.mld.x, *model.mld.u, *model.mld.d)} | {"z": (-9.0, 9.0)}
    tied = (Affine(0.0, (("z", 1.0), ("x", -1.0))),)
    form = Affine(0.0, (("z", 1.0),))
    for effort, bound in ((Effort(), 3.0), (Effort(rows=0), 9.0)):
        relaxation = Relaxation(model.dha, boxes, lambda item: tied, effort)
        assert relaxation.greatest(form, {}).bound == pytest.approx(bound)


@settings(max_examples=15, **RANDOM)
@given(models(), st.integers(0, 2**32 - 1))
def test_steps_of_the_dha_satisfy_every_row(text, seed):
    """Never looser than the interval rule, and every step of the Dha that breaks no MUST satisfies every row."""
    model = hys.load(text)
    dha, mld, loose = model.dha, model.mld, hys.to_mld(model, big_m="interval")
    assert [str(row) for row in mld.rows] == [str(row) for row in loose.rows]
    generator = np.random.default_rng(seed)
    for _ in range(10):
        x, u = random_point(mld.x, generator), random_point(mld.u, generator)
        try:
            _, _, d, z = dha.step(x, u)
        except hys.SimulationError:
            continue
        if not near_a_threshold(dha, x, u, d, z):
            assert violated(mld, x, u, d, z) == []
            assert all(v.low - 1e-9 <= value <= v.high + 1e-9 for v, value in zip(mld.z, z, strict=True))
            assert all(v.low <= value <= v.high for v, value in zip(mld.d, d, strict=True))


@settings(max_examples=15, **RANDOM)
@given(models())
def test_constants_are_never_above_those_of_the_interval_rule(text):
    dha = hys.load(text).dha
    ranges = Ranges(dha, Sink())
    tight = tighten(dha, ranges, Sink())
    for item in dha.items:
        if item.__class__.__name__ == "Event":
            old, new = ranges.event(item), tight.event(item)
            assert new.low >= old.low
            assert new.high <= old.high
        elif item.__class__.__name__ == "Switch":
            pairs = zip(ranges.switch(item).bounds, tight.switch(item).bounds, strict=True)
            assert all(new <= old for old, new in pairs)


@settings(max_examples=10, **RANDOM)
@given(models())
def test_no_integer_point_is_lost(text):
    model = hys.load(text)
    assert not lost_by(hys.to_mld(model, big_m="interval"), model.mld)


def shrunk(mld, row, share=0.99):
    """The Mld with the constant of one row made smaller, in the coefficient of the Boolean and on the right."""
    E2, E5 = mld.E2.tolil(), mld.E5.copy()
    column = int(np.argmax(abs(mld.E2.toarray()[row])))
    change = (1 - share) * E2[row, column]
    E2[row, column] -= change
    kind, number = mld.rows[row].item, mld.rows[row].subindex
    if (kind, number) in {("DA", 1), ("DA", 2), ("AD", 2)}:
        E5[row] -= change
    return replace(mld, E2=E2.tocsr(), E5=E5)


def test_the_checks_see_a_constant_that_is_too_small_by_one_percent():
    model = load(ABSOLUTE)
    loose, tight = hys.to_mld(model, big_m="interval"), model.mld
    assert not lost_by(loose, tight)
    constants = [i for i in range(tight.ne) if abs(tight.E2.toarray()[i, 0]) > 1e-3]
    assert constants == [0, 1, 3, 5]
    for row in constants:
        assert row in lost_by(loose, shrunk(tight, row)), f"row {row}"


def test_the_steps_see_it_too():
    model = load(ABSOLUTE)
    wrong = shrunk(model.mld, 3)
    _, _, d, z = model.dha.step([3.0, 0.0], [0.0, 0.0])
    assert violated(model.mld, np.array([3.0, 0.0]), np.zeros(2), d, z) == []
    assert violated(wrong, np.array([3.0, 0.0]), np.zeros(2), d, z) == [3]


def test_the_same_every_time():
    first, second = (hys.to_mld(hys.load("clutch")) for _ in range(2))
    assert (first.E5 == second.E5).all()
    assert (first.E2.toarray() == second.E2.toarray()).all()


def test_controllers_take_the_only_value_of_a_boolean():
    model = load("AUX { BOOL d, e; } AD { d = x <= 2; e = x <= 0; } MUST { x <= u; } CONTINUOUS { x = 0.5*x; }")
    program = hys.HybridMpc(model, 2, hys.Cost(x={"x": 1.0})).formulation
    ends = {program.describe_variable(i): (program.lb[i], program.ub[i]) for i in program.binaries}
    assert [pair for name, pair in ends.items() if name.startswith("d[")] == [(1, 1), (0, 1)] * 2
