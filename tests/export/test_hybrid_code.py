"""Hybrid laws as C, Python and JSON: the region of least value, Boolean parameters, points outside."""

from __future__ import annotations

import ctypes
import re
from functools import cache

import numpy as np
import pytest
from export.compiled_c import needs_gcc, replay, shared

import hysdel_py as hys
from hysdel_py.control.explicit_hybrid import explicit_hybrid
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.export.hybrid_points import answers, random_zeta
from hysdel_py.export.hybrid_table import hybrid_table
from hysdel_py.export.law_number import Number

HEATER = """SYSTEM heater { INTERFACE { STATE { REAL T [-10, 10]; BOOL on; } INPUT { REAL fan [0, 1]; BOOL switch; }
OUTPUT { REAL felt; } }
IMPLEMENTATION { AUX { REAL gain; } DA { gain = { IF on THEN 3 ELSE 0 }; }
CONTINUOUS { T = 0.8*T + gain - fan; } AUTOMATA { on = switch; } OUTPUT { felt = T; } } }"""


@cache
def heater(norm, reduce=True):
    cost = hys.Cost(y={"felt": 1}, u={"switch": 0.5, "fan": 0.2}, norm=norm)
    mpc = hys.HybridMpc(hys.load(HEATER), 3, cost, references=("felt",))
    return explicit_hybrid(mpc, {"T": (-5, 5), "felt": (-2, 2)}, reduce=reduce)


CASES = [(2, True), (1, True), (1, False)]


@needs_gcc
@pytest.mark.parametrize("number", ["double", "float"])
@pytest.mark.parametrize(("norm", "reduce"), CASES)
def test_the_compiled_law_agrees(tmp_path, norm, reduce, number):
    law = heater(norm, reduce)
    code = law.to_c(tmp_path / "law.c", number=number)
    assert replay(code.files[0], "law").returncode == 0
    run = ctypes.CDLL(str(shared(tmp_path / "law.c"))).law
    kind = ctypes.c_double if number == "double" else ctypes.c_float
    zeta = random_zeta(law, 600, np.random.default_rng(2))
    found = answers(hybrid_table(law, Number(number)), zeta)
    seen = set()
    for point in zeta[found.is_clear]:
        expected, u = law(point), (kind * 2)(77, 77)
        status = run((kind * 3)(*point), u)
        seen.add(status)
        assert status == int(expected is None)
        assert list(u) == pytest.approx([77, 77] if expected is None else expected.tolist(), abs=1e-4)
    assert seen == {0, 1}
    assert found.is_clear.sum() > 300


@needs_gcc
def test_what_is_neither_number_nor_boolean_is_outside(tmp_path):
    heater(2).to_c(tmp_path / "law.c")
    run = ctypes.CDLL(str(shared(tmp_path / "law.c"))).law
    for point in ([np.nan, 0, 0], [0, 0.5, 0], [0, np.nan, 0], [0, 1, np.inf], [0, 2, 0]):
        assert run((ctypes.c_double * 3)(*point), (ctypes.c_double * 2)()) == 1


@needs_gcc
def test_the_self_test_notices_wrong_values(tmp_path):
    code = heater(2, False).to_c(tmp_path / "law.c", points=60)
    assert replay(code.files[0], "law").returncode == 0
    text = code.files[0].read_text()
    values = re.search(r"values\[\d+\]\[\d+\] = \{(.*?)\n\};", text, flags=re.DOTALL)
    code.files[0].write_text(text.replace(values[1], re.sub(r"-?\d[\w.+-]*", "0", values[1])))
    assert replay(code.files[0], "law").returncode == 1


@pytest.mark.parametrize(("norm", "reduce"), CASES)
def test_the_python_file_gives_the_same_moves(tmp_path, norm, reduce):
    law = heater(norm, reduce)
    namespace = {}
    exec(law.to_python(tmp_path / "law.py").read_text(), namespace)
    zeta = random_zeta(law, 300, np.random.default_rng(4))
    clear = answers(hybrid_table(law, Number.DOUBLE), zeta).is_clear
    for point in zeta[clear]:
        expected, move = law(point), namespace["law"](dict(zip(law.names, point.tolist(), strict=True)))
        assert (move is None) == (expected is None)
        assert move is None or move == pytest.approx(expected.tolist(), abs=1e-9)
    assert namespace["law"]([0.0, 0.5, 0.0]) is None


def test_json_gives_an_equal_law(tmp_path):
    law = heater(2)
    law.to_json(tmp_path / "law.json")
    again = HybridLaw.from_json(tmp_path / "law.json")
    assert again.describe(True) == law.describe(True)
    for one, other in zip(again.sequences, law.sequences, strict=True):
        assert np.array_equal(one.law.A, other.law.A)
        assert np.array_equal(one.law.P, other.law.P)
    (tmp_path / "odd.json").write_text('{"schema": "else"}')
    with pytest.raises(hys.ArgumentError, match="explicit hybrid law 1"):
        HybridLaw.from_json(tmp_path / "odd.json")


def test_fixed_point_is_refused(tmp_path):
    with pytest.raises(hys.ArgumentError, match="double or float"):
        heater(2).to_c(tmp_path / "law.c", number="int16")
