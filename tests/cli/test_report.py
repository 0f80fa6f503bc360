"""``hysdel report``: pages of models, and of runs that other commands wrote."""

import pytest

RUN = ("simulate", "tank.hys", "--x0", "1,0", "--input", "0.5,1", "--steps", "5")


def test_page_of_a_model(hysdel, tmp_path):
    shown = hysdel("report", "tank.hys")
    assert (shown.status, shown.err) == (0, "")
    assert shown.out.startswith("tank.html: ")
    assert (tmp_path / "tank.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


@pytest.mark.parametrize("command", [["report"], ["audit"], ["verify"], ["show", "--form", "pwa"]])
def test_a_model_of_nothing_has_a_page_and_one_mode(hysdel, tmp_path, command):
    (tmp_path / "empty.hys").write_text("SYSTEM empty { INTERFACE { } IMPLEMENTATION { } }", encoding="utf-8")
    shown = hysdel(command[0], "empty.hys", *command[1:])
    assert (shown.status, shown.err) == (0, "")


@pytest.mark.parametrize("form", ["json", "csv"])
def test_page_of_a_run(hysdel, tmp_path, form):
    shown = hysdel(*RUN, *(["--json"] if form == "json" else ["--csv", "run.csv"]))
    if form == "json":
        (tmp_path / "run.json").write_text(shown.out, encoding="utf-8")
    assert hysdel("report", "tank.hys", f"run.{form}", "-o", "page.html").status == 0
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "states [m]" in page
    assert '"name":"level"' in page


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (["tank.hys", "nothing.json"], 1, "nothing.json: No such file"),
        (["tank.hys", "tank.hys"], 1, "tank.hys is no run"),
        (["tank.hys", "-o", "nowhere/page.html"], 2, "there is no folder nowhere"),
        (["tank.hys", "--max-modes", "0"], 2, "--max-modes 0: a number of at least 1 was expected"),
        (["tnak.hys"], 1, "cannot read tnak.hys"),
    ],
)
def test_what_cannot_be_reported(hysdel, arguments, status, words):
    shown = hysdel("report", *arguments)
    assert shown.status == status
    assert words in shown.err
