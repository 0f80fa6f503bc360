"""Sweeps on executors of clusters: Dask where it is installed, and the class for Ray of the how-to on a stand-in."""

import importlib
import re
import sys
import types
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import hysdel_py as hys

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "scale-out.md"


def root(seed):
    """A task that fails at times."""
    if seed == 3:
        raise ValueError(f"{seed} will not do")
    return float(seed) ** 0.5


def block(head):
    """What follows in a block of the page that begins so."""
    page = PAGE.read_text(encoding="utf-8")
    return re.search(re.escape(head) + r"(.*?)^```$", page, re.MULTILINE | re.DOTALL)[1]


@pytest.fixture
def study(tmp_path, monkeypatch):
    """The module of the page, and its file."""
    file = tmp_path / "tank_study.py"
    file.write_text(block('title="tank_study.py"\n'), encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module("tank_study"), file
    sys.modules.pop("tank_study")


def test_dask(study, tmp_path):
    """Two processes of a local cluster do what this process does."""
    distributed = pytest.importorskip("distributed", reason="dask[distributed] is not installed: not tested here")
    module, file = study
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        client.upload_file(str(file))
        pool = client.get_executor()
        found = hys.sweep(module.settle, range(5), executor=pool, resume=tmp_path / "run.jsonl", window=3)
    assert found == hys.sweep(module.settle, range(5), resume=tmp_path / "here.jsonl")
    assert found.failure_text() == "seed 3: RuntimeError: sensor model diverged"


class Reference:
    """What Ray calls an ObjectRef, as far as its conversion to a future goes."""

    def __init__(self, future):
        self._future = future

    def future(self):
        return self._future


@pytest.fixture
def ray(monkeypatch):
    """A module with the two calls of Ray that the page uses, on threads."""
    pool = ThreadPoolExecutor(2)

    def remote(function):
        return types.SimpleNamespace(remote=lambda *arguments: Reference(pool.submit(function, *arguments)))

    module = types.SimpleNamespace(remote=remote, init=lambda: None)
    monkeypatch.setitem(sys.modules, "ray", module)
    with pool:
        yield module


def test_the_executor_for_ray_of_the_page(ray):
    program = "import ray" + block("```python\nimport ray")
    namespace = {"hys": hys, "settle": root}
    exec(program.replace("range(1000)", "range(6)"), namespace)
    assert namespace["found"] == hys.sweep(root, range(6))
