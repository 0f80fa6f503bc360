"""Functional mock-up units: what is in them, and that they step as we do."""

from __future__ import annotations

import shutil
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from export.compiled_c import build, needs_gcc
from hypothesis import HealthCheck, given, settings
from strategies import models

import hysdel_py as hys
from hysdel_py.control.explicit_hybrid import explicit_hybrid
from hysdel_py.errors import ArgumentError, CompileError
from hysdel_py.export.fmu import find_compiler
from hysdel_py.geometry.polyhedron import Polyhedron

TANK = """SYSTEM tank {
  INTERFACE {
    STATE { REAL level [-9, 9]; /* [m] level */ BOOL was; }
    INPUT { REAL flow [1, 2]; /* [m/s] <in> & out */ BOOL open; }
    OUTPUT { REAL y; /* [m] sum of level and flow */ }
    PARAMETER { REAL ts = 0.5; }
  }
  IMPLEMENTATION {
    AUX { REAL z; BOOL high; }
    AD { high = level >= 3; }
    DA { z = {IF open & ~high THEN flow ELSE -1}; }
    CONTINUOUS { level = 0.7*level + ts*z; }
    AUTOMATA { was = open; }
    OUTPUT { y = level + flow; }
    MUST { level <= 8; }
  }
}"""


def rotating_law():
    """``u = clip(-x)`` for x in [-3, 3]."""
    problem = hys.MpQp(
        H=np.eye(1), f=[0.0], F=[[1.0]], G=[[1.0], [-1.0]], w=[1.0, 1.0], S=[[0.0], [0.0]],
        theta=Polyhedron.box([-3.0], [3.0]),
    )  # fmt: skip
    return hys.ExplicitLaw.of(hys.solve_mpqp(problem), moves=1, names=("speed",))


def description(path):
    with zipfile.ZipFile(path) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def test_contents_and_description(tmp_path):
    written = hys.to_fmu(hys.load(TANK), tmp_path / "tank.fmu", x0=[2.0, 1], compiler=None)
    assert (written.platform, written.message[:11]) == ("", "no library ")
    with zipfile.ZipFile(written.path) as archive:
        assert archive.namelist() == [
            "modelDescription.xml", "sources/fmi2.c", "sources/fmu_model.h", "sources/tank.c", "sources/tank.h",
        ]  # fmt: skip
    root = description(written.path)
    found = {v.attrib["name"]: (v.attrib["causality"], v[0].tag, v[0].attrib.get("start"))
             for v in root.iter("ScalarVariable")}  # fmt: skip
    assert found == {
        "level": ("local", "Real", "2.0"), "was": ("local", "Boolean", "true"), "flow": ("input", "Real", "1.0"),
        "open": ("input", "Boolean", "false"), "y": ("output", "Real", None), "high": ("local", "Boolean", None),
        "z": ("local", "Real", None), "__additional_1": ("local", "Boolean", None),
        "step_status": ("local", "Integer", None),
    }  # fmt: skip
    flow = next(v for v in root.iter("ScalarVariable") if v.attrib["name"] == "flow")
    assert flow.attrib["description"] == "<in> & out"
    assert flow[0].attrib == {"unit": "m/s", "min": "1.0", "max": "2.0", "start": "1.0"}
    assert next(root.iter("DefaultExperiment")).attrib["stepSize"] == "0.5"


def test_same_model_same_bytes_and_another_start_another_guid(tmp_path):
    first, second, third = (tmp_path / name / "tank.fmu" for name in "abc")
    for path, x0 in ((first, [0.0, 0]), (second, [0.0, 0]), (third, [1.0, 0])):
        path.parent.mkdir()
        hys.to_fmu(hys.load(TANK), path, x0=x0, compiler=None)
    assert first.read_bytes() == second.read_bytes()
    assert description(first).attrib["guid"] != description(third).attrib["guid"]


@needs_gcc
@pytest.mark.parametrize("make", [lambda: hys.load(TANK), rotating_law, lambda: hys.load("clutch")])
def test_sources_compile_without_a_warning(tmp_path, make):
    hys.to_fmu(make(), tmp_path / "unit.fmu", compiler=None)
    with zipfile.ZipFile(tmp_path / "unit.fmu") as archive:
        archive.extractall(tmp_path)
    sources = sorted((tmp_path / "sources").glob("*.c"))
    build(*sources, output=tmp_path / "unit.so", options=("-shared", "-fPIC"))
    build(*sources, output=tmp_path / "named.so", options=("-shared", "-fPIC", "-DFMI2_FUNCTION_PREFIX=unit_"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((TANK, ""), "a name that ends in .fmu was expected"),
        ((TANK, "tank.zip"), "a name that ends in .fmu was expected"),
        ((TANK, "nowhere/tank.fmu"), "the folder .*nowhere does not exist"),
        ((3, "tank.fmu"), "system is a int: a Model, a Dha, or an explicit law"),
    ],
)
def test_wrong_arguments(tmp_path, arguments, words):
    system = hys.load(arguments[0]) if isinstance(arguments[0], str) else arguments[0]
    with pytest.raises(ArgumentError, match=words):
        hys.to_fmu(system, tmp_path / arguments[1])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"x0": [1.0]}, "the state has shape"),
        ({"sample_time": 0.0}, "sample_time is 0.0"),
        ({"sample_time": "1"}, "sample_time is '1'"),
        ({"compiler": 5}, "compiler is 5: a command"),
        ({"compiler": "no-such-compiler"}, "compiler is 'no-such-compiler': there is no such command"),
    ],
)
def test_wrong_options(tmp_path, options, words):
    with pytest.raises(ArgumentError, match=words):
        hys.to_fmu(hys.load(TANK), tmp_path / "tank.fmu", **options)


def test_paths_that_cannot_be_written(tmp_path):
    (tmp_path / "folder.fmu").mkdir()
    for path, words in ((tmp_path / "folder.fmu", "this is a folder"), (None, "path is None")):
        with pytest.raises(ArgumentError, match=words):
            hys.to_fmu(hys.load(TANK), path)


@needs_gcc
@pytest.mark.parametrize("name", ["fmi2", "fmu_model", "string", "FMI2"])
def test_names_of_the_sources_of_every_unit_are_left_to_them(tmp_path, name):
    assert hys.to_fmu(hys.load(TANK), tmp_path / f"{name}.fmu").platform
    root = description(tmp_path / f"{name}.fmu")
    assert next(root.iter("CoSimulation")).attrib["modelIdentifier"] == f"c_{name}"


def test_a_model_without_a_step_is_refused(tmp_path):
    loop = "SYSTEM s { INTERFACE { STATE { REAL x [0, 1]; } } IMPLEMENTATION { AUX { REAL a [0, 1], b [0, 1]; } LINEAR { a = b; b = a; } CONTINUOUS { x = a; } } }"  # noqa: E501
    with pytest.raises(CompileError):
        hys.to_fmu(hys.load(loop), tmp_path / "s.fmu")


def test_without_a_compiler_the_message_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    written = hys.to_fmu(hys.load(TANK), tmp_path / "tank.fmu")
    assert "no C compiler was found" in written.message


def test_the_compiler_of_the_environment_goes_first(monkeypatch):
    monkeypatch.setenv("CC", "my-cc")
    monkeypatch.setattr(shutil, "which", lambda name: f"/bin/{name}")
    assert find_compiler("auto") == "/bin/my-cc"


class Unit:
    """A unit that FMPy has loaded."""

    def __init__(self, system, path, **options):
        fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed: pip install fmpy")
        from fmpy.fmi2 import FMU2Slave
        from fmpy.validation import validate_fmu

        written = hys.to_fmu(system, path, **options)
        if not written.platform:
            pytest.skip(f"no unit to run: {written.message}; install gcc")
        assert validate_fmu(str(path)) == []
        self.described = fmpy.read_model_description(str(path))
        self.variables = {v.name: v for v in self.described.modelVariables}
        folder = path.with_suffix("")
        fmpy.extract(str(path), str(folder))
        self.slave = FMU2Slave(
            guid=self.described.guid, unzipDirectory=str(folder), instanceName="one",
            modelIdentifier=self.described.coSimulation.modelIdentifier,
        )  # fmt: skip
        self.slave.instantiate()
        self.start()

    def start(self, **values):
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.set(values)
        self.slave.exitInitializationMode()

    def set(self, values):
        for name, value in values.items():
            variable = self.variables[name]
            setter = self.slave.setBoolean if variable.type == "Boolean" else self.slave.setReal
            setter([variable.valueReference], [bool(value) if variable.type == "Boolean" else value])

    def get(self, *names):
        getters = {"Boolean": self.slave.getBoolean, "Real": self.slave.getReal, "Integer": self.slave.getInteger}
        found = [(self.variables[name], name) for name in names]
        return [float(getters[v.type]([v.valueReference])[0]) for v, _ in found]

    def step(self, t, h):
        self.slave.doStep(currentCommunicationPoint=t, communicationStepSize=h)


def compare(model, unit, x0, inputs):
    """Every variable at every sample instant."""
    dha, ts = model.dha, model.sample_time
    names = {key: [v.name for v in getattr(dha, key)] for key in "xuydz"}
    x = np.asarray(x0, dtype=float)
    for k, u in enumerate(inputs):
        unit.set(dict(zip(names["u"], u, strict=True)))
        x1, y, d, z = dha.step(x, u, check=False)
        for key, values in (("x", x), ("y", y), ("d", d), ("z", z)):
            assert unit.get(*names[key]) == pytest.approx(values.tolist(), rel=1e-12, abs=1e-12)
        unit.step(k * ts, ts)
        x = x1
    assert unit.get(*names["x"]) == pytest.approx(x.tolist(), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(("name", "x0"), [("two_tanks", [0.35, 0.5]), ("clutch", [100, 70, 20, 0, 0])])
def test_shipped_plants_step_as_ours(tmp_path, name, x0):
    model = hys.load(name)
    rng = np.random.default_rng(1)
    inputs = [[float(rng.integers(2)) if v.is_bool else rng.uniform(v.low, v.high) for v in model.dha.u]
              for _ in range(60)]  # fmt: skip
    run = model.simulate(x0, inputs, check=False)
    assert len(set(run.modes)) > 1  # events and Booleans take part
    compare(model, Unit(model, tmp_path / "plant.fmu", x0=x0), x0, inputs)


@settings(max_examples=4, deadline=None, suppress_health_check=list(HealthCheck))
@given(text=models())
def test_random_plants_step_as_ours(tmp_path_factory, text):
    model = hys.load(text)
    x0 = [0.0 if v.is_bool else min(max(0.0, v.low), v.high) for v in model.dha.x]
    inputs = [[0.0 if v.is_bool else v.low / 2 + v.high / 2 for v in model.dha.u]] * 4
    compare(model, Unit(model, tmp_path_factory.mktemp("unit") / "plant.fmu"), x0, inputs)


def test_fmpy_simulates_as_we_do(tmp_path):
    fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed: pip install fmpy")
    model = hys.load(TANK)
    Unit(model, tmp_path / "tank.fmu")
    result = fmpy.simulate_fmu(
        str(tmp_path / "tank.fmu"), stop_time=10.0, output_interval=0.5,
        start_values={"level": 5.0, "open": True, "flow": 1.5},
        output=["level", "was", "y", "high", "z"],
    )  # fmt: skip
    run = model.simulate([5.0, 0], [[1.5, 1]] * 21)
    assert result["level"] == pytest.approx(run["level"][:21], rel=1e-12, abs=1e-12)
    for name in ("y", "high", "z"):
        assert result[name] == pytest.approx(run[name], rel=1e-12, abs=1e-12)
    assert len(set(run["high"])) == 2


def test_shorter_and_longer_communication_steps(tmp_path):
    """Inputs count at sample instants alone; what is set in between waits."""
    model = hys.load(TANK)
    unit = Unit(model, tmp_path / "tank.fmu")
    unit.set({"flow": 1.0, "open": True})
    unit.step(0.0, 0.2)
    unit.set({"flow": 2.0})
    assert unit.get("level", "y") == [0.0, 1.0]
    unit.step(0.2, 0.3)
    assert unit.get("level", "y") == pytest.approx([0.5, 2.5], rel=1e-12)
    unit.step(0.5, 1.6)
    expected = model.simulate([0.5, 1], [[2.0, 1]] * 3)["level"]
    assert unit.get("level") == pytest.approx(expected[3:], rel=1e-12)
    unit.step(2.1, 0.0)


@pytest.mark.parametrize(("start", "ts", "steps"), [(1.7e9, 1e-3, 500), (0.0, 1e-3, 600_000)])
def test_times_that_miss_an_instant_by_rounding_are_that_instant(tmp_path, start, ts, steps):
    """Seconds since 1970 have coarse digits, and a sum of many steps drifts: no sample is lost, no input is late."""
    counter = """SYSTEM counter { INTERFACE { STATE { REAL n [0, 1e9], last [0, 1e9]; } INPUT { REAL u [0, 1e9]; } }
        IMPLEMENTATION { CONTINUOUS { n = n + 1; last = u; } } }"""
    unit = Unit(hys.load(counter), tmp_path / "counter.fmu", sample_time=ts)
    unit.slave.reset()
    unit.slave.setupExperiment(startTime=start)
    unit.slave.enterInitializationMode()
    unit.slave.exitInitializationMode()
    edges = start + np.arange(steps + 1) * ts if start else np.cumsum(np.r_[0.0, np.full(steps, ts)])
    if not start:  # the drift of the last steps, without the way there
        unit.step(0.0, float(edges[-100]))
        assert unit.get("n") == [steps - 99]
        assert abs(edges[-100] / ts - (steps - 99)) > 1e-6
    for k in range(steps - 99 if not start else 0, steps):
        unit.set({"u": float(k)})
        unit.step(float(edges[k]), ts)
        assert unit.get("n", "last") == [k + 1, k]


def test_what_a_step_violates_is_a_warning_and_a_number(tmp_path):
    model = hys.load(TANK)
    unit = Unit(model, tmp_path / "tank.fmu")
    unit.set({"flow": 5.0, "open": True})
    assert unit.get("step_status") == [2.0]
    unit.step(0.0, 0.5)  # FMPy passes a warning on, and does not stop


def test_wrong_calls_are_errors(tmp_path):
    unit = Unit(hys.load(TANK), tmp_path / "tank.fmu")
    from fmpy.fmi1 import FMICallException

    for call in (
        lambda: unit.set({"y": 1.0}),
        lambda: unit.set({"level": 1.0}),  # the simulation runs
        lambda: unit.slave.setReal([99], [0.0]),
        lambda: unit.slave.getReal([unit.variables["was"].valueReference]),
        lambda: unit.step(0.0, -1.0),
        lambda: unit.step(7.0, 0.5),
        lambda: unit.step(0.0, float("inf")),
    ):
        with pytest.raises(FMICallException):
            call()
    unit.set({"flow": float("nan")})
    with pytest.raises(FMICallException):
        unit.step(0.0, 0.5)


def test_a_snapshot_is_come_back_to(tmp_path):
    unit = Unit(hys.load(TANK), tmp_path / "tank.fmu")
    unit.set({"flow": 1.0, "open": True})
    unit.step(0.0, 0.5)
    kept = unit.slave.getFMUstate()
    before = unit.get("level", "was")
    frozen = unit.slave.serializeFMUstate(kept)
    unit.step(0.5, 2.0)
    assert unit.get("level", "was") != before
    unit.slave.setFMUstate(unit.slave.deSerializeFMUstate(frozen))
    assert unit.get("level", "was") == before
    unit.slave.reset()
    unit.start(level=1.0)
    assert unit.get("level", "was") == [1.0, 0.0]


def test_a_law_answers_as_ours_and_holds_outside(tmp_path):
    law = rotating_law()
    unit = Unit(law, tmp_path / "law.fmu")
    for speed in np.linspace(-3, 3, 25):
        unit.set({"speed": float(speed)})
        assert unit.get("u0") == pytest.approx(law([speed]).tolist(), rel=1e-12, abs=1e-12)
    unit.step(0.0, 1.0)  # the move -1 is applied
    unit.set({"speed": 5.0})
    assert unit.get("u0", "step_status") == [-1.0, 1.0]


def test_a_law_of_increments_keeps_the_input_applied_last(tmp_path):
    lti = hys.Lti([[0.9]], [[0.5]], x=("v",), u=("force",), ts=0.1)
    mpc = hys.LinearMpc(
        lti, "track", horizon=2, cost=hys.LinearCost(y=[1.0], du=[0.1]), limits=hys.LinearLimits(u=(-1, 1))
    )
    law = hys.explicit(mpc, {"v": (-2, 2), "force(-1)": (-1, 1), "r(v)": (-1, 1)})
    unit = Unit(law, tmp_path / "law.fmu")
    last = [0.0]
    for k, v in enumerate((0.0, 0.5, 1.0)):
        unit.set({"v": v, "r(v)": 1.0})
        move = law.solve([v], [1.0], last)
        assert unit.get("force") == pytest.approx(move.u.tolist(), rel=1e-12, abs=1e-12)
        unit.step(0.1 * k, 0.1)
        last = move.u
        assert unit.get("force(-1)") == pytest.approx(last.tolist(), rel=1e-12)


def test_a_hybrid_law_answers_as_ours(tmp_path):
    """Boolean states as inputs, Boolean moves as outputs."""
    mpc = hys.HybridMpc(hys.load(TANK), 1, hys.Cost(y={"y": 1.0}, u={"flow": 0.1}, norm=1))
    law = explicit_hybrid(mpc, fixed={"r(y)": 2.0, "r(flow)": 1.0})
    assert "was" in law.names
    unit, rng = Unit(law, tmp_path / "law.fmu"), np.random.default_rng(4)
    answered = 0
    for _ in range(60):
        x = [rng.uniform(-8, 8), float(rng.integers(2))]
        unit.set(dict(zip(("level", "was"), x, strict=True)))
        move = law(x)
        answered += move is not None
        assert unit.get("step_status") == [float(move is None)]
        if move is not None:
            assert unit.get("flow", "open") == pytest.approx(move.tolist(), rel=1e-12, abs=1e-12)
    assert answered > 30


def test_plant_and_law_close_the_loop(tmp_path):
    """The unit of a law in the place of the law: the run is the same."""
    plant = hys.load("SYSTEM s { INTERFACE { STATE { REAL speed [-3, 3]; } INPUT { REAL u [-1, 1]; } } "
                     "IMPLEMENTATION { CONTINUOUS { speed = 0.9*speed + 0.5*u; } } }")  # fmt: skip
    law = rotating_law()
    units = Unit(plant, tmp_path / "plant.fmu", x0=[2.5]), Unit(law, tmp_path / "law.fmu")
    run = hys.closed_loop(plant, lambda x, _: law(x), [2.5], 12)
    for k in range(12):
        assert units[0].get("speed") == pytest.approx(run.x[k].tolist(), rel=1e-12, abs=1e-12)
        units[1].set({"speed": units[0].get("speed")[0]})
        units[0].set({"u": units[1].get("u0")[0]})
        for unit in units:
            unit.step(float(k), 1.0)
