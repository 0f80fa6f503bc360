"""``hysdel simulate``: states and inputs from the command line and from files, and what is written."""

import csv
import sys

import pytest

START = ("simulate", "tank.hys", "--x0", "1,0")


def levels(shown):
    return [row["level"] for row in shown.rows]


def test_constant_input(hysdel):
    shown = hysdel(*START, "--input", "0.5,1", "--steps", "3")
    assert (shown.status, shown.err) == (0, "")
    assert levels(shown) == [1, 1.5, 2]
    assert [row["t"] for row in shown.rows] == [0, 0.5, 1]
    assert shown.out.splitlines()[0].split() == ["t", "level", "was_open", "flow", "open", "y", "inflow"]


@pytest.mark.parametrize(
    "arguments",
    [
        ["--x0", "-2,1", "--input", "-1,1"],
        ["--x0=-2,1", "--input=-1,1"],
        ["--x0", "was_open=true, level=-2", "--input", "open=1,flow=-1"],
        ["--x0", " -2, 1 ", "--input", "flow=-1,open=TRUE"],
    ],
)
def test_order_names_and_negative_numbers(hysdel, arguments):
    shown = hysdel("simulate", "tank.hys", *arguments, "--steps", "2")
    assert (shown.status, shown.err) == (0, "")
    assert levels(shown) == [-2, -3]


def test_names_of_elements_hold_commas(hysdel, tmp_path):
    (tmp_path / "matrix.hys").write_text(
        "SYSTEM matrix { INTERFACE { STATE { REAL W(2, 2) [0, 9], level(2) [0, 9]; } }"
        " IMPLEMENTATION { CONTINUOUS { W = 2*W; level = level; } } }"
    )
    start = "W(2,1)=1, level(2)=0.5,W(1,1)=0,W(1,2)=2,W(2,2)=0,level(1)=3"
    shown = hysdel("simulate", str(tmp_path / "matrix.hys"), "--x0", start, "--steps", "2")
    assert (shown.status, shown.err) == (0, "")
    assert [row["W(2,1)"] for row in shown.rows] == [1, 2]
    assert [row["level(2)"] for row in shown.rows] == [0.5, 0.5]
    weighted = ("--weight", "W(2,1)=1,level(2)=2", "--horizon", "1", "--steps", "1")
    assert hysdel("mpc", str(tmp_path / "matrix.hys"), "--x0", start, *weighted).status == 0


def test_default_is_twenty_steps(hysdel):
    assert len(hysdel(*START, "--input", "0,1").rows) == 20


def test_no_steps_at_all(hysdel):
    shown = hysdel(*START, "--input", "0,1", "--steps", "0")
    assert shown.status == 0
    assert shown.rows == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--input", "0,1"], "--x0 is missing: the state is level, was_open, as in --x0 level=0,was_open=0"),
        (["--x0", "1,0"], "--input is missing: give a constant one, as in --input flow=0,open=0, or --inputs CSV"),
        (["--x0", "1", "--input", "0,1"], "--x0 has 1 number: 2 were expected, in the order level, was_open"),
        (["--x0", "1,0,0", "--input", "0,1"], "--x0 has 3 numbers: 2 were expected"),
        (["--x0", "1,,0", "--input", "0,1"], "--x0 is '': a number was expected"),
        (["--x0", "1,zero", "--input", "0,1"], "--x0 is 'zero': a number was expected"),
        (["--x0", "level=1", "--input", "0,1"], "--x0: no value for the state was_open"),
        (["--x0", "level=1,was_open=0,lid=1", "--input", "0,1"], "--x0: there is no state named lid"),
        (["--x0", "level=1,level=2,was_open=0", "--input", "0,1"], "--x0 level is given twice"),
        (["--x0", "level=1,0", "--input", "0,1"], "--x0 0: NAME=VALUE was expected"),
        (["--x0", "1,0.5", "--input", "0,1"], "state was_open is 0.5: it is Boolean, 0 or 1 was expected"),
        (["--x0", "nan,0", "--input", "0,1"], "state level is nan: a finite number was expected"),
        (["--x0", "1,0", "--input", "0,2"], "--input: input open is 2: it is Boolean"),
        (["--x0", "1,0", "--input", "0,1", "--steps", "-1"], "--steps is -1: zero or more was expected"),
    ],
)
def test_wrong_vectors(hysdel, arguments, words):
    shown = hysdel("simulate", "tank.hys", *arguments)
    assert shown.status == 2
    assert words in shown.err
    assert shown.out == ""


def test_leaving_a_range_names_step_variable_and_the_way_on(hysdel):
    shown = hysdel("simulate", "tank.hys", "--x0", "9,0", "--input", "1,1")
    assert shown.status == 1
    assert "step 2: state level = 11 is outside its range [-5, 10] (declared in line 4)" in shown.err
    assert "or go on all the same with --no-check" in shown.err


def test_no_check_goes_on(hysdel):
    shown = hysdel("simulate", "tank.hys", "--x0", "9,0", "--input", "1,1", "--no-check", "--steps", "4")
    assert shown.status == 0
    assert levels(shown) == [9, 10, 11, 12]


def test_step_that_no_option_can_mend_has_no_such_advice(hysdel, tmp_path):
    path = tmp_path / "loop.hys"
    path.write_text(
        "SYSTEM s { INTERFACE { STATE { BOOL b; } } IMPLEMENTATION { AUX { BOOL d, e; } "
        "LOGIC { d = e | b; e = d; } AUTOMATA { b = d; } } }"
    )
    shown = hysdel("simulate", path, "--x0", "0")
    assert shown.status == 1
    assert "algebraic loop" in shown.err
    assert "--no-check" not in shown.err


def test_both_forms_give_the_same_table(hysdel):
    texts = {hysdel(*START, "--input", "-0.25,1", "--form", form).out for form in ("dha", "mld")}
    assert len(texts) == 1


def test_json(hysdel):
    data = hysdel(*START, "--input", "1,1", "--steps", "2", "--json").json
    assert data["x"] == [[1, 0], [2, 1], [3, 1]]
    assert data["names"]["u"] == ["flow", "open"]


def test_model_without_inputs(hysdel, tmp_path):
    path = tmp_path / "free.hys"
    path.write_text("SYSTEM s { INTERFACE { STATE { REAL x [0, 99]; } } IMPLEMENTATION { CONTINUOUS { x = 2*x; } } }")
    shown = hysdel("simulate", path, "--x0", "1", "--steps", "4")
    assert [row["x"] for row in shown.rows] == [1, 2, 4, 8]
    assert "--input has 1 number: none was expected" in hysdel("simulate", path, "--x0", "1", "--input", "0").err


def test_long_table_says_what_it_leaves_out(hysdel):
    shown = hysdel(*START, "--input", "0,1", "--steps", "100")
    assert "... 40 more steps; --csv writes them all ..." in shown.out
    assert len(shown.rows) == 60


INPUT_FILES = {
    "plain": "0.5,1\n1,0\n-1,1\n",
    "with names": "flow,open\n0.5,1\n1,0\n-1,1\n",
    "other order and further columns": "t,open,level,flow\n0,1,9,0.5\n1,0,9,1\n2,1,9,-1\n",
    "spaces, empty lines, byte order mark": "\ufeff flow , open \n\n0.5, 1\n1,0\n\n-1,true\n",
}


@pytest.mark.parametrize("text", INPUT_FILES.values(), ids=INPUT_FILES)
def test_inputs_from_a_file(hysdel, tmp_path, text):
    (tmp_path / "u.csv").write_text(text, encoding="utf-8")
    shown = hysdel(*START, "--inputs", "u.csv")
    assert (shown.status, shown.err) == (0, "")
    assert levels(shown) == [1, 1.5, 1.5]
    assert shown.rows[-1]["inflow"] == -1
    assert levels(hysdel(*START, "--inputs", "u.csv", "--steps", "2")) == [1, 1.5]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"", "u.csv is empty: one line of inputs per step was expected"),
        (b"flow,opened\n1,1\n", "u.csv: no column for the input open; the columns are flow, opened"),
        (b"a,b\n1,1\n", "no column for the input flow, open; the columns are a, b"),
        (b"flow,open,flow\n1,1,1\n", "several columns for the input flow"),
        (b"1,1\n1\n", "u.csv, line 2 has 1 values: 2 were expected (flow, open)"),
        (b"1,1,1\n", "u.csv, line 1 has 3 values: 2 were expected"),
        (b"flow,open\n\n1,x\n", "u.csv, line 3: open is 'x': a number was expected"),
        (b"1,1\n1,0.3\n", "u.csv, line 2: input open is 0.3: it is Boolean"),
        (b"1,1\nnan,1\n", "u.csv, line 2: input flow is nan: a finite number"),
        (b"\xff\xfe1,\x001", "u.csv is not a CSV file"),
        (b"1,1\n1,1\n", "--steps is 5, but u.csv has only 2 lines of inputs"),
    ],
)
def test_files_with_mistakes(hysdel, tmp_path, text, words):
    (tmp_path / "u.csv").write_bytes(text)
    shown = hysdel(*START, "--inputs", "u.csv", "--steps", "5")
    assert shown.status == 1
    assert words in shown.err


def test_file_of_inputs_that_is_not_there(hysdel):
    shown = hysdel(*START, "--inputs", "u.csv")
    assert shown.status == 1
    assert "u.csv: No such file or directory" in shown.err


def test_table_of_a_run_serves_as_inputs_of_the_next(hysdel, tmp_path):
    first = hysdel(*START, "--input", "0.125,1", "--steps", "5", "--csv", "run.csv")
    rows = list(csv.DictReader((tmp_path / "run.csv").open(encoding="utf-8")))
    assert [float(row["level"]) for row in rows] == levels(first)
    assert hysdel(*START, "--inputs", "run.csv").out == first.out


def test_picture(hysdel, tmp_path):
    assert hysdel(*START, "--input", "1,1", "--steps", "3", "--plot", "run.png").status == 0
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("option", "path", "words"),
    [
        ("--plot", "run.doc", "--plot run.doc: a name that ends in .png, .pdf, .svg, .jpg was expected"),
        ("--plot", "nowhere/run.png", "--plot nowhere/run.png: there is no folder nowhere"),
        ("--csv", "nowhere/run.csv", "--csv nowhere/run.csv: there is no folder nowhere"),
        ("--csv", ".", "--csv .: this is a folder"),
    ],
)
def test_files_that_cannot_be_written_are_refused_before_the_run(hysdel, option, path, words):
    shown = hysdel("simulate", "nothing.hys", option, path)
    assert shown.status == 2
    assert words in shown.err


def test_picture_without_matplotlib(hysdel, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    shown = hysdel(*START, "--input", "1,1", "--plot", "run.png")
    assert shown.status == 1
    assert "--plot needs matplotlib, which is not installed: pip install matplotlib" in shown.err
