"""What may be wrong with the arguments of a dynamic program, and what is none of its business."""

from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

from hysdel_py.control.dynamic_programming.analytical import AnalyticalDp
from hysdel_py.control.dynamic_programming.grids import Axis
from hysdel_py.control.dynamic_programming.plan import DpStatus
from hysdel_py.control.dynamic_programming.problem import DynamicProgram
from hysdel_py.control.dynamic_programming.settings import DpSettings
from hysdel_py.control.dynamic_programming.table import FeedbackTable
from hysdel_py.errors import ArgumentError

NAN = float("nan")


def line(**changes):
    """Steps of at most one on a line of five nodes; the cost is the square of the next state."""
    given = {
        "plant": lambda x, u: x + u, "states": Axis("x", -2, 2, 5), "inputs": Axis("u", -1, 1, 3), "stages": 3,
        "cost": lambda x, u, x1: x1[:, 0] ** 2,
    }  # fmt: skip
    return DynamicProgram(**(given | changes))


def integrator(**changes):
    given = {"A": np.eye(2), "B": [[0.0], [1.0]], "stages": 2, "Q": np.eye(2), "R": [[1.0]]}
    return AnalyticalDp(**(given | changes))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Axis("x", 0, 1, NAN), "number of values of axis x is nan"),
        (lambda: Axis("x", 0, 0, True), "number of values of axis x is True"),
        (lambda: Axis("x", 0, "1", 3), "finite ends"),
        (lambda: Axis.spaced("x", 1, 0, 0.5), "low <= high"),
        (lambda: Axis.spaced("x", 0, np.inf, 0.5), "finite ends"),
        (lambda: Axis.spaced("x", 0, 1, NAN), "step of axis x is nan"),
        (lambda: line(stages=NAN), "stages is nan"),
        (lambda: line(stages=None), "stages is None"),
        (lambda: line(sample_time="fast"), "sample_time is 'fast'"),
        (lambda: line(end_set=3), "end_set is a int"),
        (lambda: DpSettings(chunk=0.5), "chunk is 0.5"),
        (lambda: DpSettings(least_weight=2.0), "least_weight is 2.0: a share"),
        (lambda: DpSettings(memory="much"), "memory is 'much'"),
        (lambda: line().backward()([0.0], 1.5), "stage is 1.5"),
        (lambda: integrator(stages=NAN), "stages is nan"),
        (lambda: integrator(A=[[1, 2], [3]]), "A is no array of numbers"),
        (lambda: AnalyticalDp.from_continuous(np.eye(2), [0.0, 1.0], 0.1), r"B \(2,\)"),
        (lambda: AnalyticalDp.from_continuous(np.eye(2), [[0.0], [1.0]], -1.0), "sample_time is -1.0"),
        (lambda: integrator().solve().value([1, 1], -1), "stage is -1"),
        (lambda: integrator().solve().value([1, 1], 3), "stage is 3"),
        (lambda: integrator().solve().simulate([1, 1], np.zeros((1, 2))), r"disturbance has shape \(1, 2\)"),
        (lambda: integrator().solve().simulate([1, 1], np.full((2, 2), NAN)), "disturbance"),
    ],
)
def test_wrong_arguments_are_told(make, message):
    with pytest.raises(ArgumentError, match=message):
        make()


def test_whole_numbers_may_be_floats():
    assert line(stages=3.0, states=Axis("x", -2, 2, 5.0)).backward().value([1.0]) == 0.0


@pytest.mark.parametrize("count", [60_000, 10**13])
def test_inputs_beyond_the_memory_are_refused_before_they_are_made(count):
    problem = line(inputs=Axis("u", -1, 1, count), change_cost=lambda a, b: np.abs(a - b)[:, 0])
    for search in (problem.backward, problem.memory, lambda: problem.forward([0.0])):
        with pytest.raises(ArgumentError, match=r"changes of input need .* GB"):
            search()


def test_a_start_off_the_axes_has_no_plan():
    table = line().backward()
    plan = table.plan([3.0])
    assert plan.status is DpStatus.INFEASIBLE
    assert "x = 3, lies off the axes: x from -2 to 2" in plan.message
    assert table.value([3.0]) == np.inf
    np.testing.assert_array_equal(table([3.0]), [-1.0])  # a controller may still lead back


def test_costs_count_within_the_constraints_only():
    """A root of a negative number where a constraint forbids the state is no mistake."""

    def root(x):
        with np.errstate(invalid="ignore"):
            return np.sqrt(x[:, 0])

    problem = line(
        cost=lambda x, u, x1: root(x1), admissible=lambda x, u, x1: x1[:, 0] >= 0,
        end_cost=root, end_set=lambda x: x[:, 0] >= 0,
    )  # fmt: skip
    assert problem.backward().value([2.0]) == pytest.approx(1.0)
    assert problem.forward([2.0]).plan.cost == pytest.approx(1.0)
    with pytest.raises(ArgumentError, match="cost returned NaN"):
        line(cost=lambda x, u, x1: root(x1)).backward()


def test_a_function_that_changes_its_arguments_is_stopped():
    def plant(x, u):
        x += u
        return x

    with pytest.raises(ValueError, match="read-only"):
        line(plant=plant).backward()


def test_functions_that_processes_cannot_find_are_told():
    with ProcessPoolExecutor(1) as pool, pytest.raises(ArgumentError, match="cannot be sent to processes"):
        line().backward(executor=pool)


def test_an_empty_end_set_and_single_points():
    nothing = line(end_set=lambda x: np.zeros(len(x), dtype=bool))
    assert nothing.backward().plan([0.0]).status is DpStatus.INFEASIBLE
    assert nothing.forward([0.0]).plan.status is DpStatus.INFEASIBLE
    assert nothing.refine([0.0]).plan.status is DpStatus.INFEASIBLE
    point = line(states=Axis("x", 1, 1, 1), inputs=Axis("u", 0, 0, 1))
    assert point.backward().value([1.0]) == 3.0
    assert point.refine([1.0], 2).plan.cost == 3.0


def test_files_that_are_no_tables(tmp_path):
    (tmp_path / "empty.npz").touch()
    np.save(tmp_path / "array.npy", np.zeros(3))
    np.savez(tmp_path / "part.npz", format=np.array(2), remembers=np.array(False))
    np.savez(tmp_path / "other.npz", format=np.arange(3))
    for name in ("empty.npz", "array.npy", "part.npz", "other.npz", "none.npz"):
        with pytest.raises(ArgumentError, match=name):
            FeedbackTable.load(tmp_path / name)


def test_a_table_from_a_file_asks_for_the_same_weight(tmp_path):
    table = line(settings=DpSettings(least_weight=0.6), end_set=lambda x: x[:, 0] >= 2).backward()
    table.save(tmp_path / "table.npz")
    loaded = FeedbackTable.load(tmp_path / "table.npz")
    assert table([-1.5], 0, law="interpolate") is None
    assert loaded([-1.5], 0) is None
