"""The work of the compiler grows with the model, not with its square: counted, not timed."""

import sys
from importlib import util
from pathlib import Path

import numpy as np
import pytest

import hysdel_py as hys

ROOT = Path(__file__).parents[1]
PACKAGE = str(Path(hys.__file__).parent)
MOST = 2.2
"""Twice the tanks may cost that many times the lines; sorting and growing dictionaries need some room above two."""


@pytest.fixture(scope="module")
def scale():
    spec = util.spec_from_file_location("scale", ROOT / "benchmarks" / "scale.py")
    module = util.module_from_spec(spec)
    sys.modules["scale"] = module
    spec.loader.exec_module(module)
    return module


def lines_of(scale, text):
    """How many lines of the package each stage runs."""
    counts = dict.fromkeys(scale.STAGES, 0)

    def observe(stage, work):
        def trace(frame, event, _argument):
            if event == "call":
                return trace if frame.f_code.co_filename.startswith(PACKAGE) else None
            counts[stage] += event == "line"
            return trace

        before = sys.gettrace()
        sys.settrace(trace)
        try:
            return work()
        finally:
            sys.settrace(before)

    scale.Run(text, observe).all_stages()
    return counts


@pytest.mark.parametrize("style", ["scalar", "vector"])
def test_twice_the_tanks_are_twice_the_work(scale, style):
    small, large = (lines_of(scale, scale.STYLES[style](n)) for n in (5, 10))
    grown = {stage: large[stage] / small[stage] for stage in scale.STAGES}
    assert max(grown.values()) < MOST, grown
    assert grown["mld"] > 1.8


def test_quadratic_work_is_noticed(scale, monkeypatch):
    """A stage that looks at every state once for every item fails the bound above."""

    def pairs(run):
        dha = run.made["dha"]
        return sum(v.is_bool for _ in dha.items for v in dha.x)

    monkeypatch.setattr(scale.Run, "python", pairs)
    small, large = (lines_of(scale, scale.vector_text(n)) for n in (2, 4))
    assert large["python"] > 3 * small["python"]


def test_both_styles_are_the_same_model(scale):
    scalar, vector = (hys.load(scale.STYLES[style](3)) for style in ("scalar", "vector"))
    assert [v.name.replace("(", "_").replace(")", "") for v in vector.mld.x] == [v.name for v in scalar.mld.x]
    for size in ("nx", "nu", "ny", "nd", "nz", "ne"):
        assert getattr(scalar.mld, size) == getattr(vector.mld, size)
    for name in ("E1", "E2", "E3", "E4"):
        ours, theirs = (np.sort(getattr(model.mld, name).data) for model in (scalar, vector))
        np.testing.assert_allclose(ours, theirs, rtol=1e-12)
