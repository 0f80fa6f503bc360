"""The written Python module steps exactly as the Dha does, and needs no package."""

import json
import random
import subprocess
import sys

import pytest
from export.models import ACCEPTED, NAMES
from hypothesis import HealthCheck, given, settings
from strategies import models

import hysdel_py as hys
from hysdel_py.export.simulator_python import module_text

LOOP = (
    "SYSTEM s { INTERFACE { STATE { BOOL b; } } IMPLEMENTATION { AUX { BOOL d, e; }"
    " LOGIC { d = e; e = d; } AUTOMATA { b = d; } } }"
)


def written(model):
    namespace = {"__name__": "written"}
    exec(module_text(model.typed, model.dha), namespace)
    return namespace


def point(variables, generator):
    return [
        float(generator.randrange(2)) if v.is_bool else generator.uniform(max(v.low, -1e3) - 1, min(v.high, 1e3) + 1)
        for v in variables
    ]


def compare(model, count, seed=0):
    module, generator = written(model), random.Random(seed)
    for _ in range(count):
        x, u = point(model.dha.x, generator), point(model.dha.u, generator)
        for ours, theirs in zip(module["step"](x, u, check=False), model.dha.step(x, u, check=False), strict=True):
            assert ours == theirs.tolist()
        try:
            model.dha.step(x, u)
            reason = None
        except hys.SimulationError as error:
            reason = str(error)
        if reason is None:
            module["step"](x, u)
        else:
            with pytest.raises(module["SimulationError"]) as refused:
                module["step"](x, u)
            assert str(refused.value) == reason


@pytest.mark.parametrize("accepted", ACCEPTED, ids=NAMES)
def test_corpus_models_step_alike(accepted):
    compare(accepted.model(), 30)


CLASH = """SYSTEM s {
  INTERFACE { STATE { REAL a(2) [0, 9]; REAL a_1 [0, 9], a_2_ [0, 9]; } INPUT { REAL u [0, 1]; } }
  IMPLEMENTATION { CONTINUOUS { a = [a(2) + u; 2*a_1]; a_1 = 3*a_2_; a_2_ = a(1); } }
}
"""


@pytest.mark.parametrize("text", ["three_tanks", CLASH], ids=["three_tanks", "clash"])
def test_vectors_step_alike(text):
    compare(hys.load(text), 100)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(models())
def test_random_models_step_alike(text):
    compare(hys.load(text), 10)


def test_file_runs_without_the_package(tmp_path):
    model = hys.load("clutch")
    (tmp_path / "clutch_step.py").write_text(module_text(model.typed, model.dha))
    code = (
        "import json, sys, clutch_step as c\n"
        "run = c.simulate(dict(zip(c.X, [150, 40, 60, 100, 0])), [[0, 0]] * 3)\n"
        "assert not [m for m in sys.modules if m.startswith(('hysdel_py', 'numpy'))]\n"
        "print(json.dumps(run))"
    )
    command = [sys.executable, "-I", "-S", "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{code}"]
    steps = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    trajectory = model.simulate([150, 40, 60, 100, 0], [[0, 0]] * 3)
    for k, (x, y, d, z) in enumerate(steps):
        assert [x, y, d, z] == [
            getattr(trajectory, n)[i].tolist() for n, i in (("x", k + 1), ("y", k), ("d", k), ("z", k))
        ]


def test_wrong_vectors_are_refused():
    step = written(hys.load("clutch"))["step"]
    for x, u in (([1], [0, 0]), ({"nothing": 1}, [0, 0]), ([float("nan")] * 5, [0, 0])):
        with pytest.raises(ValueError, match="state"):
            step(x, u)


def test_loops_and_undefined_names_are_refused():
    undefined = "SYSTEM s { INTERFACE { STATE { BOOL b; } } IMPLEMENTATION { AUX { BOOL d; } AUTOMATA { b = d; } } }"
    for text, code in ((LOOP, "HYS505"), (undefined, "HYS502")):
        model = hys.load(text)
        with pytest.raises(hys.CompileError, match=code):
            module_text(model.typed, model.dha)


def test_deep_logic_is_written_flat():
    nested = "a"
    for _ in range(2000):
        nested = f"~({nested} & b)"
    model = hys.load(
        f"SYSTEM s {{ INTERFACE {{ STATE {{ BOOL a, b; }} }} IMPLEMENTATION {{ AUX {{ BOOL d; }}"
        f" LOGIC {{ d = {nested}; }} AUTOMATA {{ a = d; b = b; }} }} }}"
    )
    step = written(model)["step"]
    for x in ([0, 0], [0, 1], [1, 0], [1, 1]):
        assert step(x)[0] == model.dha.step(x)[0].tolist()
