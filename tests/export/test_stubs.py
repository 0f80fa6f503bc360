"""Names of a model as Python types: they run, and a type checker tells right from wrong names."""

import sys

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.cli.stubs import stubs_of
from hysdel_py.export.stubs import Field, stub_module

TEXT = """SYSTEM two_parts {
  INTERFACE {
    STATE { BOOL open; /* valve "a\\b" */ REAL level [0, 9]; /* [m] height */ REAL lambda [0, 1], count [0, 1]; }
    INPUT { REAL pump [0, 1]; }
    PARAMETER { REAL area = 2; /* [m^2] */ REAL gain; BOOL on = TRUE; }
  }
  IMPLEMENTATION { CONTINUOUS { level = level + gain*pump/area; lambda = 0; count = 0; } AUTOMATA { open = open; } }
}
"""


def loaded(text):
    namespace = {}
    exec(compile(text, "stubs", "exec"), namespace)
    return namespace


def test_values_are_vectors():
    model = hys.load(TEXT, gain=1)
    names = loaded(stubs_of(model.typed))
    start = names["TwoPartsState"](level=1.0, lambda_=0.0, count_=0.5, open=True)
    x1, *_ = model.dha.step(start, names["TwoPartsInput"](pump=0.5))
    assert names["TwoPartsState"](*x1).level == 1.25
    np.testing.assert_array_equal(start, [1, 0, 0.5, 1])
    assert names["TwoPartsOutput"]._fields == ()
    assert names["TwoPartsParameters"].__required_keys__ == {"gain"}


def test_units_and_descriptions_are_told():
    text = stubs_of(hys.load(TEXT).typed)
    assert '    level: float\n    """height [m]"""\n' in text
    assert '    area: float\n    """[m^2]"""\n' in text
    assert "valve 'a\\\\b'" in text


def test_parameters_that_are_words_of_python():
    text = stub_module("s", {}, [Field("lambda"), Field("b", is_bool=True, required=False)])
    dictionary = loaded(text)["SParameters"]
    assert dictionary.__required_keys__ == {"lambda"}
    assert dictionary.__optional_keys__ == {"b"}


def test_names_that_clash_get_more_underscores():
    text = stub_module("s", {"State": [Field("in"), Field("in_")]}, [])
    assert loaded(text)["SState"]._fields == ("in__", "in_")


@pytest.mark.parametrize("name", hys.shipped_models() if hasattr(hys, "shipped_models") else ["clutch", "two_tanks"])
def test_shipped_models(name):
    assert loaded(stubs_of(hys.load(name).typed))


def test_elements_are_fields_and_matrices_are_given_as_a_whole():
    model = hys.load("three_tanks")
    text = stubs_of(model.typed)
    assert '    level_2: float\n    """level(2): level [dm]"""\n' in text
    assert "    pumps: Sequence[Sequence[float]]\n" in text
    names = loaded(text)
    start = names["ThreeTanksState"](h_1=1, h_2=2, h_3=3)
    inputs = names["ThreeTanksInput"](q_1=0.0, q_2=0.0, open_1=False, open_2=False)
    _, y, *_ = model.dha.step(start, inputs)
    assert names["ThreeTanksOutput"](*y).level_2 == 2
    hys.load("three_tanks", **names["ThreeTanksParameters"](pumps=[[1, 0], [0, 1], [0, 0]]))


def test_names_of_elements_and_of_modules_clash_with_nothing():
    fields = [Field(name) for name in ("W(1)", "W_1", "t1.W", "t1_W", "W(1,1)", "in")]
    assert loaded(stub_module("s", {"State": fields}, fields))["SState"]._fields == (
        "W_1_", "W_1", "t1_W_", "t1_W", "W_1_1", "in_",
    )  # fmt: skip


RIGHT = """
from names import TwoPartsInput, TwoPartsParameters, TwoPartsState
state = TwoPartsState(level=1.0, lambda_=0.0, count_=0, open=True)
level: float = state.level
parameters: TwoPartsParameters = {"gain": 2.0, "on": False}
inputs: list[TwoPartsInput] = [TwoPartsInput(0.5)]
"""
WRONG = {
    "misspelt state": "from names import TwoPartsState\nTwoPartsState(levle=1.0, lambda_=0, count_=0, open=True)",
    "misspelt attribute": "from names import TwoPartsInput\nTwoPartsInput(1).pmup",
    "missing state": "from names import TwoPartsState\nTwoPartsState(level=1.0)",
    "wrong type": "from names import TwoPartsState\nTwoPartsState(level='1', lambda_=0, count_=0, open=True)",
    "misspelt parameter": "from names import TwoPartsParameters\np: TwoPartsParameters = {'gain': 1, 'aera': 2}",
    "missing parameter": "from names import TwoPartsParameters\np: TwoPartsParameters = {'area': 2}",
}


def test_type_checker_tells_right_from_wrong(tmp_path, monkeypatch):
    api = pytest.importorskip("mypy.api", reason="mypy is not installed")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "names.py").write_text(stubs_of(hys.load(TEXT).typed), encoding="utf-8")
    (tmp_path / "right.py").write_text(RIGHT, encoding="utf-8")
    files = []
    for number, code in enumerate(WRONG.values()):
        files.append(f"wrong{number}.py")
        (tmp_path / files[-1]).write_text(code + "\n", encoding="utf-8")
    version = f"{sys.version_info[0]}.{sys.version_info[1]}"
    out, err, _ = api.run(["--strict", "--no-incremental", "--python-version", version, "names.py", "right.py", *files])
    assert not err
    assert not [line for line in out.splitlines() if line.startswith(("names.py", "right.py"))], out
    assert [name for name in files if f"{name}:2: error" not in out] == [], out
