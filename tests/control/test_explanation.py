"""Why a plan is as it is, against numbers that follow by hand; and programs written down and solved again."""

from __future__ import annotations

import json

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.control.costs import Cost
from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.case_file import read_case, solve_case
from hysdel_py.optimize.node_log import NodeLog

TANK = """SYSTEM tank {
INTERFACE { STATE { REAL level [0, 10]; } INPUT { REAL flow [-2, 2]; BOOL pump; } }
IMPLEMENTATION {
  AUX { REAL lift; BOOL high; }
  AD { high = level >= 8; }
  DA { lift = {IF pump THEN 1 ELSE 0}; }
  CONTINUOUS { level = level + flow + lift; }
  MUST { flow <= 0.5; }
} }"""


@pytest.fixture(scope="module")
def tank():
    return hys.load(TANK)


def why(model, x, ref, limits=None, **options):
    mpc = HybridMpc(model, 1, Cost(terminal={"level": 1}), limits or Limits(), gap_rel=1e-9, gap_abs=1e-9, **options)
    move = mpc.solve([x], {"level": ref})
    return mpc.why(move), mpc, move


def test_price_of_a_requirement(tank):
    """From 1 to 5 with a pump of 1 and a flow of 0.5 at most: cost (2.5 - 5)^2, falling by 2 * 2.5 per unit of flow."""
    explanation, _, move = why(tank, 1.0, 5.0)
    assert move.cost == pytest.approx(6.25, rel=1e-6)
    (price,) = explanation.requirements
    assert price.price == pytest.approx(5.0, rel=1e-4)
    assert (price.stage, price.side) == (0, "high")
    assert "flow <= 0.5 (line 8)" in price.text
    assert explanation.limits == ()


def test_price_of_a_limit_is_the_slope_of_the_cost(tank):
    limit = 0.25

    def cost(top):
        return why(tank, 1.0, 5.0, Limits(u={"flow": (None, top)}))[2].cost

    explanation, _, _ = why(tank, 1.0, 5.0, Limits(u={"flow": (None, limit)}))
    (price,) = explanation.limits
    assert price.text == "u[0] flow (line 2) at 0.25"
    assert price.price == pytest.approx((cost(limit) - cost(limit + 1e-3)) / 1e-3, rel=1e-2)
    assert explanation.requirements == ()


def test_prices_are_those_with_the_binaries_held(tank):
    """The pump is too dear: (1.25 - 1.9)^2 falls by 2 * 0.65 per unit; with a bit of the pump it would be less."""
    cost = Cost(terminal={"level": 1}, u={"pump": 10})
    mpc = HybridMpc(tank, 1, cost, Limits(u={"flow": (None, 0.25)}), gap_rel=1e-9)
    (price,) = mpc.why(mpc.solve([1.0], {"level": 1.9})).limits
    assert price.price == pytest.approx(1.3, rel=1e-4)


def test_price_of_a_limit_that_is_a_row(tank):
    """The limit of the increment stops the flow at 0.1: cost (1 + 1 + 0.1 - 5)^2 falls by 2 * 2.9 per unit."""
    mpc = HybridMpc(tank, 1, Cost(terminal={"level": 1}), Limits(du={"flow": (-1, 0.1)}), gap_rel=1e-9)
    explanation = mpc.why(mpc.solve([1.0], {"level": 5.0}, last_input=[0.0, 0.0]))
    (price,) = explanation.limits
    assert price.text == "limit[0] du flow in [-1, 0.1]"
    assert price.price == pytest.approx(5.8, rel=1e-4)


def test_forced_and_searched_binaries(tank):
    explanation, _, _ = why(tank, 1.0, 5.0)
    assert [(entry.text, entry.value) for entry in explanation.forced] == [("d[0] high (line 4)", 0)]
    assert [(entry.text, entry.value) for entry in explanation.searched] == [("u[0] pump (line 2)", 1)]
    high, _, _ = why(tank, 9.0, 5.0)
    assert high.forced[0].value == 1
    text = explanation.describe()
    assert "binaries without a choice\n  d[0] high (line 4) = 0" in text
    assert "price 5" in text


def test_nothing_to_explain(tank):
    _, mpc, move = why(tank, 1.0, 5.0)
    with pytest.raises(ArgumentError, match="no plan to explain"):
        mpc.why(mpc.solve([11.0]))
    with pytest.raises(ArgumentError, match="another controller"):
        HybridMpc(tank, 2, Cost(terminal={"level": 1})).why(move)


@pytest.mark.parametrize("norm", [1, 2])
def test_a_dumped_problem_gives_the_same_answer(tank, norm, tmp_path):
    mpc = HybridMpc(tank, 3, Cost(x={"level": 1}, u={"pump": 0.1}, norm=norm), references=("level",))
    move = mpc.solve([2.0], {"level": [2.0, 4.0, 3.0]})
    mpc.dump_problem(tmp_path / "by_move.json", move=move)
    mpc.dump_problem(tmp_path / "by_state.json", [2.0], {"level": [2.0, 4.0, 3.0]})
    assert (tmp_path / "by_move.json").read_bytes() == (tmp_path / "by_state.json").read_bytes()
    case = read_case(tmp_path / "by_move.json")
    assert solve_case(tmp_path / "by_move.json").objective == pytest.approx(move.cost, rel=1e-6)
    assert case.variables[:2] == ("u[0] flow (line 2)", "u[0] pump (line 2)")
    assert len(case.rows) == case.miqp.qp.m


def test_infinite_sides_survive_the_file(tank, tmp_path):
    mpc = HybridMpc(tank, 2, Cost(x={"level": 1}))
    mpc.dump_problem(tmp_path / "case.json", [2.0])
    qp, again = mpc.problem([2.0]).qp, read_case(tmp_path / "case.json").miqp.qp
    for name in ("l", "u", "lb", "ub", "q"):
        assert np.array_equal(getattr(qp, name), getattr(again, name))
    assert np.isinf(again.l).any()
    assert (qp.A != again.A).nnz == 0
    assert (qp.P != again.P).nnz == 0


@pytest.mark.parametrize(
    ("text", "words"),
    [("{", "JSON"), ("[]", "format"), ('{"format": "hysdel_py mixed-integer program 1"}', "does not hold")],
)
def test_files_that_are_no_cases(tmp_path, text, words):
    (tmp_path / "case.json").write_text(text)
    with pytest.raises(ArgumentError, match=words):
        read_case(tmp_path / "case.json")


def test_a_change_of_the_file_changes_the_answer(tank, tmp_path):
    mpc = HybridMpc(tank, 1, Cost(terminal={"level": 1}))
    mpc.dump_problem(tmp_path / "case.json", [1.0], {"level": 5.0})
    data = json.loads((tmp_path / "case.json").read_text())
    data["constant"] += 3.0
    (tmp_path / "case.json").write_text(json.dumps(data))
    assert solve_case(tmp_path / "case.json").objective == pytest.approx(9.25, rel=1e-4)


def test_what_to_dump(tank, tmp_path):
    mpc = HybridMpc(tank, 1, Cost(terminal={"level": 1}))
    with pytest.raises(ArgumentError, match="state or a move"):
        mpc.dump_problem(tmp_path / "case.json")
    with pytest.raises(ArgumentError, match="no program"):
        mpc.dump_problem(tmp_path / "case.json", move=mpc.solve([11.0]))


def test_node_log(systems, tmp_path):
    log = NodeLog()
    move = HybridMpc(systems.heater(), 6, Cost(y={"felt": 1}, d={"heat": 3}), progress=log).solve(
        [3.0, 1.0], {"felt": 6.1}
    )
    assert len(log.entries) == move.nodes
    assert log.entries[-1].objective == pytest.approx(move.cost)
    log.write(tmp_path / "nodes.csv")
    lines = (tmp_path / "nodes.csv").read_text().splitlines()
    assert lines[0].startswith("nodes,qps,open,objective,bound,seconds,number,parent,variable,value,node_bound,fate")
    assert len(lines) == move.nodes + 1
    assert lines[1].split(",")[6:9] == ["1", "0", "-1"]
    assert lines[1].split(",")[-1] in ("split", "cut off")
