"""Laws as JSON, as Python and as LaTeX."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from dataclasses import fields, replace

import numpy as np
import pytest
from export.laws import inner_region, saturation, solved, without

import hysdel_py as hys
from hysdel_py.control.explicit_certificate import random_points
from hysdel_py.export.law_json import law_from_dict, law_to_dict
from hysdel_py.export.law_points import far_from_borders


def same(first, second):
    for item in fields(first):
        one, other = getattr(first, item.name), getattr(second, item.name)
        if item.name == "domain":
            assert np.array_equal(one.A, other.A)
            assert np.array_equal(one.b, other.b)
        elif item.name == "objective":
            assert (one and one.to_dict()) == (other and other.to_dict())
        elif isinstance(one, np.ndarray):
            assert one.shape == other.shape
            assert one.dtype == other.dtype
            assert np.array_equal(one, other)
        else:
            assert one == other


@pytest.mark.parametrize("merged", [False, True])
@pytest.mark.parametrize("name", ["a_di_N3", "c_pend_N3"])
def test_a_json_file_is_read_back_equal(tmp_path, name, merged):
    law = solved(name).merged() if merged else solved(name)
    law.to_json(tmp_path / "law.json")
    same(hys.ExplicitLaw.from_json(tmp_path / "law.json"), law)
    data = json.loads((tmp_path / "law.json").read_text())
    assert data["parameters"] == list(law.names)
    assert len(data["regions"]) == law.count


@pytest.mark.parametrize(
    "harm",
    [
        lambda data: data.pop("moves"),
        lambda data: data["regions"][0].pop("K"),
        lambda data: data["regions"][1]["b"].append(1.0),
        lambda data: data["regions"][0]["A"][0].append(1.0),
        lambda data: data["regions"][0].update(r="none"),
        lambda data: data["regions"][0]["k"].__setitem__(0, float("nan")),
        lambda data: data.update(schema="something else"),
        lambda data: data.update(moves=99),
    ],
)
def test_damaged_data_is_refused(harm):
    data = json.loads(json.dumps(law_to_dict(solved("a_di_N3"))))
    harm(data)
    with pytest.raises(hys.ArgumentError):
        law_from_dict(data)


@pytest.mark.parametrize("method", ["tree", "sequential"])
@pytest.mark.parametrize("holed", [False, True])
def test_the_python_file_gives_the_same_moves(tmp_path, method, holed):
    law = solved("a_di_N3")
    law = without(law, inner_region(law)) if holed else law
    path = law.to_python(tmp_path / "law.py", method=method)
    module: dict = {}
    exec(path.read_text(), module)
    points = random_points(law, 200, np.random.default_rng(2)) * 1.2
    points = points[far_from_borders(law, points, 1e-6)]
    kinds = set()
    for point in points:
        expected, move = law(point), module["law"](point.tolist())
        kinds.add(expected is None)
        assert (move is None) == (expected is None)
        assert move is None or move == pytest.approx(expected, abs=1e-12)
    assert kinds == {True, False}
    assert module["law"]({"x1": 0.5, "x2": 0.1}) == module["law"]([0.5, 0.1])
    assert module["law"]([float("nan"), 0.0]) is None
    for wrong in ([1.0], {"x1": 1.0}):
        with pytest.raises(ValueError, match="x1, x2"):
            module["law"](wrong)


def test_the_python_file_needs_nothing(tmp_path):
    saturation().to_python(tmp_path / "law.py")
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import law; print(law.law([2.0]), law.law([4.0]))"
    answer = subprocess.run([sys.executable, "-I", "-S", "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout == "[-1.0] None\n"


def test_the_table_names_every_region_row_and_move(tmp_path):
    law = saturation()
    text = law.to_latex(tmp_path / "law.tex", digits=3, moves=("torque_1",))
    assert (tmp_path / "law.tex").read_text() == text
    rows = re.findall(r"^(\d+) & ", text, flags=re.MULTILINE)
    assert rows == ["0", "1", "2"]
    assert text.count(r"\le") == len(law.b)
    assert text.count(r"\text{torque\_1} &=") == law.count
    assert r"\text{torque\_1} &= -x" in text
    assert r"x &\le 1" in text


def test_the_table_is_balanced():
    text = solved("f_thesis").to_latex(digits=3)
    for name in ("document", "longtable"):
        assert text.count(rf"\begin{{{name}}}") == text.count(rf"\end{{{name}}}") == 1
    assert text.count(r"\begin{aligned}") == text.count(r"\end{aligned}") == 2 * 21
    assert text.count("{") == text.count("}")
    assert text.count("$") % 2 == 0
    body = [line for line in text.splitlines() if re.match(r"\d+ & ", line)]
    assert all(re.sub(r"\$.*?\$", "", line).count("&") == 2 and line.endswith(r"\\") for line in body)


def test_digits_and_names_are_checked():
    law = saturation()
    third = replace(law, k=law.k / 3.0)
    assert "0.333 " in third.to_latex(digits=3)
    assert "0.3333333 " in third.to_latex(digits=7)
    for options in ({"digits": 0}, {"moves": ("a", "b")}, {"moves": "ab"}):
        with pytest.raises(hys.ArgumentError):
            law.to_latex(**options)


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="pdflatex is not installed")
def test_the_table_compiles(tmp_path):
    solved("f_thesis").to_latex(tmp_path / "law.tex", digits=3)
    subprocess.run(["pdflatex", "-interaction=batchmode", "-halt-on-error", "law.tex"], cwd=tmp_path, check=True)
