"""The shipped models: what their headers and their table say is true, and each does its work in a loop."""

import re
import shlex
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import hysdel_py as hys
from hysdel_py import shipped
from hysdel_py.cli.main import main
from hysdel_py.demos import clutch

NAMES = sorted(shipped.shipped_models())
README = Path(__file__).parents[1] / "models" / "README.md"
SIZES = {"states": "nx", "inputs": "nu", "outputs": "ny", "Booleans": "nd", "reals": "nz", "rows": "ne"}
COUNTED = {None: 0, "one": 1, "two": 2, "both": 2, "three": 3, "six": 6}
AGREEMENT = 1e-7


@cache
def load(name):
    return hys.load(name)


def header(name):
    """The comment at the head of a model, as one line."""
    text = shipped.shipped_models()[name].read_text(encoding="utf-8")
    assert text.startswith("/*")
    return " ".join(text[2 : text.index("*/")].split())


def entry(name, word):
    """What stands behind a word of the header, up to the next one."""
    found = re.search(rf"{word}: (.+?)(?= (?:Source|Size|Shows): |$)", header(name))
    assert found, f"{name}: the header has no {word}:"
    return found[1]


def table():
    """Rows of the table of models/README.md by name."""
    lines = [line for line in README.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    columns, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in lines)
    named = (dict(zip(columns, row, strict=True)) for row in rows)
    return {re.fullmatch(r"\[(\w+)\]\(\1\.hys\)", row["model"])[1]: row for row in named}


def test_there_are_models():
    assert {"clutch", "two_rooms", "two_tanks"} <= set(NAMES)


def beside_the_point(diagnostic):
    """Whether this tells only that the original knows no such thing."""
    return diagnostic.code.value == "HYS901"


@pytest.mark.parametrize("name", NAMES)
def test_compiles_without_a_word(name):
    model = load(name)
    assert model.name == name
    assert model.mld.ne > 0 or model.mld.nd == 0
    assert [d for d in model.diagnostics if not beside_the_point(d)] == []


@pytest.mark.parametrize("name", NAMES)
def test_every_real_of_the_interface_has_a_unit_and_a_description(name):
    symbols = [s for s in load(name).typed.symbols if s.line and s.role.name != "AUX"]
    assert len(symbols) > 5
    assert not [s.name for s in symbols if not s.description or (s.is_real and not s.unit)]


@pytest.mark.parametrize("name", NAMES)
def test_header_says_where_it_comes_from_and_what_it_shows(name):
    assert len(entry(name, "Source")) > 20
    assert len(entry(name, "Shows")) > 20


@pytest.mark.parametrize("name", NAMES)
def test_sizes_in_the_header_are_those_of_the_mld(name):
    mld, said = load(name).mld, entry(name, "Size")
    for word, attribute in SIZES.items():
        found = re.search(rf"(\d+) {word}?(?: \((\w+) Boolean\))?", said)
        assert found, f"{name}: the header does not say how many {word}"
        assert int(found[1]) == getattr(mld, attribute), word
        if word in ("states", "inputs", "outputs"):
            assert COUNTED[found[2]] == sum(v.is_bool for v in getattr(mld, attribute[1])), word


def test_table_lists_every_model_with_its_sizes():
    rows = table()
    assert sorted(rows) == NAMES
    for name, row in rows.items():
        assert {word: int(row[word]) for word in SIZES} == {w: getattr(load(name).mld, a) for w, a in SIZES.items()}
        assert entry(name, "Shows").startswith(row["shows"])
        assert row["field"]


def commands():
    return [shlex.split(line[2:]) for line in README.read_text(encoding="utf-8").splitlines() if line.startswith("$ ")]


def test_table_tells_how_to_run_each():
    assert [name for name in NAMES if not any(name in command for command in commands())] == []


@pytest.mark.parametrize("command", [c for c in commands() if c[1] == "mpc"], ids=" ".join)
def test_commands_of_the_table_run(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert command[0] == "hysdel"
    assert main(command[1:]) == 0
    assert "stopped" not in capsys.readouterr().out
    assert (tmp_path / command[-1]).stat().st_size > 10_000


def random_point(variables, generator):
    values = [generator.integers(2) if v.is_bool else generator.uniform(v.low, v.high) for v in variables]
    return np.array(values, dtype=float)


@pytest.mark.parametrize("name", NAMES)
def test_both_forms_agree_at_five_hundred_points(name):
    model, generator, compared = load(name), np.random.default_rng(5), 0
    for _ in range(500):
        x, u = random_point(model.mld.x, generator), random_point(model.mld.u, generator)
        try:
            expected = model.dha.step(x, u)
        except (
            hys.SimulationError
        ):  # a MUST, or an auxiliary that leaves its range: then there is no step in either form
            with pytest.raises(hys.SimulationError):
                model.mld.step(x, u)
            continue
        compared += 1
        for ours, theirs in zip(model.mld.step(x, u), expected, strict=True):
            assert ours == pytest.approx(theirs, abs=AGREEMENT, rel=AGREEMENT)
    assert compared > 40, "dozens of points have to be possible ones"


@pytest.mark.parametrize("name", NAMES)
def test_all_forms_have_the_same_steps(name):
    report = hys.verify(load(name), pwa=load(name).pwa, points=60)
    assert report.is_equal, str(report)


def test_two_tanks_bring_the_lower_level_down_to_its_reference():
    mpc = hys.HybridMpc(load("two_tanks"), 4, hys.Cost(y={"level2": 100}), references=("level2",), node_limit=30)
    run = hys.closed_loop(load("two_tanks"), mpc, [0.1, 0.4], 25, {"level2": 0.2})
    assert run.steps == 25
    assert run["h2"][15:] == pytest.approx(0.2, abs=0.005)
    assert run["h2"][0] == 0.4
    assert run["valve"].any(), "the first tank lets water in"


def test_two_tanks_fill_up_and_never_open_the_valve_when_nearly_full():
    mpc = hys.HybridMpc(load("two_tanks"), 3, hys.Cost(y={"level2": 100}), references=("level2",), node_limit=20)
    run = hys.closed_loop(load("two_tanks"), mpc, [0.5, 0.5], 12, {"level2": 0.6})
    assert run.steps == 12
    assert not np.any(run["valve"] * (run["h2"][:-1] >= 0.54))
    assert run["valve"].any()


def test_three_tanks_fill_the_one_in_the_middle():
    cost = hys.Cost(y={"level(2)": 1})
    mpc = hys.HybridMpc(load("three_tanks"), 2, cost, references=("level(2)",), node_limit=60)
    run = hys.closed_loop(load("three_tanks"), mpc, [1, 2, 1], 16, {"level(2)": 3})
    assert run.steps == 16
    assert run["h(2)"][14:] == pytest.approx(3, abs=0.05)
    assert run["open(1)"].sum() >= 3


def test_three_tanks_let_no_pump_fill_a_tank_that_is_high():
    model = load("three_tanks")
    for pump, expected in (([0.05, 0], False), ([0, 0.05], True)):
        for form in (model.dha, model.mld):
            if expected:
                form.step([6, 1, 1], [*pump, 0, 0])
            else:
                with pytest.raises(hys.SimulationError):
                    form.step([6, 1, 1], [*pump, 0, 0])


def test_two_rooms_are_heated_and_cooled_into_their_bands():
    mpc = hys.HybridMpc(load("two_rooms"), 3, hys.Cost(y={"y1": 1, "y2": 1}), references=("y1", "y2"), node_limit=30)
    run = hys.closed_loop(load("two_rooms"), mpc, [15, 30, 28, 0], 30, {"y1": 23, "y2": 24})
    assert run.steps == 30
    assert run["T1"][10:] == pytest.approx(23, abs=2)
    assert run["T2"][10:] == pytest.approx(24, abs=1)
    assert run["heater_on"].sum() >= 2
    assert run["cooler_on"].sum() >= 4
    assert not np.any(run["heater_on"] * run["cooler_on"]), "never both"


def test_linear_clutch_is_sampled_exactly():
    Je, Jv, be, bv, mu, ts = 0.2, 0.8, 0.03, 0.67, 1.0, 0.01
    A = np.array([[-be / Je, 0, 1 / Je], [-be / Je + bv / Jv, -bv / Jv, 1 / Je], [0, 0, 0]])
    B = np.array([[-mu / Je], [-mu * (1 / Jv + 1 / Je)], [0]])
    held = expm(ts * np.block([[A, B], [np.zeros((1, 4))]]))
    mld = load("linear_clutch").mld
    assert pytest.approx(held[:3, :3], abs=1e-14) == mld.A
    assert pytest.approx(held[:3, 3:], abs=1e-14) == mld.B1


@pytest.mark.parametrize(("old", "new", "torque", "speed"), [(1.913, 1.220, 600, 75), (3.308, 1.913, 1600, 40)])
def test_gear_shift_starts_from_rest_with_the_clutch_stuck(old, new, torque, speed):
    """The stationary point of the document: the clutch carries what engine and shaft ask for."""
    model = load_shift("bist_part1", old, new)
    engine = torque / old / 3.737
    x0 = [engine, 0, engine, torque / 6000, speed * old * 3.737, speed * 3.737, speed]
    x1, y, d, _ = model.dha.step(x0, [0, 0, 0])
    assert x1[:6] == pytest.approx(x0[:6], abs=1e-9), "engine and shafts keep their speeds"
    assert x1[6] - speed == pytest.approx(0.01 * (torque - 10 * speed) / 110)
    assert y[2] == pytest.approx(torque)
    assert d[0] == 0, "the clutch does not slip backwards"


def load_shift(name, old, new):
    gears = {"r_old": 1 / old} if name == "bist_part1" else {}
    return hys.load(name, **gears, r_new=1 / new, F_max=250)


@pytest.mark.parametrize(("old", "new"), [(1.913, 1.220), (3.308, 1.913)])
@pytest.mark.parametrize("name", ["bist_part1", "bist_part2"])
def test_planetary_set_obeys_the_equations_of_motion(name, old, new):
    """Torques balance on engine, shafts and flywheel: equations (10.3) to (10.6), the brake against a backward turn."""
    model = load_shift(name, old, new)
    gear = 1 / (old if name == "bist_part1" else new)
    z, rgn, rd, Je, Jf = 2.1155, 0.7, 1 / 3.737, 0.154, 0.08
    Jps = 0.0028 + 0.0057 / gear**2
    x = np.array([60.0, 0.005, 40.0, 0.05, 300.0, 150.0, 39.0])
    x1, _, _, z_values = model.dha.step(x, [0, 0, 0], check=False)
    Tb, Tc, Tds, _ = z_values
    we, ws = (x1 - x)[4:6] / 0.01
    sun = Jf * (z / rgn * ws - z * we) - Tb  # torque of the set on the flywheel
    assert Je * we == pytest.approx(x[0] - Tc + z * sun)
    assert Jps * ws == pytest.approx(Tc / gear - rd * Tds - z / rgn * sun)


def test_flywheel_may_not_be_braked_while_it_turns_forwards():
    part2 = load("bist_part2")
    x = {"Te": 50, "Fnb": 20, "Fnc": 20, "dphi": 0.1, "we": 300, "ws": 280, "wv": 75}
    for form in (part2.dha, part2.mld):
        with pytest.raises(hys.SimulationError):
            form.step(x, [0, 0, 0])
        form.step(x | {"Fnb": 0}, [0, 0, 0])
        form.step(x | {"we": 420}, [0, 0, 0])


def test_heater_and_air_conditioner_never_run_together():
    model = load("heat_and_cool")
    generator = np.random.default_rng(1)
    seen = set()
    for _ in range(300):
        _, _, d, _ = model.dha.step(generator.uniform(-10, 60, 3), [20])
        seen.add(tuple(d[-2:]))
    assert seen == {(0, 0), (0, 1), (1, 0)}


def test_pendulum_has_the_modes_of_its_source():
    free, touching = sorted(load("pendulum_wall").pwa.modes, key=lambda mode: -mode.A[1, 0])
    assert pytest.approx(np.array([[1, 0.01], [0.1, 1]])) == free.A
    assert pytest.approx(np.array([[1, 0.01], [-0.9, 1]])) == touching.A
    assert touching.f == pytest.approx([0, 0.1])
    assert pytest.approx(np.array([[0], [0.01]])) == touching.B


def test_supply_chain_keeps_count_of_its_pallets():
    model = load("supply_chain")
    u = {"out_a(1)": 2, "out_b(2)": 1, "runs(1)": 1, "makes_a(1)": 1, "to_first(1)": 0, "runs(2)": 1, "to_first(2)": 1}
    rest = {v.name: 0 for v in model.mld.u if v.name not in u}
    x1, y, *_ = model.dha.step([5, 5, 5, 5], {**u, **rest})
    assert x1 == pytest.approx([3, 11, 10, 4])
    assert y == pytest.approx([2, 1, 20])


@pytest.mark.parametrize("change", [{"makes_a(2)": 1}, {"to_first(2)": 0}])
def test_supply_chain_has_one_set_of_tools_and_one_ramp_per_store(change):
    model = load("supply_chain")
    u = {v.name: 0 for v in model.mld.u} | {"runs(1)": 1, "makes_a(1)": 1, "runs(2)": 1, "to_first(2)": 1}
    model.dha.step([5, 5, 5, 5], u)
    with pytest.raises(hys.SimulationError):
        model.dha.step([5, 5, 5, 5], u | change)


def check_engagement(result):
    """Engaged within the second, no stall, a smooth lock-up."""
    assert result.engaged
    assert result.lockup_time < 1
    assert result.least_engine_speed >= 79.92
    assert result.slip_after_lockup < 0.1
    assert abs(result.lockup_acceleration) < 40
    figures = result.figures()
    assert figures["mpc_steps"] == result.hand_over > 50
    assert figures["proven_optimal"] > figures["mpc_steps"] / 2


def test_clutch_engages():
    check_engagement(clutch.engage(horizon=5, node_limit=20))


def test_clutch_engages_as_the_demonstration_does_it():
    check_engagement(clutch.engage())


def test_clutch_that_starts_in_the_window_is_only_locked():
    result = clutch.engage(horizon=2, start={"we": 100, "gamma": 0.5, "Te": 60, "Fn": 60, "lc": 0})
    assert result.engaged
    assert result.figures()["mpc_steps"] == 0
    assert result.table()


@pytest.mark.parametrize("name", ["clutch", "clutch.hys"])
def test_names_without_a_path(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert shipped.locate(name) == shipped.shipped_models()["clutch"]


def test_file_of_that_name_goes_first_and_a_folder_does_not(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "two_tanks").mkdir()
    assert shipped.locate("two_tanks") == shipped.shipped_models()["two_tanks"]
    (tmp_path / "clutch.hys").write_text("SYSTEM mine {}")
    assert shipped.locate("clutch.hys") == "clutch.hys"


@pytest.mark.parametrize("other", ["", "SYSTEM s {}", "nothing.hys", "x" * 5000, "a\0b"])
def test_other_arguments_stay_as_they_are(other):
    assert shipped.locate(other) == other
