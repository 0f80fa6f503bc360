"""Checks of facts about explicit laws of hybrid controllers."""

from __future__ import annotations

import numpy as np
from fact_controllers import TIGHT, own_cost, sampled_controller
from fact_explicit import with_matrices
from fact_tools import Fact, close
from pwa_form import Box, Mode, mld_of_modes

from hysdel_py.control.costs import Cost
from hysdel_py.control.explicit import explicit
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.optimize.mpqp import solve_mpqp


def pwa_mpc_explicit(fact: Fact) -> str:
    """Regions of each sequence of modes by its program as it is stated; costs and moves of the controller's law."""
    p, expected, tolerance = fact["problem"], fact["expected"], fact["tolerance"]
    counts = [stated_count(program, p) for program in p["mplps"]]
    assert sorted(counts) == expected["regions_per_mode_sequence_sorted"], f"regions {counts} of the sequences"
    law = explicit(modes_controller(p))
    assert law.complete, "the law is not complete"
    assert law.partition, "the law is no partition"
    weight = np.array(p["Q"]), p["norm"]
    for point in expected["optimal_cost"]:
        x = np.array(point["x"], dtype=float)
        close(law.value(x) + own_cost(x, weight), point["J"], tolerance, f"cost at {x}")
    for point in expected["u0"]:
        close(law(point["x"]), point["u"], tolerance, f"input at {point['x']}")
    return f"{len(counts)} sequences, {law.count} regions of the law, {len(expected['optimal_cost'])} states"


def stated_count(program: Fact, p: Fact) -> int:
    eye = np.eye(len(p["xmin"]))
    box = {"xA": np.vstack([eye, -eye]), "xb": np.concatenate([p["xmax"], -np.array(p["xmin"])])}
    solution = solve_mpqp(with_matrices(program | box))
    assert solution.complete, "the map is not complete"
    return len(solution.regions)


def modes_controller(p: Fact) -> HybridMpc:
    """Modes that share a strip: either may be taken there."""
    modes = [Mode(*(np.array(m[key], dtype=float) for key in "ABf"), *guard(m["guard"])) for m in p["modes"]]
    ends = [np.array(p[key], dtype=float) for key in ("xmin", "xmax", "umin", "umax")]
    C = np.array(p["C"], dtype=float)
    mld = mld_of_modes(modes, Box((ends[0], ends[1]), (ends[2], ends[3])), C, np.zeros((len(C), 1)), np.zeros(len(C)))
    return HybridMpc(mld, p["N"], Cost(x=np.array(p["Q"]), u=np.array(p["R"]), terminal={}, norm=p["norm"]), **TIGHT)


def guard(text: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """``x1<=a`` or ``x1>=a`` as ``G x + H u <= g``."""
    sign = 1.0 if "<=" in text else -1.0
    return np.array([[sign, 0.0]]), np.zeros((1, 1)), np.array([sign * float(text.split("=")[1])])


def sampled_law(fact: Fact) -> str:
    """The costs of a fact by the explicit law of its controller."""
    mpc, weight = sampled_controller(fact["problem"])
    law = explicit(mpc)
    assert law.complete, "the law is not complete"
    for sample in fact["expected"]["samples"]:
        x = np.array(sample["x"], dtype=float)
        place = law.locate(x)
        assert (place is not None) == sample["feasible"], f"at {x}: feasible is {place is not None}"
        if place is not None:
            close(place.value + own_cost(x, weight), sample["J"], fact["tolerance"], f"cost at {x}")
    return f"{len(fact['expected']['samples'])} states, {len(law.sequences)} sequences, {law.count} regions"
