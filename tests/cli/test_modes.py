"""``hysdel show``, ``hysdel graph`` and ``hysdel compile --form pwa``."""

import json

import pytest

import hysdel_py as hys
from hysdel_py.cli.main import main
from hysdel_py.export.pwa_data import read_pwa_json


@pytest.mark.parametrize("form", ["dha", "mld", "pwa"])
def test_show(form, capsys):
    assert main(["show", "clutch", "--form", form]) == 0
    model = hys.load("clutch")
    assert capsys.readouterr().out == getattr(model, form).describe()
    assert main(["show", "clutch", "--form", form, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)


def test_compile_writes_modes(tmp_path, capsys):
    assert main(["compile", "clutch", "--form", "pwa", "--merge", "-o", str(tmp_path / "m.json")]) == 0
    assert "5 modes with 4 different dynamics" in capsys.readouterr().out
    assert len(read_pwa_json(tmp_path / "m.json").modes) == 5
    assert main(["compile", "clutch", "--form", "pwa", "-o", str(tmp_path / "m.hys")]) == 0
    assert len(hys.load(tmp_path / "m.hys").dha.x) == 5
    assert main(["compile", "clutch", "--form", "pwa", "-o", "m.npz"]) == 2


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["--merge"], "add --form pwa, or leave --merge out"),
        (["--form", "mld", "--merge"], "add --form pwa, or leave --merge out"),
        (["--form", "pwa", "--big-m", "lp"], "leave out --big-m, or --form pwa"),
        (["--form", "pwa", "--share", "--compact"], "leave out --share, --compact, or --form pwa"),
        (["--form", "pwa", "--constants", "aux"], "leave out --constants, or --form pwa"),
    ],
)
def test_options_without_effect_are_wrong_usage(given, words, capsys):
    assert main(["compile", "clutch", *given]) == 2
    assert words in capsys.readouterr().err


def test_graph(tmp_path, capsys):
    assert main(["graph", "clutch", "--kind", "adjacency"]) == 0
    assert capsys.readouterr().out.startswith('graph "clutch" {')
    for name in ("g.dot", "g.svg"):
        assert main(["graph", "clutch", "--merge", "-o", str(tmp_path / name)]) == 0
        assert (tmp_path / name).stat().st_size > 100
    assert main(["graph", "clutch", "-o", "g.txt"]) == 2
