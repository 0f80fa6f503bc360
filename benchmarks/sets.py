"""Polyhedra beside polytope, pypoman and pycddlib: right answers and time, case by case.

python benchmarks/sets.py             both tables, as in docs/geometry.md
python benchmarks/sets.py --repeat N  the least time of N calls counts (default 3)

The tools that are not installed are left out (pip install polytope pypoman pycddlib). Expected answers are known by
construction, or come from linear programs of scipy on the set itself.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from set_tools import TOOLS

Array = NDArray[np.float64]

SHARE = 1e-6
"""Relative error, in units of the size of each coordinate, up to which an answer is right."""


@dataclass(frozen=True)
class Case:
    """``A w <= b``, what is known of it, and the size of each coordinate."""

    name: str
    A: Array
    b: Array
    vertices: Array | None = None  # of a bounded one
    volume: float | None = None
    facets: int | None = None  # rows that are needed, of one with inner points
    empty: bool = False

    @property
    def scale(self) -> Array:
        """Size of each coordinate."""
        return np.ones(self.A.shape[1]) if self.vertices is None else np.maximum(np.ptp(self.vertices, axis=0), 1e-12)


def box(name: str, low: Any, high: Any) -> Case:
    """A box; flat where ends are equal."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    n, eye = len(low), np.eye(len(low))
    corners = np.unique(np.array(list(product(*zip(low, high, strict=True)))), axis=0)
    facets = 2 * n if np.all(low < high) else None
    return Case(name, np.vstack([eye, -eye]), np.concatenate([high, -low]), corners, float(np.prod(high - low)), facets)


def ball_like(name: str, n: int, rows: int, seed: int) -> Case:
    """Random half-spaces around the unit ball, each repeated looser: bounded, half of the rows not needed."""
    draw = np.random.default_rng(seed)
    A = draw.normal(size=(rows, n))
    A = np.vstack([A / np.linalg.norm(A, axis=1, keepdims=True), np.eye(n), -np.eye(n)])
    b = np.concatenate([np.ones(rows), np.full(2 * n, 1.5)])
    return Case(name, np.vstack([A, A]), np.concatenate([b, 2 * b]))


def cases() -> tuple[Case, ...]:
    """Sets that ask for nothing special, then those that often do."""
    simplex = np.vstack([np.zeros(3), np.eye(3)])
    pyramid = np.array([[1, 0, 1], [-1, 0, 1], [0, 1, 1], [0, -1, 1], [0, 0, -1]], dtype=float)
    tip = np.array([[1, 1, 0], [1, -1, 0], [-1, 1, 0], [-1, -1, 0], [0, 0, 1]], dtype=float)
    turn = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    sliver = np.array([[-1, -5e-7], [-1, 5e-7], [1, -5e-7], [1, 5e-7]], dtype=float) @ turn.T
    eye = np.eye(2)
    return (
        box("square", [-1, -1], [1, 1]),
        box("box in 4", [-1] * 4, [1, 2, 3, 4]),
        Case("simplex in 3", np.vstack([-np.eye(3), np.ones(3)]), np.array([0, 0, 0, 1.0]), simplex, 1 / 6, 4),
        Case("pyramid, 4 rows at its tip", pyramid, np.array([1, 1, 1, 1, 0.0]), tip, 4 / 3, 5),
        ball_like("40 rows in 2", 2, 16, 1),
        ball_like("76 rows in 3", 3, 32, 2),
        ball_like("64 rows in 4", 4, 24, 3),
        box("interval", [-1], [2]),
        box("point in 2", [1, 2], [1, 2]),
        box("segment in 3", [0, 0, 1], [1, 0, 1]),
        box("flat square in 3", [0, 0, 1], [1, 1, 1]),
        box("1e-5 by 1 by 1e6", [0, 0, 0], [1e-5, 1, 1e6]),
        box("far away", [1e5, 1e5], [1e5 + 1, 1e5 + 1]),
        Case("thin, turned", np.vstack([eye, -eye]) @ turn.T, np.array([1, 5e-7, 1, 5e-7]), sliver, 2e-6, 4),
        Case("quadrant", -eye, np.zeros(2), facets=2),
        Case("strip", np.array([[1.0, 0], [-1, 0]]), np.ones(2), facets=2),
        Case("empty", np.vstack([eye, -eye]), np.array([1.0, 1, -2, 1]), empty=True),
    )


# ---- whether an answer is right ------------------------------------------------------------------------------------


def expected(operation: str, case: Case) -> Any:
    """What is known of the answer; None where the operation does not apply to the case."""
    known = {
        "empty": case.empty,
        "vertices": case.vertices,
        "volume": case.volume,
        "minimal": case.facets,
        "hull": case.vertices,
        "rays": {"quadrant": (1, 2), "strip": (2, 2)}.get(case.name),
        "project": None if case.empty else shadow(case),
    }[operation]
    if operation == "vertices" and known is None and case.name.split()[1:2] == ["rows"]:
        return "held"
    return "hulled" if operation == "minimal" and known is None and case.name.split()[1:2] == ["rows"] else known


def shadow(case: Case) -> tuple[float, float]:
    """Ends of the first coordinate."""
    n = case.A.shape[1]
    ends = []
    for sign in (1.0, -1.0):
        answer = linprog(sign * np.eye(n)[0], case.A, case.b, bounds=(None, None), method="highs-ds")
        ends.append(sign * answer.fun if answer.status == 0 else -sign * np.inf)
    return ends[0], ends[1]


def is_right(operation: str, case: Case, answer: Any, wanted: Any) -> bool:
    """Whether an answer is the expected one."""
    match operation:
        case "empty" | "rays":
            return bool(np.all(answer == wanted))
        case "minimal":
            return answer == (needed(case) if isinstance(wanted, str) else wanted)
        case "volume":
            return abs(answer - wanted) <= SHARE * max(abs(wanted), 1e-30) if wanted else abs(answer) <= 1e-12
        case "vertices":
            return holds_vertices(case, answer) if isinstance(wanted, str) else same_points(answer, wanted, case.scale)
        case "hull":
            return same_support(answer, wanted, case.scale)
        case _:
            return same_interval(answer, wanted)


def needed(case: Case) -> int:
    """Rows whose half-space cuts something off, by one linear program each."""
    count = 0
    A, b = case.A[: len(case.b) // 2], case.b[: len(case.b) // 2]
    for i in range(len(b)):
        rest = np.arange(len(b)) != i
        answer = linprog(-A[i], A[rest], b[rest], bounds=(None, None), method="highs-ds")
        count += answer.status != 0 or -answer.fun > b[i] + 1e-9
    return count


def holds_vertices(case: Case, found: Any) -> bool:
    """Whether the points lie in the set, n rows hold at each, and their greatest values are those of the set."""
    points = np.asarray(found, dtype=float)
    slack = case.b - points @ case.A.T
    if len(points) == 0 or slack.min() < -SHARE or np.any(np.sum(slack <= SHARE, axis=1) < case.A.shape[1]):
        return False
    for row in np.random.default_rng(0).normal(size=(20, case.A.shape[1])):
        best = -linprog(-row, case.A, case.b, bounds=(None, None), method="highs-ds").fun
        if abs((points @ row).max() - best) > SHARE:
            return False
    return True


def same_points(found: Any, wanted: Array, scale: Array) -> bool:
    if found is None:
        return False
    points = np.asarray(found, dtype=float)
    if points.ndim != 2 or points.shape[1] != wanted.shape[1]:
        return False
    apart = np.abs(points[:, None] - wanted[None]) / scale
    near = apart.max(axis=2) <= SHARE * np.maximum(1.0, (np.abs(wanted) / scale * 1e-9).max())
    return bool(near.any(axis=0).all() and near.any(axis=1).all())


def same_support(found: tuple[Array, Array], wanted: Array, scale: Array) -> bool:
    """Whether the rows hold the points, and reach no farther than them along random directions."""
    A, b = np.asarray(found[0], dtype=float) * scale, np.asarray(found[1], dtype=float)
    sizes = np.maximum(np.linalg.norm(A, axis=1), 1e-300)
    A, b, points = A / sizes[:, None], b / sizes, wanted / scale
    size = max(1.0, np.abs(points).max())
    if np.any(points @ A.T - b > SHARE * size):
        return False
    for row in np.random.default_rng(0).normal(size=(20, A.shape[1])):
        answer = linprog(-row, A, b, bounds=(None, None), method="highs-ds")
        if answer.status != 0 or abs(-answer.fun - (points @ row).max()) > SHARE * size:
            return False
    return True


def same_interval(found: tuple[Array, Array], wanted: tuple[float, float]) -> bool:
    A, b = np.asarray(found[0], dtype=float).ravel(), np.asarray(found[1], dtype=float).ravel()
    high = min((s / a for a, s in zip(A, b, strict=True) if a > 0), default=np.inf)
    low = max((s / a for a, s in zip(A, b, strict=True) if a < 0), default=-np.inf)
    size = max([1e-12, *(abs(end) for end in wanted if np.isfinite(end))])
    return all(x == y or abs(x - y) <= SHARE * size for x, y in zip((low, high), wanted, strict=True))


# ---- tables ----------------------------------------------------------------------------------------------------

OPERATIONS = ("empty", "vertices", "rays", "volume", "minimal", "hull", "project")


@dataclass(frozen=True)
class Outcome:
    """``right``, ``wrong``, ``error`` or ``-``, and the seconds of a right answer."""

    word: str
    seconds: float = 0.0


def outcome(run: Callable[..., Any] | None, operation: str, case: Case, wanted: Any, repeat: int) -> Outcome:
    """One operation of one tool on one case."""
    if run is None:
        return Outcome("-")
    given = (case.vertices,) if operation == "hull" else (case.A, case.b)
    try:
        seconds, answer = min((timed(run, given) for _ in range(repeat)), key=lambda pair: pair[0])
        return Outcome("right" if is_right(operation, case, answer, wanted) else "wrong", seconds)
    except Exception:
        return Outcome("error")


def timed(run: Callable[..., Any], given: tuple[Any, ...]) -> tuple[float, Any]:
    begin = time.perf_counter()
    answer = run(*(part.copy() for part in given))
    return time.perf_counter() - begin, answer


def installed() -> dict[str, dict[str, Callable[..., Any]]]:
    """The tools that can be imported."""
    found = {}
    for name, make in TOOLS.items():
        try:
            found[name] = make()
        except ImportError:
            print(f"{name} is not installed")
    return found


def table(repeat: int) -> Iterator[str]:
    """Verdicts of all cases, then sums and ratios of time."""
    tools = installed()
    yield f"{'operation':10} {'case':28}" + "".join(f"{name:>11}" for name in tools)
    counts = {name: dict.fromkeys(("right", "wrong", "error"), 0) for name in tools}
    ratios: dict[tuple[str, str], list[float]] = {}
    for operation in OPERATIONS:
        for case in cases():
            wanted = expected(operation, case)
            if wanted is None:
                continue
            found = {n: outcome(ops.get(operation), operation, case, wanted, repeat) for n, ops in tools.items()}
            yield f"{operation:10} {case.name:28}" + "".join(f"{o.word:>11}" for o in found.values())
            for name, one in found.items():
                if one.word in counts[name]:
                    counts[name][one.word] += 1
                if name != "hysdel_py" and one.word == found["hysdel_py"].word == "right":
                    ratios.setdefault((operation, name), []).append(one.seconds / found["hysdel_py"].seconds)
    for word in ("right", "wrong", "error"):
        yield f"{word:39}" + "".join(f"{counts[name][word]:11}" for name in tools)
    yield ""
    yield from _ratios(ratios, [name for name in tools if name != "hysdel_py"])


def _ratios(ratios: dict[tuple[str, str], list[float]], names: list[str]) -> Iterator[str]:
    """Geometric means of the time of a tool over that of this package, where both are right."""
    yield f"{'time / hysdel_py':16}" + "".join(f"{name:>11}" for name in names)
    for operation in OPERATIONS:
        cells = [ratios.get((operation, name)) for name in names]
        if any(cells):
            yield f"{operation:16}" + "".join(map(_mean, cells))
    every = [[r for (_, tool), some in ratios.items() if tool == name for r in some] for name in names]
    yield f"{'all':16}" + "".join(map(_mean, every))


def _mean(ratios: list[float] | None) -> str:
    """Geometric mean in a column of the table."""
    return f"{np.exp(np.mean(np.log(ratios))):11.2f}" if ratios else f"{'-':>11}"


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=3, metavar="N", help="calls of which the fastest counts")
    warnings.simplefilter("ignore")
    for line in table(parser.parse_args().repeat):
        print(line, flush=True)


if __name__ == "__main__":
    main()
