"""Plain kernels before compiled ones: the same numbers, and an end to it."""

import os
import subprocess
import sys
from hashlib import sha256
from threading import Thread
from types import FunctionType

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hysdel_py as hys
from hysdel_py.compiled import kernels_are_compiled, kernels_wait
from hysdel_py.geometry import head_start
from hysdel_py.geometry.head_start import HeadStart
from hysdel_py.geometry.interpreted import programs as plain
from hysdel_py.geometry.kernels import programs as compiled

needs_numba = pytest.mark.skipif(not kernels_are_compiled(), reason="nothing is compiled without numba")

NUMBERS = st.one_of(st.integers(-3, 3).map(float), st.floats(-10, 10, width=32))


@st.composite
def linear_programs(draw):
    """Costs, rows, sides and ends, often degenerate, infeasible or unbounded."""
    n, m, k = draw(st.integers(1, 4)), draw(st.integers(0, 6)), draw(st.integers(1, 3))
    entries = st.lists(NUMBERS, min_size=(k + m) * n + m, max_size=(k + m) * n + m)
    numbers = np.array(draw(entries))
    C, A, b = numbers[: k * n].reshape(k, n), numbers[k * n : (k + m) * n].reshape(m, n), numbers[(k + m) * n :]
    ends = st.sampled_from([0.0, 1.0, 5.0, np.inf])
    low = -np.array(draw(st.lists(ends, min_size=n, max_size=n)))
    return C, A, b.copy(), low, np.array(draw(st.lists(ends, min_size=n, max_size=n)))


def answers(kernels, C, A, b, lb, ub):
    """Status and all bits that a kernel leaves."""
    (m, n), k = A.shape, len(C)
    outs = np.zeros((k, n)), np.zeros((k, m)), np.zeros(k), np.zeros(k)
    room = np.empty(n, np.int64), np.empty(m, np.int64), np.empty((n, n)), np.empty((5, n)), np.empty((m, n))
    with np.errstate(all="ignore"):
        status = kernels.maximised(C, A, b, lb, ub, 1e-9, -1.0, *outs, *room, np.empty((2, m)))
    return status, [array.tobytes() for array in outs]


@needs_numba
@settings(max_examples=300, deadline=None)
@given(linear_programs())
def test_plain_and_compiled_programs_agree_to_the_last_bit(program):
    assert answers(plain, *program) == answers(compiled, *program)


@needs_numba
@settings(max_examples=200, deadline=None)
@given(linear_programs())
def test_plain_and_compiled_screening_agree_to_the_last_bit(program):
    _, A, b, _, _ = program
    left = []
    for kernels in (plain, compiled):
        m = len(b)
        outs = np.zeros(A.shape), np.zeros(m), np.zeros(m, np.int64), np.zeros(m), np.zeros(m, np.bool_)
        with np.errstate(all="ignore"):
            count = kernels.screened(A, b, np.zeros((1, A.shape[1])), 1e-12, *outs)
        left.append((count, [array.tobytes() for array in outs]))
    assert left[0] == left[1]


@needs_numba
def test_one_file_makes_a_plain_module_and_a_compiled_one():
    assert plain.__file__ == compiled.__file__
    assert isinstance(plain.maximised, FunctionType)
    assert isinstance(plain.solved, FunctionType)
    assert not isinstance(compiled.maximised, FunctionType)


def test_the_start_ends_with_the_first_program_that_asks_for_more(monkeypatch):
    monkeypatch.delitem(sys.modules, "numba", raising=False)
    start = HeadStart(10)
    assert [start.lasts(entries) for entries in (4, 0, 6, 0, 1, 0)] == [True, True, True, True, False, False]


def test_the_start_ends_where_numba_is_loaded(monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", object())
    assert not HeadStart(10).lasts()
    assert not kernels_wait()


def test_nothing_waits_where_nothing_is_compiled(monkeypatch):
    monkeypatch.delitem(sys.modules, "numba", raising=False)
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    assert not kernels_wait()
    monkeypatch.delenv("NUMBA_DISABLE_JIT")
    monkeypatch.setattr("hysdel_py.compiled.decorators.find_spec", lambda name: None)
    assert not kernels_wait()


def test_plain_kernels_are_as_quiet_as_compiled_ones():
    """A coefficient and a side whose quotient is beyond all numbers."""
    A, b, far = np.array([[1e-150, 0.0]]), np.array([1e300]), np.full(2, np.inf)
    room = np.empty(2, np.int64), np.empty(1, np.int64), np.empty((2, 2)), np.empty((5, 2)), np.empty((1, 2))
    outs = np.zeros((1, 2)), np.zeros((1, 1)), np.zeros(1), np.zeros(1)
    given_ = np.ones((1, 2)), A, b, -far, far, 1e-9, -1.0, *outs, *room, np.empty((2, 1))
    with np.errstate(all="raise"):
        with pytest.raises(FloatingPointError):
            plain.maximised(*given_)
        head_start._plain().maximised(*given_)


BEYOND_ALL_NUMBERS = """
import numpy as np
from hysdel_py.geometry.small_programs import greatest_values
far = np.full(2, np.inf)
A, b = np.array([[1e-150, 0.0]]), np.array([1e300])
with np.errstate(all="raise"):
    print(greatest_values(np.ones((1, 2)), A, b, -far, far, tolerance=1e-9).values)
"""


@pytest.mark.parametrize("disabled", ["1", ""])
def test_programs_are_quiet_with_and_without_a_compiler(disabled):
    environment = os.environ | {"NUMBA_DISABLE_JIT": disabled}
    command = [sys.executable, "-c", BEYOND_ALL_NUMBERS]
    run = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert (run.stdout, run.stderr) == ("[inf]\n", "")


def test_threads_that_run_plain_kernels_keep_what_they_say_of_overflow():
    """A kernel of another thread begins and ends while this one runs."""

    def other():
        with np.errstate(all="warn"):
            quiet(False)

    def kernel(is_outer):
        if is_outer:
            thread = Thread(target=other)
            thread.start()
            thread.join()

    quiet = head_start._quietly(kernel)
    with np.errstate(all="raise"):
        before = np.geterr()
        quiet(True)
        assert np.geterr() == before


PRINT_FORM = """
import sys
from hashlib import sha256
import hysdel_py as hys
mld = hys.load("clutch").mld
print(sha256(repr([getattr(mld, name).toarray().tolist() for name in ("E1", "E2", "E3", "E4")]).encode()
             + mld.E5.tobytes()).hexdigest(), "numba" in sys.modules)
"""


@needs_numba
def test_a_form_is_the_same_whoever_solved_its_programs():
    run = subprocess.run([sys.executable, "-c", PRINT_FORM], capture_output=True, text=True, check=True)
    mld = hys.load("clutch").mld
    entries = repr([getattr(mld, name).toarray().tolist() for name in ("E1", "E2", "E3", "E4")])
    assert run.stdout.split() == [sha256(entries.encode() + mld.E5.tobytes()).hexdigest(), "False"]
