"""Numerical dynamic programming against enumeration, closed forms and shortest paths."""

from concurrent.futures import ThreadPoolExecutor
from itertools import product

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

import hysdel_py as hys
from hysdel_py.control.dynamic_programming.analytical import AnalyticalDp
from hysdel_py.control.dynamic_programming.grids import Axis, Mesh
from hysdel_py.control.dynamic_programming.plan import DpStatus
from hysdel_py.control.dynamic_programming.problem import DynamicProgram
from hysdel_py.control.dynamic_programming.settings import DpSettings
from hysdel_py.control.dynamic_programming.table import FeedbackTable
from hysdel_py.errors import ArgumentError


def lattice(seed, stages=4, remember=True):
    """A problem whose states stay on the nodes, so that every method must be exact."""
    rng = np.random.default_rng(seed)
    state, move, tail = rng.integers(0, 9, 11), rng.integers(0, 9, 3), rng.integers(0, 9, 11)

    def cost(x, u, x1):
        return state[x1[:, 0].astype(int) + 5] + move[u[:, 0].astype(int) + 1] + 0.0

    def change(before, u):
        size = np.abs(before - u)[:, 0]
        return np.where(size <= 1, 2.5 * size, np.inf)

    return DynamicProgram(
        lambda x, u: x + u, Axis("x", -5, 5, 11), Axis("u", -1, 1, 3), stages, cost,
        end_cost=lambda x: tail[x[:, 0].astype(int) + 5] + 0.0,
        end_set=lambda x: np.abs(x[:, 0]) <= 4,
        admissible=lambda x, u, x1: x1[:, 0] != 2,
        change_cost=change if remember else None,
    )  # fmt: skip


def enumerated(problem, x0, last):
    """The least cost over all input sequences."""
    functions, best = problem.functions, np.inf
    for inputs in product([-1.0, 0.0, 1.0], repeat=problem.stages):
        x, total, before = np.array([[x0]]), 0.0, np.array([[last]])
        for k, u in enumerate(inputs):
            given = np.array([[u]])
            x, cost = functions.step(k, x, given, problem.schedule[0].mesh)
            total += cost[0] + (functions.changes(before, given)[0, 0] if problem.change_cost else 0.0)
            if not np.isfinite(total):
                break
            before = given
        if np.isfinite(total):
            best = min(best, total + functions.end(x)[0])
    return best


@pytest.mark.parametrize("remember", [True, False])
@pytest.mark.parametrize("seed", range(6))
def test_on_a_lattice_backward_forward_and_enumeration_agree(seed, remember):
    problem = lattice(seed, remember=remember)
    table = problem.backward()
    for x0 in (-4.0, 0.0, 1.0, 5.0):
        expected = enumerated(problem, x0, 0.0)
        plan, search = table.plan([x0], [0.0]), problem.forward([x0], last_input=[0.0])
        assert plan.cost == plan.planned == search.plan.cost == expected
        assert np.array_equal(search.end_costs, np.sort(search.end_costs))
        assert search.end_costs[0] == expected


def test_forgetting_the_last_input_may_cost_something():
    """The pruning of the document never finds less, and loses somewhere."""
    losses = []
    for seed in range(12):
        problem = lattice(seed, stages=5)
        kept = problem.forward([0.0], last_input=[0.0]).plan
        pruned = problem.forward([0.0], last_input=[0.0], remember_input=False).plan
        losses.append(pruned.cost - kept.cost if pruned.ok else np.inf)
    assert min(losses) >= 0
    assert max(losses) > 0


def test_shortest_paths_on_a_grid_with_walls():
    walls = np.random.default_rng(5).random((12, 12)) < 0.25
    walls[0, 0] = walls[11, 11] = False

    def inside(x):
        return ~walls[x[:, 0].astype(int).clip(0, 11), x[:, 1].astype(int).clip(0, 11)]

    def goal(x):
        return (x == 11).all(axis=1)

    problem = DynamicProgram(
        lambda x, u: x + u, (Axis("a", 0, 11, 12), Axis("b", 0, 11, 12)),
        (Axis("da", -1, 1, 3), Axis("db", -1, 1, 3)), 40, lambda x, u, x1: np.hypot(u[:, 0], u[:, 1]),
        end_set=goal, admissible=lambda x, u, x1: inside(x1),
    )  # fmt: skip
    table = problem.backward()
    rows, columns, lengths = [], [], []
    for a, b, da, db in product(range(12), range(12), (-1, 0, 1), (-1, 0, 1)):
        c, d = a + da, b + db
        if 0 <= c < 12 and 0 <= d < 12 and (da or db) and not walls[a, b] and not walls[c, d]:
            rows, columns, lengths = [*rows, 12 * c + d], [*columns, 12 * a + b], [*lengths, np.hypot(da, db)]
    distance = dijkstra(coo_array((lengths, (rows, columns)), shape=(144, 144)), indices=143)
    free = ~walls.ravel()
    np.testing.assert_allclose(table.values[0][free, 0], distance[free], atol=1e-12)
    search = problem.forward([0.0, 0.0])
    assert search.plan.cost == pytest.approx(distance[0])


A, B = np.array([[1.0, 0.5], [0.0, 1.0]]), np.array([[0.125], [0.5]])


def regulator(cells, stages=4):
    """A double integrator with quadratic cost; inputs twice as fine as the states."""

    def cost(x, u, x1):
        return 0.5 * (x**2).sum(axis=1) + 0.1 * u[:, 0] ** 2

    return DynamicProgram(
        lambda x, u: x @ A.T + u @ B.T, (Axis("s", -2, 2, cells + 1), Axis("v", -2, 2, cells + 1)),
        Axis("a", -4, 4, 4 * cells + 1), stages, cost, end_cost=lambda x: 2 * (x**2).sum(axis=1),
    )  # fmt: skip


def test_quadratic_cost_converges_with_order_two():
    exact = optimum()
    points = np.random.default_rng(0).uniform(-0.8, 0.8, (20, 2))
    errors = []
    for cells in (8, 16, 32):
        table = regulator(cells).backward()
        found = np.array([table.value(x) - exact.value(x) for x in points])
        assert found.min() > 0, "linear interpolation of a convex function lies above it"
        errors.append(found.mean())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 1.7
    assert errors[-1] < 0.03


def optimum():
    """The regulator in closed form."""
    return AnalyticalDp(A, B, 4, Q=np.eye(2), R=[[0.2]], P=4 * np.eye(2)).solve()


def least_time(cells, dt=0.25):
    """The double integrator to the origin; steps that end near it count by their length only."""

    def step(x, u):
        return np.stack([x[:, 0] + dt * x[:, 1] + dt**2 / 2 * u[:, 0], x[:, 1] + dt * u[:, 0]], axis=1)

    return DynamicProgram(
        step, (Axis("s", -2, 2, cells + 1), Axis("v", -2, 2, cells + 1)), Axis("a", -1, 1, 3), round(3 / dt),
        lambda x, u, x1: dt * (np.abs(x).max(axis=1) > 1e-9), end_set=lambda x: np.abs(x).max(axis=1) < 1e-9,
    )  # fmt: skip


def test_least_time_of_the_double_integrator():
    """From (1, 0) to the origin: 2 s. The switching curve passes through nodes for dt = 1/4 and cells of 1/32."""
    table = least_time(128).backward()
    run = table.plan([1.0, 0.0])
    assert run.cost == pytest.approx(2.0)
    np.testing.assert_allclose(run.trajectory.u[:8, 0], [-1, -1, -1, -1, 1, 1, 1, 1])


def test_refinement_finds_what_a_fine_grid_finds():
    x0 = np.array([0.5, -0.25])
    coarse = regulator(8).backward().plan(x0)
    passes = regulator(8).refine(x0, 3, band=2)
    fine = regulator(32).backward().plan(x0)
    assert passes.plan.cost <= coarse.cost
    assert passes.plan.cost == pytest.approx(fine.cost, rel=2e-3)
    widest = max(stage.mesh.size for stage in passes.table.schedule)
    assert widest < regulator(32).schedule[0].mesh.size / 4


def test_refinement_where_changes_cost_something():
    passes = lattice(1).refine([0.0], 2, last_input=[0.0])
    assert passes.plan.cost <= passes.plans[0].cost


def test_the_table_does_not_depend_on_the_executor():
    alone = lattice(3).backward()
    with ThreadPoolExecutor(2) as pool:
        together = lattice(3).backward(executor=pool)
    assert all(np.array_equal(a, b) for a, b in zip(alone.values, together.values, strict=True))
    assert all(np.array_equal(a, b) for a, b in zip(alone.policy, together.policy, strict=True))


def test_neither_chunks_nor_kept_transitions_matter():
    whole = lattice(3).backward()
    problem = lattice(3)
    object.__setattr__(problem, "settings", DpSettings(chunk=7, keep=1))
    parts = problem.backward()
    assert all(np.array_equal(a, b) for a, b in zip(whole.values, parts.values, strict=True))


def test_a_table_from_a_file(tmp_path):
    table = lattice(4).backward()
    table.save(tmp_path / "table.npz")
    again = FeedbackTable.load(tmp_path / "table.npz")
    for x in (-3.0, 0.0, 1.0):
        stored = again([x], 1, [0.0])
        assert np.array_equal(stored, table([x], 1, [0.0], "interpolate"))
        assert np.array_equal(stored, table([x], 1, [0.0], "lookahead"))
    with pytest.raises(ArgumentError, match="does not know the plant"):
        again([0.0], 0, [0.0], "lookahead")
    (tmp_path / "other.npz").write_bytes(b"no")
    with pytest.raises(ArgumentError, match=r"not an \.npz file"):
        FeedbackTable.load(tmp_path / "other.npz")


@pytest.mark.parametrize("law", ["lookahead", "interpolate", "nearest"])
def test_in_a_closed_loop(law):
    problem = lattice(2)
    table = problem.backward()
    run = hys.closed_loop(problem, table.controller(law), {"x": 1.0}, 6, last_input={"u": 0.0})
    assert run.steps == problem.stages
    assert "the table ends after 4 stages" in run.messages[-1]
    np.testing.assert_array_equal(run.u, table.plan([1.0], [0.0]).trajectory.u)
    assert run.names["x"] == ("x",)


def test_stored_inputs_are_mixed_over_feasible_corners():
    table = regulator(16).backward()
    x = np.array([0.3, 0.1])
    ahead, mixed = table(x, 0), table(x, 0, law="interpolate")
    assert abs(ahead - mixed) < 0.2
    assert abs(mixed - optimum()(x)) < 0.1
    assert table([5.0, 0.0], 0, law="interpolate") is None


def test_a_compiled_model_as_plant():
    model = hys.load(
        "SYSTEM s { INTERFACE { STATE { REAL x [-5, 5]; } INPUT { REAL u [-1, 1]; } } "
        "IMPLEMENTATION { CONTINUOUS { x = x + u; } } }"
    )
    problem = DynamicProgram(
        model, Axis("x", -5, 5, 11), Axis("u", -1, 1, 3), 3, lambda x, u, x1: x1[:, 0] ** 2, settings=DpSettings()
    )
    plan = problem.backward().plan([2.0])
    assert plan.cost == 1.0
    np.testing.assert_array_equal(plan.trajectory.u[:, 0], [-1, -1, 0])


def test_what_depends_on_the_stage():
    problem = DynamicProgram(
        lambda x, u, k: x + u, Axis("x", -5, 5, 11), Axis("u", -1, 1, 3), 3,
        lambda x, u, x1, k: (x1[:, 0] - [1, 2, 1][k]) ** 2, time_varying=True,
    )  # fmt: skip
    plan = problem.backward().plan([0.0])
    assert plan.cost == problem.forward([0.0]).plan.cost == 0
    np.testing.assert_array_equal(plan.trajectory.x[:, 0], [0, 1, 2, 1])


def test_no_way_is_said_with_the_place():
    problem = DynamicProgram(
        lambda x, u: x + u, Axis("x", -5, 5, 11), Axis("u", -1, 1, 3), 2, lambda x, u, x1: 0.0,
        end_set=lambda x: x[:, 0] >= 4,
    )  # fmt: skip
    plan, search = problem.backward().plan([0.0]), problem.forward([0.0])
    assert plan.status is search.plan.status is DpStatus.INFEASIBLE
    assert "x = 0" in plan.message
    assert "none of the 5 states reached" in search.plan.message
    assert problem.backward().controller().solve([0.0]).u is None


def test_interruption_keeps_what_is_finished():
    def interrupt(done, stages):
        if done == 2:
            raise KeyboardInterrupt

    table = lattice(0).backward(progress=interrupt)
    assert table.first == 2
    assert not table.complete
    assert table.plan([0.0], [0.0]).status is DpStatus.INTERRUPTED
    assert table([0.0], 2, [0.0]) is not None
    search = lattice(0).forward([0.0], last_input=[0.0], progress=interrupt)
    assert search.plan.status is DpStatus.INTERRUPTED
    assert len(search.reached) == 3


def test_too_much_memory_is_refused_before_the_start():
    axes = tuple(Axis(name, 0, 1, 1000) for name in "abc")
    problem = DynamicProgram(lambda x, u: x, axes, Axis("u", 0, 1, 2), 5, lambda x, u, x1: 0.0)
    assert problem.memory()["table"] > 5e10
    with pytest.raises(ArgumentError, match=r"needs .* GB"):
        problem.backward()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"cost": lambda x, u, x1: np.nan * x[:, 0]}, "cost returned NaN"),
        ({"cost": lambda x, u, x1: np.zeros(3)}, "cost returned shape"),
        ({"plant": lambda x, u: x[:, 0]}, "plant returned shape"),
        ({"end_set": lambda x: x[:, 0]}, "end_set returned float64"),
        ({"plant": 3}, "plant is a int"),
        ({"stages": 0}, "stages is 0"),
        ({"states": ()}, "states is"),
        ({"inputs": Axis("x", 0, 1, 2)}, "used twice"),
        ({"sample_time": 0}, "sample_time is 0"),
    ],
)
def test_wrong_arguments(changes, message):
    given = {
        "plant": lambda x, u: x + u, "states": Axis("x", -5, 5, 11), "inputs": Axis("u", -1, 1, 3), "stages": 2,
        "cost": lambda x, u, x1: 0.0 * x[:, 0],
    }  # fmt: skip
    with pytest.raises(ArgumentError, match=message):
        DynamicProgram(**(given | changes)).backward()


def test_wrong_axes_states_and_laws():
    for arguments in (("x", 0, np.inf, 3), ("x", 1, 0, 3), ("x", 0, 1, 0), ("x", 0, 1, 1)):
        with pytest.raises(ArgumentError, match="axis x"):
            Axis(*arguments)
    with pytest.raises(ArgumentError, match="does not divide"):
        Axis.spaced("x", 0, 1, 0.3)
    table = lattice(0).backward()
    for call, message in (
        (lambda: table([0.0, 1.0]), "state"),
        (lambda: table([0.0], 9), "stage is 9"),
        (lambda: table([0.0], 0, [0.0], "guess"), "law is 'guess'"),
        (lambda: table([0.0], 0, None, "nearest"), "last_input is missing"),
        (lambda: lattice(0).forward([9.0]), "a state on the axes"),
        (lambda: lattice(0).refine([0.0], 0), "passes is 0"),
    ):
        with pytest.raises(ArgumentError, match=message):
            call()


def test_interpolation_is_exact_for_multilinear_functions():
    mesh = Mesh((Axis("a", 0, 2, 5), Axis("b", -1, 1, 3), Axis("c", 3, 3, 1)))
    nodes = mesh.nodes()
    values = 1 + nodes[:, 0] - 2 * nodes[:, 1] + 3 * nodes[:, 0] * nodes[:, 1]
    x = np.random.default_rng(0).uniform([0, -1, 3], [2, 1, 3], (50, 3))
    base, fraction = mesh.cell(x)
    assert mesh.holds(x).all()
    found = sum(weight * values[base + offset] for offset, weight in mesh.corners(fraction))
    np.testing.assert_allclose(found, 1 + x[:, 0] - 2 * x[:, 1] + 3 * x[:, 0] * x[:, 1])
    assert not mesh.holds(np.array([[2.1, 0, 3]]))[0]
