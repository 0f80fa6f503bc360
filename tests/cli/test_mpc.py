"""``hysdel mpc``: weights, references, limits, and loops that end early."""

import pytest

MPC = ("mpc", "tank.hys", "--horizon", "2", "--steps", "4")
TO_THREE = (*MPC, "--x0", "1,0", "--weight", "y=1", "--ref", "y=3")


def column(shown, name):
    return [row[name] for row in shown.rows]


@pytest.mark.parametrize("backend", ["piqp", "osqp"])
def test_follows_its_reference(hysdel, backend):
    shown = hysdel(*TO_THREE, "--backend", backend)
    assert (shown.status, shown.err) == (0, "")
    assert column(shown, "y") == pytest.approx([1, 2, 3, 3], abs=1e-3)
    assert column(shown, "status") == [0, 0, 0, 0]


def test_without_reference_it_goes_to_zero(hysdel):
    shown = hysdel(*MPC, "--x0", "-2,0", "--weight", "y=1")
    assert column(shown, "y") == pytest.approx([-2, -1, 0, 0], abs=1e-3)


def test_negative_reference(hysdel):
    shown = hysdel(*MPC, "--x0", "1,0", "--weight", "y=1", "--ref", "y=-1")
    assert column(shown, "y")[2] == pytest.approx(-1, abs=1e-3)


def test_weight_of_an_input_and_of_the_last_state(hysdel):
    """One free step of size v from 1: (1 + v)^2 + v^2 is least at v = -1/2."""
    arguments = ("mpc", "tank.hys", "--horizon", "1", "--steps", "1", "--x0", "1,0")
    shown = hysdel(*arguments, "--weight", "flow=1", "--terminal", "level=1")
    assert column(shown, "flow") == pytest.approx([-0.5], abs=1e-3)


def test_state_with_both_weights_and_a_reference(hysdel):
    shown = hysdel(*MPC, "--x0", "1,0", "--weight", "level=1", "--terminal", "level=9", "--ref", "level=2.5")
    assert column(shown, "level")[2] == pytest.approx(2.5, abs=1e-2)


def test_hard_limit(hysdel):
    shown = hysdel(*TO_THREE, "--limit", "y=:1.5", "--limit", "flow=-0.25:0.25")
    assert column(shown, "y") == pytest.approx([1, 1.25, 1.5, 1.5], abs=1e-3)


@pytest.mark.parametrize(("price", "excess"), [("=1", 0.5), ("=3", 0.25), ("", 0)])
def test_soft_limit_and_its_price(hysdel, price, excess):
    """At horizon 2 the one priced step costs (1 - e)^2 + price e^2, least at e = 1/(1 + price)."""
    shown = hysdel(*TO_THREE[:-4], "--weight", "y=1", "--ref", "y=2", "--limit", "y=:1", "--soft", f"y{price}")
    assert shown.status == 0
    assert column(shown, "y")[1] == pytest.approx(1 + excess, abs=1e-3)


def test_loop_that_ends_early(hysdel):
    shown = hysdel(*TO_THREE, "--limit", "level=2.5:")
    assert shown.status == 1
    assert shown.rows == []
    assert "step 0: stopped, infeasible" in shown.out
    assert "x level in [2.5, inf]" in shown.out
    assert "hysdel mpc: the loop ended after 0 of 4 steps; --soft NAME softens a limit" in shown.err


def test_loop_that_ends_early_as_json(hysdel):
    shown = hysdel(*TO_THREE, "--limit", "level=2.5:", "--json")
    assert shown.status == 1
    assert shown.json["x"] == [[1, 0]]
    assert "infeasible" in shown.json["messages"][0]


def test_held_input_is_valid_json(hysdel, tmp_path):
    """Where there was no plan, cost and gap are infinite, which JSON cannot say."""
    (tmp_path / "leak.hys").write_text(
        "SYSTEM s { INTERFACE { STATE { REAL x [0, 10]; } INPUT { REAL u [0, 1]; } } "
        "IMPLEMENTATION { CONTINUOUS { x = x + u - 0.6; } MUST { x >= 1; } } }"
    )
    loop = ("mpc", "leak.hys", "--x0", "1.7", "--weight", "u=1", "--horizon", "1", "--steps", "3")
    data = hysdel(*loop, "--json", "--on-failure", "hold")
    assert data.status == 1
    assert data.json["messages"]
    stopped = hysdel(*loop)
    assert stopped.status == 1
    assert "--on-failure hold goes on with the last input" in stopped.err


def test_node_limit_is_told(hysdel):
    shown = hysdel("mpc", "two_tanks", "--x0", "0.1,0.4", "--weight", "level1=1,level2=100",
                   "--ref", "level1=0.2,level2=0.3", "--node-limit", "1", "--steps", "1")  # fmt: skip
    assert shown.status == 0
    assert "the node limit ended the search" in shown.out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "--weight is missing: say what to control, as in --weight y=1"),
        (["--weight", "y"], "--weight y: NAME=VALUE was expected, as in --weight y=1"),
        (["--weight", "y=1,y=2"], "--weight y is given twice"),
        (["--weight", "yy=1"], "--weight yy: there is no such signal; there are the outputs y; states level, was_open"),
        (["--weight", "y=-1"], "weight y of y is -1"),
        (["--weight", "y=nan"], "weight y of y is nan"),
        (["--weight", "y=1"], "--x0 is missing"),
        (["--weight", "y=1", "--terminal", "y=1"], "--terminal y: there is no such signal; there are the states level"),
        (["--weight", "y=1", "--ref", "level=1"], "--ref level: it has no weight, so the reference would do nothing"),
        (["--weight", "y=1", "--ref", "y=high"], "--ref y is 'high': a number was expected"),
        (["--weight", "y=1", "--limit", "y"], "--limit y: NAME=LOW:HIGH was expected, as in --limit y=0:1"),
        (["--weight", "y=1", "--limit", "y=3"], "--limit y is '3': LOW:HIGH was expected"),
        (["--weight", "y=1", "--limit", "y=a:3"], "--limit y is 'a': a number was expected"),
        (["--weight", "y=1", "--limit", "y=0:1,y=0:2"], "--limit y is given twice"),
        (["--weight", "y=1", "--limit", "inflow=0:1"], "--limit inflow: there is no such signal"),
        (["--weight", "y=1", "--limit", "y=3:2"], "limit y of y is [3, 2]"),
        (["--weight", "y=1", "--soft", "y"], "--soft y: it has no --limit as a state or output; those with one: none"),
        (["--weight", "y=1", "--limit", "flow=0:1", "--soft", "flow"], "--soft flow: it has no --limit as a state"),
        (["--weight", "y=1", "--limit", "y=0:1", "--soft", "y=dear"], "--soft y is 'dear': a number was expected"),
        (["--weight", "y=1", "--backend", "cplex"], "there is no QP back end 'cplex': known are piqp, osqp"),
        (["--weight", "y=1", "--horizon", "0"], "horizon is 0"),
        (["--weight", "y=1", "--x0", "1,0", "--steps", "-1"], "steps is -1"),
        (["--weight", "y=1", "--plot", "loop.xls"], "--plot loop.xls: a name that ends in"),
    ],
)
def test_wrong_usage(hysdel, arguments, words):
    shown = hysdel("mpc", "tank.hys", *arguments)
    assert shown.status == 2
    assert words in shown.err
    assert shown.out == ""


def test_start_outside_the_model_is_told(hysdel):
    shown = hysdel(*MPC, "--x0", "11,0", "--weight", "y=1")
    assert shown.status == 1
    assert "measured state level = 11 is outside its range [-5, 10] (declared in line 4)" in shown.out


def test_files(hysdel, tmp_path):
    assert hysdel(*TO_THREE, "--csv", "loop.csv", "--plot", "loop.pdf").status == 0
    assert (tmp_path / "loop.csv").read_text(encoding="utf-8").startswith("t,level,was_open,flow,open,y,inflow,cost,")
    assert (tmp_path / "loop.pdf").read_bytes().startswith(b"%PDF")


# ------------------------------------------------------------------ norms, changes, blocks, fallbacks, records


@pytest.mark.parametrize("norm", ["1", "inf"])
def test_other_norms(hysdel, norm):
    shown = hysdel(*TO_THREE, "--norm", norm)
    assert column(shown, "y") == pytest.approx([1, 2, 3, 3], abs=1e-3)
    assert column(shown, "cost")[0] == pytest.approx(3.0, abs=1e-3)  # |1 - 3| + |2 - 3|; squares would give 5


def test_limit_of_a_change(hysdel):
    shown = hysdel(*TO_THREE, "--limit-change", "flow=-0.5:0.25", "--last-input", "0,0")
    assert column(shown, "flow")[:2] == pytest.approx([0.25, 0.5], abs=1e-3)


def test_weight_of_a_change(hysdel):
    shown = hysdel(*TO_THREE, "--weight-change", "flow=1e5", "--last-input", "0,0")
    assert column(shown, "flow")[:2] == pytest.approx([0, 0], abs=1e-2)


def test_changes_need_the_input_before(hysdel):
    shown = hysdel(*TO_THREE, "--limit-change", "flow=-0.5:0.25")
    assert shown.status == 2
    assert "--last-input is missing" in shown.err


def test_blocks_and_horizons(hysdel):
    four = (*TO_THREE, "--horizon", "4")
    free = column(hysdel(*four), "cost")[0]
    assert column(hysdel(*four, "--blocking", "1,3"), "cost")[0] > free - 1e-6
    assert column(hysdel(*four, "--blocking", "4"), "cost")[0] > free + 0.1
    assert column(hysdel(*four, "--control-horizon", "1"), "cost")[0] > free + 0.1
    assert hysdel(*TO_THREE, "--binary-horizon", "1").status == 0
    wrong = hysdel(*TO_THREE, "--blocking", "1,0.5")
    assert (wrong.status, "whole numbers" in wrong.err) == (2, True)


def test_fallback(hysdel):
    shown = hysdel(*TO_THREE, "--limit", "level=2.5:", "--fallback", "soft")
    assert shown.status == 0
    assert column(shown, "status")[0] == 6
    assert "inputs came from the fallback" in shown.out


def test_dumped_problem_is_solved_again(hysdel, tmp_path):
    shown = hysdel(*TO_THREE, "--dump-problem", "case.json", "--node-log", "nodes.csv")
    assert shown.status == 0
    again = hysdel("solve", "case.json")
    assert again.status == 0
    assert f"objective {column(shown, 'cost')[0]:.4g}"[:12] in again.out
    assert "u[0] flow" in again.out
    assert (tmp_path / "nodes.csv").read_text().startswith("nodes,qps")
    data = hysdel("solve", "case.json", "--json", "--gap", "1e-8").json
    assert data["status"] == "optimal"
    assert len(data["x"]) == len(data["variables"])


def test_tree_of_the_largest_search_is_drawn(hysdel, tmp_path):
    shown = hysdel(*TO_THREE, "--tree", "tree.svg", "--dump-problem", "case.json")
    assert shown.status == 0
    assert "<svg" in (tmp_path / "tree.svg").read_text()
    assert hysdel("solve", "case.json", "--tree", "again.svg").status == 0
    assert (tmp_path / "again.svg").stat().st_size > 5000
    assert hysdel(*TO_THREE, "--tree", "tree.txt").status == 2


def test_no_tree_where_highs_solves(hysdel, tmp_path):
    shown = hysdel(*TO_THREE, "--norm", "1", "--tree", "tree.svg")
    assert shown.status == 0
    assert "no picture" in shown.err
    assert not (tmp_path / "tree.svg").exists()


def test_solve_says_what_is_wrong_with_a_file(hysdel, tmp_path):
    (tmp_path / "case.json").write_text("{}")
    shown = hysdel("solve", "case.json")
    assert shown.status == 2
    assert "a file of dump_problem was expected" in shown.err


def test_why(hysdel):
    shown = hysdel(*TO_THREE, "--why")
    assert shown.status == 0
    assert "active limits and ranges\n  u[0] flow" in shown.err
