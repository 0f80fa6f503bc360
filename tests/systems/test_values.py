"""Affine forms, formulas, descriptions and trajectories."""

import json

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.formula import Connective, Formula


def test_affine_collects_terms_and_keeps_their_order():
    form = Affine(1, (("b", 2.0),)) + Affine(3, (("a", 1.0), ("b", -2.0)))
    assert form == Affine(4, (("b", 0.0), ("a", 1.0)))
    assert not form.is_constant
    assert (form * 2).value({"a": 3, "b": 100}) == 14


@pytest.mark.parametrize(
    ("form", "text"),
    [
        (Affine(), "+ 0"),
        (Affine(2.5), "2.5"),
        (Affine(-1), "-1"),
        (Affine(0, (("x", 1.0),)), "x"),
        (Affine(0, (("x", -1.0),)), "-x"),
        (Affine(-2, (("x", 0.5), ("y", -3.0))), "0.5*x - 3*y - 2"),
    ],
)
def test_affine_text(form, text):
    assert str(form) == text.removeprefix("+ ")


def test_formula_text_and_value():
    formula = Formula(("a", "b", Connective.AND, "c", Connective.NOT, Connective.IMPLIES))
    assert str(formula) == "(a & b) -> ~c"
    assert formula.names == ("a", "b", "c")
    assert formula.value({"a": 1, "b": 0, "c": 1})
    assert not formula.value({"a": 1, "b": 1, "c": 1})


def test_description_names_every_variable_and_row():
    mld = hys.load("clutch").mld
    text = mld.describe()
    assert all(v.name in text for v in (*mld.x, *mld.u, *mld.y, *mld.d, *mld.z))
    assert text.count("<=") == mld.ne + 4  # the four thresholds are quoted as well
    assert "Te' = Te + Teinc" in text


def run():
    return hys.load("clutch").simulate([150, 40, 60, 100, 0], np.zeros((5, 2)))


def test_trajectory_shapes_names_and_tables():
    trajectory = run()
    assert trajectory.steps == 5
    assert trajectory.x.shape == (6, 5)
    assert trajectory.names["u"] == ("Teinc", "Fninc")
    assert len(trajectory.to_csv().splitlines()) == 6
    assert json.loads(json.dumps(trajectory.to_dict()))["x"][0] == [150, 40, 60, 100, 0]
    assert trajectory.modes[0] == "010000"


def test_unknown_signal_is_named():
    with pytest.raises(hys.ArgumentError, match="no signal speed: it has we, gamma"):
        run()["speed"]
