"""Wrong arguments say which, what was found and what was expected."""

from __future__ import annotations

import numpy as np
import pytest

from hysdel_py.control.closed_loop import closed_loop
from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.errors import ArgumentError

NAN = float("nan")


@pytest.mark.parametrize(
    ("cost", "words"),
    [
        ({"y": {"tseen": 1}}, ["y", "tseen", "felt, hot"]),
        ({"y": {"felt": NAN}}, ["felt", "nan", "finite"]),
        ({"y": {"felt": -1}}, ["felt", "-1", "at least 0"]),
        ({"y": {"felt": "much"}}, ["felt", "much", "number"]),
        ({"x": [1, -2]}, ["x", "on", "-2"]),
        ({"x": [1, 2, 3]}, ["(3,)", "2 by 2", "T, on"]),
        ({"y": [[1, 2], [0, 1]]}, ["y", "symmetric"]),
        ({"y": [[1, 2], [2, 1]]}, ["y", "eigenvalue -1"]),
        ({"y": [[1, NAN], [NAN, 1]]}, ["y", "finite"]),
        ({"terminal": {"felt": 1}}, ["terminal", "felt", "T, on"]),
    ],
)
def test_costs(systems, cost, words):
    refuses(words, lambda: HybridMpc(systems.heater(), 3, Cost(**cost)))


@pytest.mark.parametrize("norm", [3, "two", True, None])
def test_norms(norm):
    refuses(["norm", repr(norm), "norm=1, norm=2 or norm=inf"], lambda: Cost(norm=norm))


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ({"y": {"tseen": (0, 1)}}, ["tseen", "felt, hot"]),
        ({"u": {"fan": (1, 0)}}, ["fan", "[1, 0]"]),
        ({"x": {"T": (NAN, 0)}}, ["T", "NaN"]),
        ({"x": {"T": 3}}, ["T", "3", "pair"]),
        ({"x": {"T": (60, 70)}}, ["T", "[60, 70]", "[-50, 50]"]),
        ({"x": [1]}, ["x", "mapping"]),
        ({"x": {"T": (0, 1)}, "soft": ("felt",)}, ["soft", "felt", "T"]),
        ({"u": {"fan": (0, 1)}, "soft": ("fan",)}, ["soft", "fan"]),
        ({"x": {"T": (0, 1)}, "soft": True, "rho": -1}, ["rho", "-1", "positive"]),
        ({"x": {"T": (0, 1)}, "soft": True, "rho": {"felt": 1}}, ["rho", "felt", "T"]),
        ({"terminal": ([[1.0]], [1.0])}, ["S", "(1, 1)", "2 columns"]),
    ],
)
def test_limits(systems, limits, words):
    refuses(words, lambda: HybridMpc(systems.heater(), 3, Cost(), Limits(**limits)))


@pytest.mark.parametrize("horizon", [0, -1, 2.5, "3", True, None])
def test_horizon(systems, horizon):
    refuses(["horizon", repr(horizon), "whole number"], lambda: HybridMpc(systems.fold(), horizon, Cost()))


def test_model_cost_and_backend(systems):
    refuses(["model", "int"], lambda: HybridMpc(3, 3, Cost()))
    refuses(["cost", "dict", "Cost"], lambda: HybridMpc(systems.fold(), 3, {"seen": 1}))
    refuses(["back end", "cplex", "piqp"], lambda: HybridMpc(systems.fold(), 3, Cost(), backend="cplex"))


def test_names_of_references(systems):
    cost = Cost(y={"seen": 1})
    refuses(["x", "no weight", "seen"], lambda: HybridMpc(systems.fold(), 3, cost, references=("x",)))
    refuses(["twice"], lambda: HybridMpc(systems.fold(), 3, cost, references=("seen", "seen")))


@pytest.mark.parametrize(
    ("ref", "words"),
    [
        ({"sene": 1}, ["sene", "seen"]),
        ({}, ["no reference", "seen"]),
        (None, ["no reference", "seen"]),
        ({"seen": NAN}, ["seen", "finite"]),
        ({"seen": [1, 2]}, ["seen", "(2,)", "3 or 4"]),
        ({"seen": "high"}, ["seen", "high"]),
        ([1, 2], ["(2,)", "1 entries", "seen"]),
    ],
)
def test_references(systems, ref, words):
    mpc = HybridMpc(systems.fold(), 3, Cost(y={"seen": 1}), references=("seen",))
    refuses(words, lambda: mpc.solve([0.0], ref))


@pytest.mark.parametrize(
    ("x", "words"),
    [
        ([1.0], ["state", "(1,)", "T, on"]),
        ([NAN, 0], ["T", "nan"]),
        ([np.inf, 0], ["T", "inf"]),
        ([0, 0.5], ["on", "Boolean"]),
        ({"T": 1}, ["on"]),
        ({"T": 1, "on": 0, "hot": 1}, ["hot"]),
    ],
)
def test_states(systems, x, words):
    mpc = HybridMpc(systems.heater(), 2, Cost())
    refuses(words, lambda: mpc.solve(x))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"steps": -1}, ["steps", "-1"]),
        ({"steps": 2.0}, ["steps", "2.0"]),
        ({"on_failure": "ignore"}, ["on_failure", "ignore", "hold"]),
        ({"plant": 3}, ["plant", "int"]),
        ({"plant": lambda x, u: np.zeros(2)}, ["plant", "1 finite numbers"]),
        ({"plant": lambda x, u: "off"}, ["plant", "off"]),
        ({"controller": lambda x, ref: [NAN]}, ["controller", "nan"]),
        ({"controller": lambda x, ref: "left"}, ["controller", "left"]),
        ({"x0": {"x": 1}}, ["x0", "mapping"]),
    ],
)
def test_closed_loop_arguments(change, words):
    good = {"plant": lambda x, u: x, "controller": lambda x, ref: [0.0], "x0": [0.0], "steps": 2}
    refuses(words, lambda: closed_loop(**{**good, **change}))


def refuses(words, action):
    with pytest.raises(ArgumentError) as caught:
        action()
    for word in words:
        assert word in str(caught.value)
