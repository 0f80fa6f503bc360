"""Random models over vectors and with modules behave as the same models written out over scalars in one text."""

import numpy as np
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from strategies import module_models, vector_models

import hysdel_py as hys
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.formatter import format_text
from hysdel_py.syntax.parser import parse
from hysdel_py.syntax.source import Source

POINTS = 6
QUICK = settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)


def spelled(name):
    """Name of a scalar that stands for an element or for what belongs to a module."""
    return name.replace("(", "_").replace(")", "").replace(".", "_")


def points(dha, seed):
    """Random states and inputs, on a coarse grid half of the time so that thresholds are hit."""
    generator = np.random.default_rng(seed)
    for index in range(POINTS):
        found = []
        for group in (dha.x, dha.u):
            values = np.array([generator.uniform(v.low, v.high) for v in group])
            grid = np.array([v.is_bool for v in group], dtype=bool) | bool(index % 2)
            found.append(np.where(grid, np.round(values), values))
        yield found


def outcome(form, x, u):
    """Next state, output and declared auxiliaries of a step; None where there is no step."""
    try:
        x1, y, d, z = form.step(x, u, check=True)
    except hys.SimulationError:
        return None
    auxiliaries = {
        spelled(v.name): value
        for group, values in ((form.d, d), (form.z, z))
        for v, value in zip(group, values, strict=True)
        if not v.generated
    }
    return {spelled(v.name): value for v, value in zip(form.x, x1, strict=True)} | {
        f"output {spelled(v.name)}": value for v, value in zip(form.y, y, strict=True)
    } | auxiliaries  # fmt: skip


def assert_same_behaviour(ours, theirs, seed):
    """Both forms of both models step alike from the same points."""
    for group in "xuy":
        assert [spelled(v.name) for v in getattr(ours.dha, group)] == [v.name for v in getattr(theirs.dha, group)]
    for x, u in points(theirs.dha, seed):
        for left, right in ((ours.dha, theirs.dha), (ours.mld, theirs.mld)):
            found, expected = outcome(left, x, u), outcome(right, x, u)
            assert (found is None) == (expected is None)
            if expected is not None:
                assert found.keys() == expected.keys()
                np.testing.assert_allclose([found[key] for key in expected], list(expected.values()), atol=1e-9)


@QUICK
@given(vector_models(), st.integers(0, 2**32 - 1))
def test_vectors_and_loops_are_their_expansion(drawn, seed):
    vector, scalar = drawn
    ours, theirs = hys.load(vector), hys.load(scalar)
    assert_same_behaviour(ours, theirs, seed)


@QUICK
@given(module_models(), st.integers(0, 2**32 - 1))
def test_modules_are_their_text(tmp_path_factory, drawn, seed):
    whole, files, inlined = drawn
    folder = tmp_path_factory.mktemp("modules")
    for number, text in enumerate(files, start=1):
        (folder / f"part{number}.hys").write_text(text)
    ours, theirs = hys.load(whole, search_path=[folder]), hys.load(inlined)
    assert_same_behaviour(ours, theirs, seed)
    assert (ours.mld.nd, ours.mld.nz, ours.mld.ne) == (theirs.mld.nd, theirs.mld.nz, theirs.mld.ne)


@QUICK
@given(st.one_of(vector_models().map(lambda drawn: drawn[0]), module_models().map(lambda drawn: drawn[0])))
@example("SYSTEM s { INTERFACE { MODULE { t a, b; } } IMPLEMENTATION { MUST { a.x == b.x(1:2); 0 <= a.y <= 1; } } }")
def test_printed_text_is_the_same_tree(text):
    def tree(text):
        sink = Sink()
        system = parse(Source("text", text), sink)
        assert system is not None
        return system

    formatted = format_text(text)
    assert tree(formatted) == tree(text)
    assert format_text(formatted) == formatted
