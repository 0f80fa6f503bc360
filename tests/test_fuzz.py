"""A sample of the inputs of benchmarks/fuzz.py: nothing but a CompileError comes out, in bounded time."""

import random
import sys
from importlib import util
from pathlib import Path

import pytest

PATH = Path(__file__).parents[1] / "benchmarks" / "fuzz.py"


@pytest.fixture(scope="module")
def fuzz():
    spec = util.spec_from_file_location("fuzz", PATH)
    module = util.module_from_spec(spec)
    sys.modules["fuzz"] = module
    spec.loader.exec_module(module)
    return module


def test_damaged_models_are_refused_or_accepted(fuzz):
    counts = fuzz.run(inputs=300, seed=2, seconds=20.0)
    assert set(counts) == {"accepted", "refused"}, counts


def test_the_same_seed_gives_the_same_inputs(fuzz):
    texts = fuzz.seeds()
    first, second = (fuzz.mutated(random.Random(5), texts) for _ in range(2))
    assert first == second


def test_a_fault_is_noticed(fuzz, monkeypatch, tmp_path):
    def broken(path):
        raise RecursionError

    monkeypatch.setattr(fuzz.hys, "load", broken)
    assert fuzz.outcome("SYSTEM", tmp_path / "m.hys", 1.0).startswith("FAULT: RecursionError")


def test_a_hang_is_noticed(fuzz, monkeypatch, tmp_path):
    def endless(path):
        while True:
            pass

    monkeypatch.setattr(fuzz.hys, "load", endless)
    assert fuzz.outcome("SYSTEM", tmp_path / "m.hys", 0.05).startswith("FAULT: more than")
