"""Forms over parameters, bound to numbers, are the forms of the model loaded with these numbers."""

from dataclasses import fields

import numpy as np
import pytest
from export.matlab_reader import read_matlab
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from strategies import models

import hysdel_py as hys
from hysdel_py.export.compiled import compile_model
from hysdel_py.export.matlab import MatlabOptions, matlab_text
from hysdel_py.export.matrices import dense
from hysdel_py.lowering.constants import Constants
from hysdel_py.lowering.symbolic import MAX_SIZE
from hysdel_py.systems.signals import Type
from hysdel_py.systems.symbolic_mld import MATRICES


def assert_same(bound, numeric):
    for field in fields(hys.Mld):
        if field.name in MATRICES:
            np.testing.assert_array_equal(dense(bound, field.name), dense(numeric, field.name), err_msg=field.name)
        else:
            assert getattr(bound, field.name) == getattr(numeric, field.name), field.name


def assert_same_steps(bound, numeric, points=8):
    def uniform(variables):
        return [rng.integers(0, 2) if v.type is Type.BOOL else rng.uniform(v.low, v.high) for v in variables]

    def outcome(mld):
        try:
            return [*mld.step(x, u)[:2]]
        except hys.SimulationError as refused:
            return [type(refused).__name__]

    rng = np.random.default_rng(3)
    for _ in range(points):
        x, u = uniform(numeric.x), uniform(numeric.u)
        left, right = outcome(bound), outcome(numeric)
        assert len(left) == len(right)
        if len(left) > 1:
            np.testing.assert_allclose(np.concatenate(left), np.concatenate(right), atol=1e-9)


def system(items, *, parameters="REAL a;", aux="BOOL d; REAL z;", bounds="[0, 1]"):
    return (
        f"SYSTEM s {{ INTERFACE {{ STATE {{ REAL x {bounds}; }} PARAMETER {{ {parameters} }} }} "
        f"IMPLEMENTATION {{ AUX {{ {aux} }} {items} }} }}"
    )


@pytest.mark.parametrize("name", hys.shipped_models())
@pytest.mark.parametrize("constants", ["affine", "aux"])
def test_shipped_models(name, constants):
    model = hys.load(name)
    symbolic = hys.to_symbolic_mld(model, every=True, constants=constants)
    assert symbolic.parameters
    values = {name: model.parameters[name] for name in symbolic.parameters}
    assert_same(symbolic.bind(values), hys.to_mld(model, big_m="interval", constants=constants))


def test_comparison_of_parameters_alone():
    text = (
        "SYSTEM s {{ INTERFACE {{ STATE {{ REAL x [0, 1]; }} OUTPUT {{ BOOL w; }} PARAMETER {{ {} }} }}"
        "IMPLEMENTATION {{ CONTINUOUS {{ x = x; }} OUTPUT {{ w = (0.5 <= a) & (x <= a); }} }} }}"
    )
    bound = hys.to_symbolic_mld(hys.load(text.format("REAL a;"))).bind({"a": 0.75})
    numeric = hys.to_mld(hys.load(text.format("REAL a = 0.75;")), big_m="interval")
    assert len(bound.d) == len(numeric.d) + 1
    assert_same_steps(bound, numeric)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(models(), st.sampled_from([0.75, -0.5, 0.0, 2.0, -1.0]))
def test_random_models(text, a):
    model = hys.load(text.replace("REAL a = 0.75", "REAL a"))
    numeric = hys.to_mld(hys.load(text, a=a), big_m="interval")
    symbolic = hys.to_symbolic_mld(model)
    used = {"a": a} if symbolic.parameters else {}
    bound = symbolic.bind(used)
    if len(bound.d) != len(numeric.d):  # a comparison of parameters alone: a constant once they are numbers
        assert_same_steps(bound, numeric)
        return
    assert_same(bound, numeric)
    compiled, _ = compile_model(model.typed, model.parameters, Constants.AFFINE)
    data = read_matlab(matlab_text(compiled, MatlabOptions()), {"a": a})
    for name in MATRICES:
        expected = dense(numeric, name)
        np.testing.assert_allclose(data[name].reshape(expected.shape), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("a", [2.0, -3.0])
def test_open_ranges_triples_and_definitions(a):
    text = system(
        "AD { d = a*x - 1 <= 0 [-9*a, 9*a, 1e-3]; } DA { z = {IF d THEN b*x/a ELSE exp(a)^2 [a, b, 0]}; }"
        " CONTINUOUS { x = z + sqrt(a*a); }",
        parameters="REAL a, b = 2*a - 1;",
        bounds="[a, -a]",
    )
    assert_same(hys.to_symbolic_mld(hys.load(text)).bind({"a": a}), hys.to_mld(hys.load(text, a=a), big_m="interval"))


def test_an_open_epsilon():
    text = system("AD { d = x <= 0.5; } CONTINUOUS { x = (REAL d); }", parameters="REAL MLD_epsilon;", aux="BOOL d;")
    bound = hys.to_symbolic_mld(hys.load(text)).bind({"MLD_epsilon": 1e-3})
    assert_same(bound, hys.to_mld(hys.load(text, MLD_epsilon=1e-3), big_m="interval"))


def test_wrong_bindings_are_refused():
    symbolic = hys.to_symbolic_mld(hys.load(system("CONTINUOUS { x = x/a; }", aux="BOOL d;")))
    for values, words in (({}, "no value for the parameter a"), ({"a": 0.0}, "/"), ({"a": 1, "b": 2}, "parameter b")):
        with pytest.raises(hys.ArgumentError, match=words):
            symbolic.bind(values)


def test_a_bool_parameter_needs_a_value():
    text = system("LOGIC { d = q; } CONTINUOUS { x = 0.5*x; }", parameters="BOOL q;", aux="BOOL d;")
    with pytest.raises(hys.CompileError, match="HYS205"):
        hys.to_symbolic_mld(hys.load(text))
    assert not hys.to_symbolic_mld(hys.load(text, q=True), every=True).parameters


def test_unknown_ranges_are_still_errors():
    text = system("AD { d = a*x <= 0; } CONTINUOUS { x = (REAL d); }", aux="BOOL d;", bounds="")
    text = text.replace("CONTINUOUS { x = (REAL d); }", "")
    with pytest.raises(hys.CompileError, match="HYS401"):
        hys.to_symbolic_mld(hys.load(text))


def test_deep_expressions():
    depth = 10_000
    text = system(f"CONTINUOUS {{ x = {'(' * depth}a{' - 1)' * depth}*x; }}", aux="BOOL d;")
    model = hys.load(text)
    compiled, _ = compile_model(model.typed, model.parameters, Constants.FORBID)
    line = next(line for line in matlab_text(compiled, MatlabOptions()).splitlines() if line.startswith("(params.a"))
    assert line == f"(params.a{' - 1' * depth}) ;"
    assert compiled.mld.bind({"a": 1.0}).A.tolist() == [[1.0 - depth]]


def test_parameters_that_double_are_refused_where_they_are_used():
    parameters = "REAL p0, " + ", ".join(f"p{i} = p{i - 1}*p{i - 1}" for i in range(1, 60)) + ";"
    unused = hys.load(system("CONTINUOUS { x = p2*x; }", parameters=parameters, aux="BOOL d;"))
    compiled, _ = compile_model(unused.typed, unused.parameters, Constants.FORBID)
    assert "p0 * params.p0 * (params.p0 * params.p0)" in matlab_text(compiled, MatlabOptions())
    with pytest.raises(hys.CompileError, match="HYS406"):
        hys.to_symbolic_mld(hys.load(system("CONTINUOUS { x = p59*x; }", parameters=parameters, aux="BOOL d;")))


def test_expressions_that_double_are_refused():
    chain = 40
    names = [f"z{i}" for i in range(chain)]
    items = "".join(
        f"{z} = {{IF d THEN a*{before} ELSE {before}}};" for z, before in zip(names[1:], names, strict=False)
    )
    text = system(
        f"AD {{ d = x <= 0.5; }} LINEAR {{ z0 = x; }} DA {{ {items} }} CONTINUOUS {{ x = {names[-1]}; }}",
        aux=f"BOOL d; REAL {', '.join(names)};",
    )
    with pytest.raises(hys.CompileError, match=f"HYS406.*more than {MAX_SIZE}"):
        hys.to_symbolic_mld(hys.load(text))
