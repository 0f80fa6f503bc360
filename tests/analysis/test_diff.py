"""Two versions of a model: equal ones are found equal, a changed item is found, shown and blamed."""

import pytest
from hypothesis import HealthCheck, given, settings
from strategies import models

import hysdel_py as hys
from hysdel_py.analysis.report import CheckStatus, VerifyStatus

TEXT = """SYSTEM s {
  INTERFACE { STATE { REAL x [-2, 3]; BOOL b; } INPUT { REAL u [-1, 1]; BOOL v; } OUTPUT { REAL y; BOOL w; } }
  IMPLEMENTATION {
    AUX { BOOL d, e; REAL z, q; }
    AD { d = x + u <= 0.5; }
    LOGIC { e = d & ~v | b; }
    DA { z = {IF e THEN x + 1 ELSE u - 2}; }
    LINEAR { q = z - 2*x; }
    CONTINUOUS { x = 0.5*z; }
    AUTOMATA { b = e -> v; }
    OUTPUT { y = q; w = ~d; }
    MUST { x - u <= 2.5; ~b | ~v; }
  }
}"""


def compared(*changes, **options):
    text = TEXT
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    return hys.diff(hys.load(TEXT), hys.load(text), **options)


def different(report):
    return {check.subject: check for check in report.checks if check.status is CheckStatus.DIFFERENT}


def test_a_model_equals_itself_by_its_items_alone():
    report = compared()
    assert report.status is VerifyStatus.EQUAL
    assert {check.how for check in report.checks} == {"items"}
    assert [check.subject for check in report.checks][:4] == ["x'", "b'", "y", "w"]


@pytest.mark.parametrize(
    "change",
    [
        ("e = d & ~v | b", "e = b | ~(v | ~d)"),
        ("x + u <= 0.5", "2*x + 2*u - 1 <= 0"),
        ("{IF e THEN x + 1 ELSE u - 2}", "{IF ~e THEN u - 2 ELSE x + 1}"),
        ("x = 0.5*z", "x = 0.5*q + x"),
        ("~b | ~v", "~(v & b)"),
    ],
)
def test_another_text_of_the_same_meaning_is_equal(change):
    report = compared(change)
    assert report.status is VerifyStatus.EQUAL, str(report)
    assert "model" in {check.how for check in report.checks}


def test_changed_threshold_is_blamed():
    report = compared(("x + u <= 0.5", "x + u <= 0.7"))
    assert report.status is VerifyStatus.DIFFERENT
    check = different(report)["w"]
    values = dict(check.witness.x) | dict(check.witness.u)
    assert 0.5 < values["x"] + values["u"] <= 0.7
    assert "w" in check.witness.differing
    blamed = check.responsible[0]
    assert (blamed.name, blamed.old.text, blamed.new.text) == ("d", "d = x + u <= 0.5", "d = x + u <= 0.7")
    assert (blamed.old.line, len(check.responsible)) == (5, 1)
    shown = str(report)
    assert "d is where they part" in shown
    assert "line 5: d = x + u <= 0.7" in shown


def test_witness_stands_when_stepped():
    report = compared(("x = 0.5*z", "x = 0.5*z + 0.01*u"))
    (check,) = different(report).values()
    assert check.subject == "x'"
    x, u = dict(check.witness.x), dict(check.witness.u)
    old, new = hys.load(TEXT), hys.load(TEXT.replace("x = 0.5*z", "x = 0.5*z + 0.01*u"))
    assert old.dha.step(x, u)[0][0] - new.dha.step(x, u)[0][0] == pytest.approx(-0.01 * u["u"])
    assert check.responsible[0].name == "x"


@pytest.mark.parametrize(
    ("change", "whose"), [(("<= 2.5", "<= 2.4"), "new"), (("<= 2.5", "<= 2.6"), "old"), (("~b | ~v;", "~v;"), "new")]
)
def test_admissibility(change, whose):
    report = compared(change)
    (subject,) = different(report)
    assert subject.startswith(f"MUST of the {whose} model")
    witness = different(report)[subject].witness
    assert (witness.first.exists, witness.second.exists) == (whose == "new", whose == "old")


def test_names_are_reported_first():
    report = compared(
        ("REAL u [-1, 1];", "REAL u [-1, 2]; REAL k [0, 1];"), ("BOOL w;", "REAL w;"), ("w = ~d;", "w = x;")
    )
    assert [str(change) for change in report.names] == [
        "u: REAL input in [-1, 1] in the old model, REAL input in [-1, 2] in the new one",
        "w: BOOL output in the old model, REAL output in the new one",
        "k: only in the new model (REAL input in [0, 1])",
    ]
    assert report.status is VerifyStatus.DIFFERENT
    assert not different(report)
    assert all(check.subject != "w" for check in report.checks)


def test_auxiliaries_may_be_named_otherwise():
    renamed = (
        TEXT.replace("e =", "on =")
        .replace("BOOL d, e;", "BOOL d, on;")
        .replace("IF e", "IF on")
        .replace("e ->", "on ->")
    )
    assert hys.diff(hys.load(TEXT), hys.load(renamed)).status is VerifyStatus.EQUAL


def test_ranges_with_nothing_in_common():
    with pytest.raises(hys.ArgumentError, match="the ranges of x in the two models have nothing in common"):
        compared(("REAL x [-2, 3]", "REAL x [4, 5]"))


def test_time_limit():
    report = compared(("x + u <= 0.5", "2*x + 2*u - 1 <= 0"), seconds=1e-9)
    assert report.status is VerifyStatus.NOT_SETTLED


@settings(max_examples=4, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(models())
def test_rescaled_thresholds_change_nothing(text):
    """Both sides of each threshold are doubled, so that no item is the same and the meaning is."""
    lines = [
        f"      {line.split('=', 1)[0].strip()} = 2*({_sides(line)[0]}) {_sides(line)[1]} 2*({_sides(line)[2]});"
        if line.strip().startswith("d") and _is_threshold(line)
        else line
        for line in text.splitlines()
    ]
    report = hys.diff(hys.load(text), hys.load("\n".join(lines)))
    assert report.status is VerifyStatus.EQUAL, str(report)


def _is_threshold(line):
    return line.count("<=") + line.count(">=") == 1 and not set("&|~!(<") & set(line.split("=", 1)[1].replace("<=", ""))


def _sides(line):
    right = line.split("=", 1)[1].strip().rstrip(";")
    sign = "<=" if "<=" in right else ">="
    left, _, other = right.partition(sign)
    return left.strip(), sign, other.strip()
