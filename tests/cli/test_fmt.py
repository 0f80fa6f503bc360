"""The command that lays models out."""

import io
import sys

import pytest

from hysdel_py.syntax.formatter import format_text

MESSY = "SYSTEM s{INTERFACE{STATE{REAL x[0,1];}}IMPLEMENTATION{CONTINUOUS{x=x;}}}"
CLEAN = format_text(MESSY)


@pytest.fixture
def messy(tmp_path):
    path = tmp_path / "messy.hys"
    path.write_text(MESSY, encoding="utf-8")
    return path


def test_rewrites(hysdel, messy):
    shown = hysdel("fmt", "messy.hys")
    assert (shown.status, shown.out, shown.err) == (0, "", "messy.hys: formatted\n")
    assert messy.read_text(encoding="utf-8") == CLEAN
    shown = hysdel("fmt", "messy.hys")
    assert (shown.status, shown.out, shown.err) == (0, "", "")


def test_check(hysdel, messy, tmp_path):
    shown = hysdel("fmt", "--check", "messy.hys")
    assert (shown.status, shown.err) == (1, "messy.hys would change\n")
    assert messy.read_text(encoding="utf-8") == MESSY
    (tmp_path / "clean.hys").write_text(CLEAN, encoding="utf-8")
    assert hysdel("fmt", "--check", "clean.hys").status == 0
    assert hysdel("fmt", "--check", "clean.hys", "messy.hys").status == 1


def test_diff(hysdel, messy):
    shown = hysdel("fmt", "--diff", "messy.hys")
    assert shown.status == 0
    assert shown.out.startswith("--- messy.hys\n+++ messy.hys (formatted)\n")
    assert "\n+      REAL x [0, 1];\n" in shown.out
    assert messy.read_text(encoding="utf-8") == MESSY
    assert hysdel("fmt", "--diff", "--check", "messy.hys").status == 1


def test_standard_input(hysdel, monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.StringIO(MESSY))
    shown = hysdel("fmt", "-")
    assert (shown.status, shown.out, shown.err) == (0, CLEAN, "")
    shown = hysdel("fmt", "-", "messy.hys")
    assert shown.status == 2
    assert "standard input" in shown.err


def test_mistakes_leave_the_file_alone(hysdel, messy, tmp_path):
    wrong = tmp_path / "wrong.hys"
    wrong.write_text("SYSTEM s {INTERFACE{STATE{REAL x[0,1]}}}", encoding="utf-8")
    shown = hysdel("fmt", "wrong.hys", "messy.hys")
    assert shown.status == 1
    assert "error[HYS102]" in shown.err
    assert "wrong.hys:1:38" in shown.err
    assert wrong.read_text(encoding="utf-8") == "SYSTEM s {INTERFACE{STATE{REAL x[0,1]}}}"
    assert messy.read_text(encoding="utf-8") == CLEAN


def test_file_that_is_not_there(hysdel):
    shown = hysdel("fmt", "nothing.hys")
    assert shown.status == 1
    assert "cannot read nothing.hys" in shown.err


@pytest.mark.parametrize(
    ("encoding", "comment"), [("utf-8", "/* Größe */"), ("utf-8-sig", "/* Größe */"), ("latin-1", "/* Größe */")]
)
def test_the_encoding_stays(hysdel, tmp_path, encoding, comment):
    path = tmp_path / "coded.hys"
    path.write_bytes((comment + MESSY).encode(encoding))
    assert hysdel("fmt", "coded.hys").status == 0
    assert path.read_bytes() == (f"{comment}\n{CLEAN}").encode(encoding)
