"""The meaning of a model: thresholds, loops, undefined auxiliaries, requirements."""

import pytest

import hysdel_py as hys


def load(implementation, interface="STATE { REAL x [-2, 3]; BOOL b; }"):
    return hys.load(f"SYSTEM s {{ INTERFACE {{ {interface} }}\nIMPLEMENTATION {{ {implementation} }} }}")


@pytest.mark.parametrize("form", ["dha", "mld"])
@pytest.mark.parametrize(("comparison", "below", "at", "above"), [("<=", 1, 1, 0), (">=", 0, 1, 1)])
def test_a_threshold_belongs_to_the_true_side(form, comparison, below, at, above):
    system = getattr(load(f"AUX {{ BOOL d; }} AD {{ d = x {comparison} 0.5; }} AUTOMATA {{ b = d; }}"), form)
    assert [system.step([x, 0])[2][0] for x in (0.4, 0.5, 0.6)] == [below, at, above]


def test_the_gap_lies_on_the_false_side_of_the_mld_form_only():
    model = load("AUX { BOOL d; } AD { d = x <= 0.5; } AUTOMATA { b = d; }")
    inside = [0.5 + 0.5e-6, 0]
    assert model.dha.step(inside)[2] == [0]
    with pytest.raises(hys.SimulationError, match="epsilon gap of d"):
        model.mld.step(inside)
    assert model.mld.step([0.5 + 2e-6, 0])[2] == [0]


@pytest.mark.parametrize("form", ["dha", "mld"])
def test_violated_requirements_are_named(form):
    system = getattr(load("MUST { x <= 1; b -> b; }"), form)
    with pytest.raises(hys.SimulationError, match="MUST is violated in line 2: x <= 1"):
        system.step([2, 0])
    assert system.step([1, 0])[0].tolist() == [0, 0]


def test_every_violated_requirement_is_reported():
    with pytest.raises(hys.SimulationError) as caught:
        load("MUST { x <= 1; ~b; x <= 5; }").dha.step([2, 1])
    assert len(caught.value.problems) == 2
    assert load("MUST { x <= 1; }").dha.step([2, 1], check=False)[0].tolist() == [0, 0]


def test_loop_is_a_warning_and_no_step_for_the_dha():
    model = load("AUX { BOOL d, e; } LOGIC { d = e | b; e = d; } AUTOMATA { b = d; }")
    assert set(model.dha.algebraic_loop) == {"d", "e"}
    assert "HYS505" in [d.code.value for d in model.diagnostics]
    with pytest.raises(hys.SimulationError, match="algebraic loop"):
        model.dha.step([0, 0])


def test_loop_in_the_mld_form_is_solved_where_the_solution_is_unique():
    mld = load("AUX { BOOL d, e; } LOGIC { d = e | b; e = d; } AUTOMATA { b = d; }").mld
    assert mld.step([0, 1])[2].tolist() == [1, 1]
    with pytest.raises(hys.SimulationError, match="not unique"):
        mld.step([0, 0])


def test_model_without_loop():
    assert load("AUX { REAL z; } LINEAR { z = x; } CONTINUOUS { x = z; }").dha.algebraic_loop == ()


@pytest.mark.parametrize(
    ("form", "message"), [("dha", "z is used but never defined"), ("mld", "nothing determines it")]
)
def test_undefined_auxiliary(form, message):
    system = getattr(load("AUX { REAL z; } CONTINUOUS { x = z; }"), form)
    with pytest.raises(hys.SimulationError, match=message):
        system.step([0, 0])


@pytest.mark.parametrize("form", ["dha", "mld"])
def test_undefined_and_unused_auxiliary_is_zero(form):
    result = getattr(load("AUX { REAL z; BOOL d; } CONTINUOUS { x = x; }"), form).step([1, 1])
    assert [v.tolist() for v in result] == [[1, 0], [], [0], [0]]


def test_ranges_of_auxiliaries_are_promises_for_big_m_and_not_part_of_the_meaning():
    stated = load("AUX { BOOL d; } AD { d = x <= 0 [-1, 1, 1e-6]; } AUTOMATA { b = d; }")
    assert stated.dha.step([2, 0])[2] == [0]
    declared = load("AUX { REAL z [0, 1]; } LINEAR { z = x; } CONTINUOUS { x = 0.5*z; }")
    for form in (declared.dha, declared.mld):
        assert form.step([3, 0])[0].tolist() == [1.5, 0]


@pytest.mark.parametrize(
    ("body", "x", "z"),
    [
        ("AUX { REAL z, w; } LINEAR { z = w + x; w = 0.5*z; } CONTINUOUS { x = 0.1*z; }", 0.3, [0.6, 0.3]),
        ("AUX { REAL z [-9, 9]; BOOL d; } AD { d = z >= 0.5; } DA { z = {IF d THEN x ELSE x/2}; }", 0.3, [0.15]),
    ],
)
def test_loop_with_one_solution_is_settled_by_both_forms(body, x, z):
    model = load(body)
    for form in (model.dha, model.mld):
        assert form.step([x, 0])[3] == pytest.approx(z)


@pytest.mark.parametrize(
    ("body", "count"),
    [
        ("AUX { BOOL d, e; } LOGIC { d = e; e = d; }", "several solutions"),
        ("AUX { BOOL d, e; } LOGIC { d = e; e = ~d; }", "no solution"),
        ("AUX { REAL z, w; } LINEAR { z = w + x; w = z; }", "no solution"),
    ],
)
def test_other_loops_are_refused(body, count):
    with pytest.raises(hys.SimulationError, match=rf"algebraic loop through .* has {count}"):
        load(body).dha.step([0.3, 0])


@pytest.mark.parametrize("size", [1.0, 1e3, 1e5])
@pytest.mark.parametrize("distance", [0.0, 1e-3])
def test_both_forms_agree_at_and_near_thresholds_of_any_size(size, distance):
    text = f"""SYSTEM s {{ INTERFACE {{ STATE {{ REAL x [0, {size}]; }} }} IMPLEMENTATION {{
        AUX {{ BOOL d; REAL z; }} AD {{ d = x >= {size / 2}; }} DA {{ z = {{IF d THEN x ELSE 0}}; }}
        CONTINUOUS {{ x = z; }} }} }}"""
    model = hys.load(text)
    for sign in (1, -1):
        x = size / 2 + sign * distance
        assert [v.tolist() for v in model.mld.step([x])] == [v.tolist() for v in model.dha.step([x])]


def test_truth_values():
    model = load("AUX { BOOL d; } LOGIC { d = TRUE & (b | FALSE); } AUTOMATA { b = TRUE; }")
    for form in (model.dha, model.mld):
        assert form.step([0, 0])[2] == [0]
        assert form.step([0, 1])[2] == [1]
        assert form.step([0, 0])[0].tolist() == [0, 1]


def test_impossible_requirement_is_never_silent():
    model = load("MUST { FALSE; }")
    for form in (model.dha, model.mld):
        with pytest.raises(hys.SimulationError, match="MUST"):
            form.step([0, 0])


def test_clutch_engages():
    """The shipped model does what its physics say: slip shrinks under normal force until the clutch sticks."""
    model = hys.load("clutch")
    run = model.simulate([150, 40, 60, 100, 0], [[0, 0]] * 40)
    assert run["gamma"][-1] < 1
    assert (run["gamma"][:-1][run.d[:, 0] == 0] > 1).all()
    assert run.t[-1] == pytest.approx(0.4)
    both = model.mld.simulate([150, 40, 60, 100, 0], [[0, 0]] * 40, ts=0.01)
    assert both.x == pytest.approx(run.x, abs=1e-7)
    assert both.modes == run.modes
