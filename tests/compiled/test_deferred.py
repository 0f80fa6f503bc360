"""Kernels that wait for those that Python calls: what they give, and what is made of them."""

import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

from hysdel_py.compiled import caching, compiled, kernels_are_compiled, leaf
from hysdel_py.compiled import decorators as module

needs_numba = pytest.mark.skipif(not kernels_are_compiled(), reason="nothing is compiled without numba")


@leaf
def scaled(x, at, factor):
    """Multiply one entry."""
    x[at] *= factor


@compiled
def doubled(x, deep):
    """A copy, twice as large, the first entry four times where `deep`."""
    result = x.copy()
    for i in range(len(x)):
        scaled(result, i, 2)
    if deep:
        scaled(result, 0, 2)
    return result


@compiled
def quarrelsome(x):
    """What raises inside another kernel."""
    if x < 0.0:
        raise ValueError("below zero")
    return np.sqrt(x)


@compiled
def root_of_sum(x):
    """Root of a sum."""
    return quarrelsome(x.sum())


def test_a_kernel_inside_another_one_gives_what_it_gives_in_python():
    assert doubled(np.array([1.0, 3.0]), True).tolist() == [4.0, 6.0]
    assert doubled(np.array([1.0, 3.0]), False).tolist() == [2.0, 6.0]
    x = np.array([1.0, 3.0])
    scaled(x, 1, 3.0)
    assert x.tolist() == [1.0, 9.0]


def test_errors_of_a_kernel_inside_another_one_reach_python():
    assert root_of_sum(np.array([1.0, 3.0])) == 2.0
    with pytest.raises(ValueError, match="below zero"):
        root_of_sum(np.array([1.0, -3.0]))


@needs_numba
def test_only_what_python_calls_becomes_machine_code():
    root_of_sum(np.ones(3))
    assert len(root_of_sum.entry.signatures) == 1
    assert not quarrelsome.entry.signatures
    kinds = [type(found.entry_point) for found in quarrelsome.overloads.values()]
    assert kinds in ([], [object])  # none where the machine code came from the disk


@needs_numba
def test_constants_and_variables_share_one_code():
    @leaf
    def raised(x, at, by):
        x[at] += by

    @compiled
    def both(x, at):
        raised(x, 0, 2)
        raised(x, at, at + 1)

    x = np.ones(2)
    both(x, 1)
    assert x.tolist() == [3.0, 3.0]
    assert len(raised.overloads) == 1


@needs_numba
def test_a_kernel_is_pickled_by_its_name():
    from hysdel_py.optimize.kernels.linear import dot

    assert pickle.loads(pickle.dumps(dot)) is dot


@needs_numba
def test_numba_alone_will_do(monkeypatch):
    monkeypatch.setattr(module, "_kernel", lambda: caching.cached)

    @compiled
    def three():
        return 3

    assert three() == 3
    assert three.signatures


@needs_numba
def test_who_listens_is_told_of_what_is_compiled_and_not_of_what_is_on_disk(tmp_path):
    text = (
        "import sys, numpy as np\n"
        "from hysdel_py.compiled import told_of_compiling\n"
        "from hysdel_py.optimize.kernels.linear import dot\n"
        "from hysdel_py.optimize.kernels.residual import violations\n"
        "told = []\n"
        "with told_of_compiling(lambda: told.append(0)):\n"
        "    rows = (np.array([0, 1]), np.array([0]), np.ones(1))\n"
        "    violations(rows, -np.ones(1), np.ones(1), -np.ones(1), np.ones(1), np.zeros(1))\n"
        "dot(np.ones(1), np.ones(1))  # nobody listens any more\n"
        "print(len(told))\n"
    )
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", text]
    said = [
        subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout for _ in range(2)
    ]
    assert [int(words) for words in said] == [1, 0]
