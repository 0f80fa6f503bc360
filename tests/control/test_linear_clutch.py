"""The published explicit law of the linear clutch, from its physical parameters."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.control.explicit import parametric_controller
from hysdel_py.control.explicit_certificate import random_points
from hysdel_py.demos.linear_clutch import (
    BOX,
    SECTION,
    linear_clutch,
    linear_clutch_controller,
    published_price,
    published_section,
)

PUBLISHED = json.loads((Path(__file__).parents[1] / "data" / "linear_clutch.json").read_text(encoding="utf-8"))
DIGITS = 4
"""Significant digits that are printed."""
TIGHT = 1e-6
"""Room for a printed row, relative to its terms, beyond that of its digits."""


@cache
def law():
    return hys.explicit(linear_clutch_controller(), BOX)


def rounded(numbers):
    """Numbers as they are printed; what is below 1e-12 prints as a zero that rounding left behind."""
    return [0.0 if abs(value) < 1e-12 else float(f"{value:.{DIGITS}g}") for value in np.ravel(numbers)]


def agrees(own, printed):
    """Whether numbers agree up to one unit of the last printed digit."""
    unit = 10.0 ** (np.floor(np.log10(np.maximum(np.abs(printed), 1e-300))) - DIGITS + 1)
    return bool(np.all(np.abs(own - printed) <= np.where(np.array(printed) == 0, 1e-10, 1.001 * unit)))


def test_the_price_that_reproduces_the_document():
    assert published_price(linear_clutch()) == pytest.approx(225243.8, abs=0.05)


def test_regions():
    assert law().complete
    assert law().count == PUBLISHED["regions"]
    assert law().names == ("we", "dw", "Te", "Fn(-1)", "r(we)", "r(dw)")


def test_the_default_price_gives_as_many_regions():
    assert hys.explicit(linear_clutch_controller(rho=1e4), BOX).count == PUBLISHED["regions"]


def region_of(published):
    """The region with a printed law whose rows the printed ones contain."""
    found = [
        i for i in section_regions() if rounded([*law().K[i, 0], law().k[i, 0]]) == [*published["K"], published["k"]]
    ]
    fitting = [i for i in found if all(has_row(published["rows"], row) for row in inner_rows(i))]
    assert len(fitting) == 1, f"printed region {published['number']}: {fitting}"
    return fitting[0]


def section_regions():
    active = published_section(law()).active
    return [i for i in range(law().count) if law().active[i] in active]


def inner_rows(i):
    """Rows of a region that are none of the box's, scaled to sides of 1, -1 or 0 as in print."""
    A, b = law().rows(i)
    ends = np.column_stack([law().domain.A, law().domain.b])
    rows = [row for row in np.column_stack([A, b]) if np.abs(ends - row).max(axis=1).min() > 1e-9]
    return [row / (abs(row[-1]) if abs(row[-1]) > 1e-9 else 1.0) for row in rows]


def has_row(printed, row):
    if abs(row[-1]) < 1e-9:
        return any(is_proportional(row[:-1], np.array(other[:-1])) for other in printed if other[-1] == 0)
    return any(other[-1] == round(row[-1]) and agrees(row[:-1], np.array(other[:-1])) for other in printed)


def is_proportional(row, printed):
    """Rows through the origin are printed in a scale of their own."""
    scale = printed[np.argmax(np.abs(printed))] / row[np.argmax(np.abs(printed))]
    return bool(np.all(np.abs(scale * row - printed) <= 2e-3 * np.maximum(np.abs(printed), 1e-6)))


@pytest.mark.parametrize("published", PUBLISHED["laws"], ids=lambda entry: str(entry["number"]))
def test_printed_law_and_half_spaces(published):
    """Every row of ours is printed, and every printed row holds on our region: it is the same polyhedron."""
    region = law().polyhedron(region_of(published))
    for *row, side in published["rows"]:
        room = sum(abs(c) * 150 * 10.0**-DIGITS for c in row) + TIGHT
        assert region.maximise(row).value <= side + room


def test_six_regions_in_the_published_section():
    assert published_section(law()).count == PUBLISHED["section"]
    regions = {region_of(published) for published in PUBLISHED["laws"]}
    assert regions == set(section_regions())


def test_inside_the_box_the_section_touches_three():
    """The section lies on the end u(-1) = 0 of the box, so that a slice inside the box loses three."""
    assert law().fixed(SECTION).count == 3


@pytest.mark.parametrize(("rho", "count"), [(1e3, 21), (4.5e5, 21)])
def test_the_count_does_not_depend_on_the_price(rho, count):
    assert hys.explicit(linear_clutch_controller(rho=rho), BOX).count == count


def test_hard_outputs_give_eight_regions():
    assert hys.explicit(linear_clutch_controller(rho=np.inf), BOX).count == 8


def test_a_row_for_the_sign_of_the_slack_changes_nothing():
    problem = parametric_controller(linear_clutch_controller(), BOX).problem
    signed = replace(
        problem,
        G=np.vstack([problem.G, [0.0, -1.0]]),
        w=np.append(problem.w, 0.0),
        S=np.vstack([problem.S, np.zeros(6)]),
    )
    assert len(hys.solve_mpqp(signed).regions) == PUBLISHED["regions"]


def test_law_against_the_program_online():
    problem = parametric_controller(linear_clutch_controller(), BOX).problem
    certificate = law().certificate(problem, samples=100)
    assert certificate.holds()
    assert certificate.jump < 1e-9


def test_online_and_explicit_inputs_agree():
    mpc = linear_clutch_controller()
    for zeta in random_points(law(), 300, np.random.default_rng(5)):
        x, last, ref = zeta[:3], zeta[3:4], zeta[4:]
        online, own = mpc.solve(x, ref, last), law().solve(x, ref, last)
        assert own.u == pytest.approx(online.u, abs=1e-6)
        assert own.cost == pytest.approx(online.cost, rel=1e-7, abs=1e-6)


def test_closed_loops_agree():
    start = {"we": 100.0, "dw": 40.0, "Te": 80.0}
    runs = [
        hys.closed_loop(linear_clutch(), controller, start, 60, [100.0, 0.0], last_input=[0.0])
        for controller in (linear_clutch_controller(), law())
    ]
    assert runs[1].steps == 60, runs[1].messages
    assert runs[0].x == pytest.approx(runs[1].x, abs=1e-6)
    assert runs[1].names["x"] == ("we", "dw", "Te")
    assert abs(runs[1]["dw"][-1]) < 5
