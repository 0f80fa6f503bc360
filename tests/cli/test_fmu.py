"""Functional mock-up units from the shell."""

import shutil
import zipfile

import pytest

LAW = ("explicit", "tank.hys", "--horizon", "1", "--norm", "1", "--weight", "y=1,flow=0.1", "--samples", "0")


def test_unit_of_a_plant(hysdel, tmp_path):
    shown = hysdel("compile", "tank.hys", "-o", "tank.fmu")
    assert shown.status == 0
    assert shown.out.startswith("tank.fmu: 2 states")
    assert "modelDescription.xml" in zipfile.ZipFile(tmp_path / "tank.fmu").namelist()


def test_constants_count_for_units_too(hysdel, tmp_path):
    offset = (tmp_path / "tank.hys").read_text(encoding="utf-8").replace("level + inflow", "level + inflow + 0.1")
    (tmp_path / "offset.hys").write_text(offset, encoding="utf-8")
    refused = hysdel("compile", "offset.hys", "-o", "unit.fmu", "--constants", "forbid")
    assert refused.status == 1
    assert not (tmp_path / "unit.fmu").exists()


def test_without_a_compiler_it_is_said(hysdel, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    shown = hysdel("compile", "tank.hys", "-o", "tank.fmu")
    assert shown.status == 0
    assert "tank.fmu: no C compiler was found (CC, cc, gcc, clang)" in shown.err


def test_unit_of_a_law(hysdel, tmp_path):
    assert hysdel(*LAW, "--fmu", "law.fmu").status == 0
    description = zipfile.ZipFile(tmp_path / "law.fmu").read("modelDescription.xml").decode()
    assert 'name="r(y)"' in description or 'name="level"' in description


@pytest.mark.parametrize(
    ("arguments", "words"),
    [((*LAW, "--fmu", "nowhere/law.fmu"), "there is no folder nowhere"), ((*LAW, "--fmu", "law.c"), "ends in .fmu")],
)
def test_wrong_names(hysdel, arguments, words):
    shown = hysdel(*arguments)
    assert shown.status == 2
    assert words in shown.err
