"""``hysdel explicit``: parameters, summary, files and exit statuses."""

import json

import pytest

from hysdel_py.control.hybrid_law import HybridLaw

TANK = ("explicit", "tank.hys", "--horizon", "1", "--samples", "10")
TO_THREE = (*TANK, "--weight", "y=1", "--ref", "y=3")


def test_summary_and_file(hysdel, tmp_path):
    shown = hysdel(*TO_THREE, "--out", str(tmp_path / "law.npz"))
    assert (shown.status, shown.err) == (0, "")
    assert "complete\n" in shown.out
    assert "certificate holds: 10 random points" in shown.out
    law = HybridLaw.load(tmp_path / "law.npz")
    assert law.complete
    assert "r(y) = 3 (fixed)" in shown.out


def test_code_is_written(hysdel, tmp_path):
    shown = hysdel(*TO_THREE, "--c", str(tmp_path / "law.c"), "--python", str(tmp_path / "law.py"))
    assert (shown.status, shown.err) == (0, "")
    assert "int law(const double zeta[" in (tmp_path / "law.h").read_text()
    namespace = {}
    exec((tmp_path / "law.py").read_text(), namespace)
    assert len(namespace["law"]([0.0] * len(namespace["PARAMETERS"]))) > 0


def test_box_of_a_reference_and_json(hysdel):
    shown = hysdel(*TANK, "--weight", "y=1", "--box", "r(y)=-1:3", "--json")
    summary = json.loads(shown.out)
    assert "r(y)" in summary["parameters"]
    assert summary["complete"] is True
    assert summary["certificate"]["holds"] is True
    assert shown.status == 0


def test_description_has_rows_and_moves(hysdel):
    assert "move 0 = " in hysdel(*TO_THREE, "--describe").out


def test_an_incomplete_law_is_status_one(hysdel):
    shown = hysdel(*TO_THREE, "--time-limit", "1e-9", "--json")
    assert shown.status == 1
    assert json.loads(shown.out)["complete"] is False


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (TANK, "--weight is missing"),
        ((*TO_THREE, "--box", "nothing=0:1"), "nothing is no parameter"),
        ((*TO_THREE, "--box", "r(y)=0:1"), "has a box and is fixed"),
        ((*TO_THREE, "--workers", "0"), "--workers is 0"),
        ((*TO_THREE, "--out", "/no/such/folder/law.npz"), "there is no folder"),
        ((*TO_THREE, "--c", "law.txt"), "ends in .c"),
        ((*TO_THREE, "--time-limit", "-1"), "--time-limit is -1"),
    ],
)
def test_wrong_usage(hysdel, arguments, message):
    shown = hysdel(*arguments)
    assert shown.status == 2
    assert message in shown.err


def test_pictures_and_tables_are_written(hysdel, tmp_path):
    shown = hysdel(*TO_THREE, "--plot", str(tmp_path / "law.png"), "--latex", str(tmp_path / "law.tex"))
    assert (shown.status, shown.err) == (0, "")
    assert (tmp_path / "law.png").read_bytes().startswith(b"\x89PNG")
    assert r"\paragraph{Sequence 0}" in (tmp_path / "law.tex").read_text()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--section", "h=1"), "add --plot FILE.png"),
        (("--plot", "law.doc"), ".png"),
        (("--plot", "law.png", "--section", "q=1"), "no free parameter"),
        (("--latex", "nowhere/law.tex"), "nowhere"),
    ],
)
def test_what_cannot_be_drawn_is_said(hysdel, options, words):
    shown = hysdel(*TO_THREE, *options)
    assert shown.status != 0
    assert words in shown.err
