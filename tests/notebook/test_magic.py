"""The cell magic: what it compiles, what it refuses, and the notebook of the documentation."""

from pathlib import Path

import pytest

from hysdel_py.errors import ArgumentError, CompileError
from hysdel_py.notebook.magic import compile_cell

NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))
CELL = """SYSTEM s {
  INTERFACE { STATE { REAL x [0, 1]; } PARAMETER { REAL a; } }
  IMPLEMENTATION { CONTINUOUS { x = a*x; } }
}
"""
SECONDS = 600
"""For one cell: the first controller of a machine compiles its kernels."""


def test_name_and_parameters():
    name, model = compile_cell("leak --param a=0.5", CELL)
    assert name == "leak"
    assert model.dha.step([1.0])[0].tolist() == [0.5]
    assert compile_cell("", CELL)[0] == "model"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("two words", "unrecognized arguments: words"),
        ("--fast", "--fast"),
        ("2x", "the name of a variable was expected"),
        ("m --param a", "NAME=VALUE was expected"),
    ],
)
def test_wrong_options(line, words):
    with pytest.raises(ArgumentError, match=words):
        compile_cell(line, CELL)


def test_mistakes_are_diagnostics():
    with pytest.raises(CompileError, match=r"HYS201.*\n.*:3:37"):
        compile_cell("", CELL.replace("a*x", "b*x"))


@pytest.fixture
def shell():
    interactive = pytest.importorskip(
        "IPython.core.interactiveshell", reason="IPython is not installed: pip install ipython"
    )
    one = interactive.InteractiveShell()
    one.run_line_magic("load_ext", "hysdel_py")
    return one


def test_cell_becomes_a_model(shell):
    assert shell.run_cell(f"%%hysdel leak --param a=0.25\n{CELL}").success
    assert shell.user_ns["leak"].parameters["a"] == 0.25


def test_mistake_shows_its_line_ends_the_cell_and_keeps_the_name(shell, capsys):
    shell.user_ns["leak"] = 1
    assert not shell.run_cell(f"%%hysdel leak\n{CELL.replace('a*x', 'b*x')}").success
    told = capsys.readouterr()
    assert "CONTINUOUS { x = b*x; }" in told.err
    assert "1 mistake in the model above" in told.out + told.err
    assert "Traceback" not in told.out + told.err
    assert shell.user_ns["leak"] == 1


def test_warnings_are_shown(shell):
    dead = CELL.replace("PARAMETER { REAL a; }", "INPUT { REAL unused [0, 1]; }").replace("a*x", "x")
    result = shell.run_cell(f"%%hysdel\n{dead}")
    shown = result.result
    assert shown is not None
    assert "unused" in repr(shown)
    assert shown._repr_html_().startswith("<pre>")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run(path):
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed: pip install nbclient")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed: pip install ipykernel")
    import nbformat

    book = nbformat.read(path, as_version=4)
    nbformat.validate(book)
    assert not any(cell.get("outputs") for cell in book.cells), "notebooks are kept without outputs"
    nbclient.NotebookClient(book, timeout=SECONDS, kernel_name="python3").execute()
    shown = [output for cell in book.cells for output in cell.get("outputs", ())]
    assert sum("text/html" in output.get("data", {}) for output in shown) >= 5
