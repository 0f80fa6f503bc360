"""``hysdel verify``, ``hysdel diff`` and ``hysdel check --deep``: words, plain data, exit statuses."""

import pytest


@pytest.fixture
def narrow(tmp_path):
    """A model whose declared range of an auxiliary forbids steps."""
    text = (tmp_path / "tank.hys").read_text().replace("REAL inflow;", "REAL inflow [0, 1]; BOOL low;")
    text = text.replace("CONTINUOUS", "AD { low = inflow <= 0.5; }\n    CONTINUOUS", 1).replace(
        "= open;", "= open & low;"
    )
    path = tmp_path / "narrow.hys"
    path.write_text(text, encoding="utf-8")
    return path


def test_equal(hysdel):
    shown = hysdel("verify", "tank.hys", "--points", "20")
    assert shown.status == 0
    assert shown.out.startswith("tank: Dha, Mld, Pwa have the same steps\n")
    assert "20 random points: 20 alike" in shown.out
    assert "4 checks: 4 no" in shown.out


def test_different(hysdel, narrow):
    shown = hysdel("verify", narrow, "--points", "0")
    assert shown.status == 1
    assert "the Dha has a step that the Mld forbids" in shown.out
    assert "line 12: low = inflow <= 0.5" in shown.out
    data = hysdel("verify", narrow, "--points", "0", "--json").json
    assert data["status"] == "different"
    witness = next(check["witness"] for check in data["checks"] if check["witness"])
    assert set(witness["x"]) == {"level", "was_open"}
    assert witness["second"]["problems"]


def test_not_settled(hysdel):
    shown = hysdel("verify", "tank.hys", "--points", "0", "--seconds", "1e-9")
    assert shown.status == 4
    assert "is not settled" in shown.out


def test_form_from_a_file(hysdel, tmp_path):
    assert hysdel("compile", "tank.hys", "-o", "own.json").status == 0
    assert hysdel("compile", "tank.hys", "--param", "gain=2", "-o", "other.json").status == 0
    assert hysdel("verify", "tank.hys", "--mld", "own.json").status == 0
    assert hysdel("verify", "tank.hys", "--mld", "other.json").status == 1
    assert hysdel("verify", "tank.hys", "--param", "gain=2", "--mld", "other.json").status == 0


def test_modes_from_a_file(hysdel):
    assert hysdel("compile", "tank.hys", "--form", "pwa", "-o", "own.json").status == 0
    assert hysdel("compile", "tank.hys", "--form", "pwa", "--param", "gain=2", "-o", "other.json").status == 0
    shown = hysdel("verify", "tank.hys", "--pwa", "own.json", "--forms", "pwa")
    assert shown.status == 0
    assert shown.out.startswith("tank: Dha, Pwa have the same steps\n")
    assert hysdel("verify", "tank.hys", "--pwa", "other.json").status == 1
    assert hysdel("verify", "tank.hys", "--forms", "mld").out.startswith("tank: Dha, Mld have the same steps\n")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--pwa", "form.txt"), "a file that ends in .json"),
        (("--forms", "mdl"), "mld, pwa or both"),
        (("--mld", "form.txt"), "a file that ends in .json"),
        (("--seconds", "0"), "a time above 0"),
        (("--band", "2"), "band is 2"),
        (("--points", "-1"), "points is -1: a number of at least 0"),
    ],
)
def test_wrong_usage(hysdel, arguments, words):
    shown = hysdel("verify", "tank.hys", *arguments)
    assert shown.status == 2
    assert words in shown.err
    assert not ("--points" in arguments and "seconds" in shown.err)


@pytest.mark.parametrize("content", ["{}", "[]", "not JSON", '{"schema": "hysdel-mld 0"}'])
def test_a_file_that_holds_no_form(hysdel, tmp_path, content):
    (tmp_path / "bad.json").write_text(content, encoding="utf-8")
    shown = hysdel("verify", "tank.hys", "--mld", "bad.json")
    assert shown.status == 1
    assert shown.err.count("bad.json") == 1


def test_a_file_that_holds_no_arrays(hysdel, tmp_path):
    for name in ("bad.npz", "bad.mat"):
        (tmp_path / name).write_bytes(b"nothing of the kind")
        shown = hysdel("verify", "tank.hys", "--mld", name)
        assert shown.status == 1
        assert name in shown.err


def test_diff(hysdel, tmp_path):
    text = (tmp_path / "tank.hys").read_text()
    (tmp_path / "new.hys").write_text(text.replace("gain*flow", "2*gain*flow"), encoding="utf-8")
    assert hysdel("diff", "tank.hys", "tank.hys").status == 0
    shown = hysdel("diff", "tank.hys", "new.hys")
    assert shown.status == 1
    assert "level' differs" in shown.out
    assert "inflow is where they part" in shown.out
    assert "new.hys: line 11: inflow = {IF open THEN 2*gain*flow ELSE 0}" in shown.out
    assert hysdel("diff", "tank.hys", "new.hys", "--param", "gain=0").status == 0
    data = hysdel("diff", "tank.hys", "new.hys", "--json").json
    assert data["checks"][0]["responsible"][0]["new"]["line"] == 11


def test_deep_check(hysdel, narrow):
    assert hysdel("check", narrow).status == 0
    shown = hysdel("check", narrow, "--deep", "--strict")
    assert shown.status == 1
    assert "warning[HYS541]" in shown.err
    assert "warning[HYS547]" in shown.err
    data = hysdel("check", narrow, "--deep", "--json").json
    codes = [finding["code"] for finding in data["deep"]["findings"]]
    assert codes.count("HYS541") >= 1
    assert data["deep"]["unsettled"] == []
    assert {d["code"] for d in data["diagnostics"]} >= set(codes)
    open_questions = hysdel("check", "tank.hys", "--deep", "--seconds", "1e-9")
    assert "not settled: " in open_questions.out
