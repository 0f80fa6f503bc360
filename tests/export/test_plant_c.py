"""Plants in C step as the Dha does and tell what they violate."""

from __future__ import annotations

import ctypes
import shutil
import subprocess

import numpy as np
import pytest
from export.compiled_c import needs_gcc, replay, shared
from export.models import ACCEPTED, NAMES
from hypothesis import HealthCheck, given, settings
from strategies import models

import hysdel_py as hys
from hysdel_py.export.plant_c import STATUS, to_c
from hysdel_py.export.plant_points import is_clear, random_vector, violated


class Plant:
    """A written plant that Python calls."""

    def __init__(self, model, path):
        self.code, self.dha = hys.to_c(model, path), model.dha
        self.function = getattr(ctypes.CDLL(str(shared(path))), f"{self.code.prefix}_step")

    def __call__(self, x, u):
        dha = self.dha
        arrays = [(ctypes.c_double * max(1, len(v)))(*v) for v in (x, u)]
        arrays += [(ctypes.c_double * max(1, len(g)))(*[77.0] * len(g)) for g in (dha.x, dha.y, dha.d, dha.z)]
        status = self.function(*arrays)
        groups = (dha.x, dha.y, dha.d, dha.z)
        return status, [list(a)[: len(g)] for a, g in zip(arrays[2:], groups, strict=True)]


def compare(model, path, count, seed=0):
    plant, rng = Plant(model, path), np.random.default_rng(seed)
    compared = 0
    for _ in range(count):
        x, u = random_vector(model.dha.x, rng), random_vector(model.dha.u, rng)
        expected = model.dha.step(x, u, check=False)
        if not is_clear(model.dha, x, u, *expected[2:]):
            continue
        compared += 1
        status, found = plant(x, u)
        assert status == sum(STATUS[bit] for bit in violated(model.dha, x, u))
        for ours, theirs in zip(found, expected, strict=True):
            assert ours == pytest.approx(theirs.tolist(), rel=1e-12, abs=1e-12)
    return compared


@needs_gcc
@pytest.mark.parametrize("accepted", ACCEPTED[::3], ids=NAMES[::3])
def test_corpus_models_step_alike(tmp_path, accepted):
    compare(accepted.model(), tmp_path / "plant.c", 60)


@needs_gcc
@pytest.mark.parametrize("name", hys.shipped_models())
def test_shipped_models_step_alike_and_pass_their_own_test(tmp_path, name):
    model = hys.load(name)
    assert compare(model, tmp_path / "plant.c", 200) > 100
    result = replay(tmp_path / "plant.c", "plant")
    assert result.returncode == 0
    assert "0 of 50 steps differ" in result.stdout


@needs_gcc
@settings(max_examples=8, deadline=None, suppress_health_check=list(HealthCheck))
@given(text=models())
def test_random_models_step_alike(tmp_path, text):
    model = hys.load(text)
    path = tmp_path / f"plant{abs(hash(text))}.c"  # a library is loaded once for each name
    compare(model, path, 20)


@needs_gcc
def test_the_self_test_notices_a_wrong_number(tmp_path):
    to_c(hys.load("clutch"), tmp_path / "plant.c")
    text = (tmp_path / "plant.c").read_text()
    (tmp_path / "plant.c").write_text(text.replace("next[0] = ", "next[0] = 1e-6 + ", 1))
    assert replay(tmp_path / "plant.c", "plant").returncode == 1
    (tmp_path / "plant.c").write_text(text.replace("status |= PLANT_STATE_RANGE", "status |= 0", 1))
    assert replay(tmp_path / "plant.c", "plant").returncode == 1


@needs_gcc
def test_what_is_no_number_and_no_boolean_is_invalid(tmp_path):
    text = """SYSTEM s { INTERFACE { STATE { REAL a [0, 1]; BOOL b; } INPUT { REAL v [0, 1]; } }
      IMPLEMENTATION { CONTINUOUS { a = v; } AUTOMATA { b = ~b; } MUST { a + v <= 1; b; } } }"""
    plant = Plant(hys.load(text), tmp_path / "plant.c")
    nothing = [[77.0, 77.0], [], [], []]
    for x, u in (([np.nan, 0], [0]), ([0, np.inf], [0]), ([0, 0.5], [0]), ([0, 1], [-np.inf])):
        status, values = plant(x, u)
        assert status == STATUS["INVALID"]
        assert values == nothing
    assert plant([0.5, 1], [0.25]) == (0, [[0.25, 0.0], [], [], []])
    assert plant([0.5, 0], [0.25])[0] == STATUS["MUST"]
    assert plant([0.5, 1], [0.75])[0] == STATUS["MUST"]
    assert plant([1.5, 0], [2.0])[0] == STATUS["MUST"] | STATUS["STATE_RANGE"] | STATUS["INPUT_RANGE"]


def test_names_ranges_and_units_are_told(tmp_path):
    code = hys.to_c(hys.load("clutch"), tmp_path / "clutch.c")
    header = code.files[1].read_text()
    for text in ("x[0]: we [rad/s]", "int clutch_step(const double *x", "CLUTCH_MUST 4", "#define CLUTCH_STATES 5"):
        assert text in header
    before = [file.read_bytes() for file in code.files]
    assert [file.read_bytes() for file in hys.to_c(hys.load("clutch"), tmp_path / "clutch.c").files] == before


def test_loops_undefined_names_and_wrong_paths_are_refused(tmp_path):
    loop = (
        "SYSTEM s { INTERFACE { STATE { BOOL b; } } IMPLEMENTATION { AUX { BOOL d, e; }"
        " LOGIC { d = e; e = d; } AUTOMATA { b = d; } } }"
    )
    with pytest.raises(hys.CompileError, match="HYS505"):
        hys.to_c(hys.load(loop), tmp_path / "s.c")
    with pytest.raises(hys.ArgumentError, match="depend on themselves"):
        hys.to_c(hys.load(loop).dha, tmp_path / "s.c")
    with pytest.raises(hys.ArgumentError, match=r"ends in \.c"):
        hys.to_c(hys.load("clutch"), tmp_path / "clutch.h")


@needs_gcc
def test_deep_logic_is_written_flat(tmp_path):
    nested = "a"
    for _ in range(300):
        nested = f"~({nested} & b)"
    model = hys.load(
        f"SYSTEM s {{ INTERFACE {{ STATE {{ BOOL a, b; }} }} IMPLEMENTATION {{ AUX {{ BOOL d; }}"
        f" LOGIC {{ d = {nested}; }} AUTOMATA {{ a = d; b = b; }} }} }}"
    )
    assert compare(model, tmp_path / "plant.c", 20) == 20


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_the_command_writes_c(tmp_path, capsys):
    from hysdel_py.cli.main import main

    assert main(["compile", "two_tanks", "-o", str(tmp_path / "tanks.c")]) == 0
    assert "tanks.c: " in capsys.readouterr().out
    assert replay(tmp_path / "tanks.c", "tanks").returncode == 0
    assert subprocess.run([str(tmp_path / "tanks.out")], capture_output=True, check=False).returncode == 0
