"""Matrix parameters and folders of modules on the command line."""

import pytest

from hysdel_py.cli.arguments import parameter_values
from hysdel_py.errors import ArgumentError

MODEL = """SYSTEM m { INTERFACE { PARAMETER { REAL A(2,2), k, b(2); } STATE { REAL x(2) [-9, 9]; } }
  IMPLEMENTATION { CONTINUOUS { x = k*A*x + b; } } }"""


def test_values():
    found = parameter_values(["A=[1,0.1;0,-1], k=2, W(2,1)=3", "b=[1;2]", "c=[7]"], "--param")
    assert found == {"A": [[1, 0.1], [0, -1]], "k": 2, "W(2,1)": 3, "b": [[1], [2]], "c": [[7]]}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("A=[1,2;3]", r"--param A has rows of 2 and 1 numbers"),
        ("A=[1,x]", r"--param A is 'x': a number was expected"),
        ("A=[1,2", r"--param A is '\[1': a matrix such as \[1,0.1;0,1\] was expected"),
        ("A=[]", r"--param A is '': a number was expected"),
    ],
)
def test_mistakes(text, message):
    with pytest.raises(ArgumentError, match=message):
        parameter_values([text], "--param")


def test_matrices_reach_the_model(hysdel, tmp_path):
    (tmp_path / "m.hys").write_text(MODEL)
    data = hysdel("compile", "m.hys", "--param", "A=[1,2;3,4],k=0.5", "--param", "b=[5;6]", "--json").json
    assert data["A"] == [[0.5, 1], [1.5, 2]]
    assert data["B5"] == [5, 6]
    wrong = hysdel("check", "m.hys", "--param", "A=[1,2],k=1,b=[5;6]")
    assert wrong.status == 1
    assert "the parameter A is 2-by-2 and was given 1-by-2" in wrong.err


@pytest.fixture
def whole(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "lag.hys").write_text(
        "SYSTEM lag { INTERFACE { STATE { REAL s [0, 1]; } OUTPUT { REAL q; } }"
        " IMPLEMENTATION { CONTINUOUS { s = 0.5*s; } OUTPUT { q = s; } } }"
    )
    (tmp_path / "whole.hys").write_text(
        "SYSTEM whole { INTERFACE { MODULE { lag a; } OUTPUT { REAL y; } } IMPLEMENTATION { OUTPUT { y = a.q; } } }"
    )


@pytest.mark.usefixtures("whole")
@pytest.mark.parametrize("command", [("check",), ("compile",), ("simulate", "--x0", "1", "--steps", "2"), ("stubs",)])
def test_folder_of_modules(hysdel, command):
    name, *more = command
    assert hysdel(name, "whole.hys", *more).status == 1
    assert hysdel(name, "whole.hys", *more, "-I", "parts").status == 0
    assert hysdel(name, "whole.hys", *more, "--search-path", ".", "--search-path", "parts").status == 0


@pytest.mark.usefixtures("whole")
def test_folder_that_does_not_exist(hysdel):
    shown = hysdel("check", "whole.hys", "-I", "prats")
    assert shown.status == 2
    assert "--search-path prats: there is no such folder" in shown.err
