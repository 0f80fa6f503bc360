"""Queries of models against the same questions asked by can_reach and must_reach, and against random runs."""

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.analysis.start_box import box_around
from hysdel_py.errors import ArgumentError, CompileError
from hysdel_py.reports.condition import condition_of

TEXT = """/* extension: queries */
SYSTEM tank {
  INTERFACE {
    STATE { REAL level [0, 1]; REAL other [0, 1]; BOOL shut; }
    INPUT { REAL q [0, 0.2]; }
    OUTPUT { REAL y; }
    PARAMETER { REAL top = 0.35; REAL low; }
  }
  IMPLEMENTATION {
    AUX { BOOL high; REAL flow; }
    AD { high = level >= 0.3; }
    DA { flow = {IF shut THEN 0 ELSE q}; }
    CONTINUOUS { level = 0.5*level + flow; other = 0.5*other; }
    AUTOMATA { shut = high; }
    OUTPUT { y = level; }
    QUERIES {
      NEVER y >= top WITHIN 20 FROM level <= 0.1 & ~shut;
      ALWAYS level < 0.45 WITHIN 20 FROM level <= 0.1;
      EVENTUALLY high WITHIN 5;
      EVENTUALLY other <= 0.1 WITHIN 4;
      NEVER level <= low WITHIN 1 FROM level >= 0.2 & other >= 2;
    }
  }
}
"""


@pytest.fixture(scope="module")
def answers():
    return hys.answer_queries(hys.load(TEXT, low=-1.0))


def test_verdicts(answers):
    assert [a.verdict for a in answers] == ["violated", "holds", "violated", "holds", "no run"]


def test_same_as_the_questions_one_by_one(answers):
    model = hys.load(TEXT, low=-1.0)
    first = hys.can_reach(model, "level <= 0.1 & ~shut", "y >= top", 20)
    assert (first.verdict, first.time) == (answers[0].answer.verdict, answers[0].answer.time)
    assert hys.can_reach(model, "level <= 0.1", "level >= 0.45", 20).verdict == answers[1].answer.verdict
    assert hys.must_reach(model, {}, "other <= 0.1", 4).verdict == answers[3].answer.verdict


def test_counterexample_is_a_run_with_its_lines(answers):
    run = answers[0].answer.run
    again = hys.load(TEXT, low=-1.0).simulate(run.x[0], run.u)
    assert again.y[answers[0].answer.time, 0] >= 0.35
    text = str(answers[0])
    assert "--> <text>:17:7" in text
    assert "NEVER y >= top WITHIN 20" in text
    assert "high becomes true" in text
    assert "AD { high = level >= 0.3; }" in text
    assert "its contrary: level >= 0.45" in str(answers[1])


def test_what_holds_holds_on_random_runs(answers):
    model, draw = hys.load(TEXT, low=-1.0), np.random.default_rng(1)
    for _ in range(200):
        run = model.simulate([draw.uniform(0, 0.1), draw.uniform(), 0], draw.uniform(0, 0.2, (20, 1)))
        assert run["level"].max() < 0.45
        assert run["other"][:5].min() <= 0.1


def test_start_draws_a_box():
    condition = condition_of("level <= 0.1 & ~shut & other > 0.2 & (level + other <= 1 | shut)", hys.load(TEXT), "x0")
    box = box_around(condition)
    assert box["shut"] == (0, 0)
    assert box["level"][1] == pytest.approx(0.1)
    assert box["other"][0] == pytest.approx(0.2)
    assert box_around(condition_of("level <= 0.1 | shut", hys.load(TEXT), "x0")) == {}
    assert box_around(condition_of("~(level <= 0.1 & shut)", hys.load(TEXT), "x0")) == {}


def test_open_parameter_is_told_at_its_place():
    with pytest.raises(CompileError, match="low"):
        hys.answer_queries(hys.load(TEXT))


def test_wrong_arguments():
    with pytest.raises(ArgumentError, match="a Model was expected"):
        hys.answer_queries("tank")
    with pytest.raises(ArgumentError, match="there is no"):
        hys.answer_queries(hys.load(TEXT, low=0), inputs={"p": 1})
    assert hys.answer_queries(hys.load("two_tanks")) == ()


def random_model(draw):
    """Two states, a threshold that changes the map and a Boolean state; stays within its ranges."""
    a = draw.uniform(-0.5, 0.5, (2, 2, 2)).round(2)
    slope, offset = draw.uniform(-1, 1, 2).round(2), round(float(draw.uniform(-0.5, 0.5)), 2)
    row = [[f"({float(a[m, i, 0])!r})*p + ({float(a[m, i, 1])!r})*q" for i in range(2)] for m in range(2)]
    goal = round(float(draw.uniform(0.2, 1.2)), 2)
    text = f"""/* extension: queries */
    SYSTEM r {{ INTERFACE {{ STATE {{ REAL p [-2, 2]; REAL q [-2, 2]; BOOL b; }} INPUT {{ REAL u [-0.5, 0.5]; }} }}
    IMPLEMENTATION {{ AUX {{ BOOL s; REAL m, n; }}
      AD {{ s = ({float(slope[0])!r})*p + ({float(slope[1])!r})*q <= {offset!r}; }}
      DA {{ m = {{IF s THEN {row[0][0]} ELSE {row[1][0]}}}; n = {{IF s & b THEN {row[0][1]} ELSE {row[1][1]}}}; }}
      CONTINUOUS {{ p = m + u; q = n - 0.5*u; }} AUTOMATA {{ b = s; }}
      QUERIES {{ NEVER p >= {goal!r} WITHIN 3 FROM p >= -0.2 & p <= 0.2 & q >= -0.2 & q <= 0.2 & ~b; }} }} }}"""
    return hys.load(text), goal


@pytest.mark.parametrize("seed", range(4))
def test_programs_sets_and_random_runs_agree(seed):
    draw = np.random.default_rng(seed)
    model, goal = random_model(draw)
    (found,) = hys.answer_queries(model)
    start = {"p": (-0.2, 0.2), "q": (-0.2, 0.2), "b": 0}
    sets = hys.reach(model, start, 3)
    top = max(states.ranges()["p"][1] for states in sets.sets)
    assert abs(top - goal) > 1e-5, "a goal at the edge of the sets tells nothing"
    assert found.verdict == ("violated" if top > goal else "holds")
    for _ in range(60):
        x0 = [*draw.uniform(-0.2, 0.2, 2), 0]
        inputs = np.where(draw.random((3, 1)) < 0.5, draw.choice([-0.5, 0.5], (3, 1)), draw.uniform(-0.5, 0.5, (3, 1)))
        run = model.simulate(x0, inputs)
        assert all(states.contains(x, 1e-6) for states, x in zip(sets.sets, run.x, strict=True))
        assert found.verdict == "violated" or run["p"].max() < goal


def test_queries_of_modules(tmp_path):
    (tmp_path / "leak.hys").write_text("""/* extension: queries */
    SYSTEM leak { INTERFACE { STATE { REAL h [0, 1]; } INPUT { REAL q; } OUTPUT { REAL out; } }
    IMPLEMENTATION { CONTINUOUS { h = 0.5*h + q; } OUTPUT { out = h; }
      QUERIES { NEVER h >= 0.5 WITHIN 4 FROM h <= 0.2; } } }""")
    (tmp_path / "whole.hys").write_text("""SYSTEM whole {
    INTERFACE { MODULE { leak t, s; } INPUT { REAL p [0, 0.3]; } OUTPUT { REAL y; } }
    IMPLEMENTATION { LINEAR { t.q = p; s.q = 0.5*t.h; } OUTPUT { y = s.out; } } }""")
    found = hys.answer_queries(hys.load(tmp_path / "whole.hys"), inputs={"p": (0, 0.2)})
    assert [answer.query.text for answer in found] == [
        f"NEVER {name}.h >= 0.5 WITHIN 4 FROM {name}.h <= 0.2" for name in "ts"
    ]
    assert [answer.verdict for answer in found] == ["holds", "violated"]  # nothing is said of t.h when s starts
    assert "leak.hys:4" in str(found[0])


def test_name_of_the_answer_is_refused():
    text = TEXT.replace("BOOL high;", "BOOL high, condition_holds;").replace(
        "AD { high", "AD { condition_holds = level <= 0.5; high"
    )
    model = hys.load(text.replace("EVENTUALLY high", "EVENTUALLY condition_holds"), low=-1)
    with pytest.raises(ArgumentError, match="rename the variable"):
        hys.answer_queries(model)
