"""Polyhedra beside polytope, pypoman and pycddlib: right answers and time, case by case.

python benchmarks/sets.py             all tables, as in docs/geometry.md
python benchmarks/sets.py --small     the small sets alone
python benchmarks/sets.py --repeat N  the least time of N calls counts (default 5)
python benchmarks/sets.py --limit S   seconds after which a call is given up (default 20)

The tools that are not installed are left out (pip install polytope pypoman pycddlib). Expected answers are known by
construction, or come from linear programs of scipy on the set itself. Each tool answers in a process of its own, which
has asked it the same of a square before. Times are those of right answers alone.
"""

from __future__ import annotations

import argparse
import multiprocessing
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial import HalfspaceIntersection
from set_cases import Case, big_cases, small_cases
from set_tools import TOOLS

Array = NDArray[np.float64]

SHARE = 1e-6
"""Relative error, in units of the size of each coordinate, up to which an answer is right."""


# ---- whether an answer is right ------------------------------------------------------------------------------------


def expected(operation: str, case: Case) -> Any:
    """What is known of the answer; None where the operation does not apply to the case."""
    if operation == "hull":
        return case.points
    if not len(case.b):
        return None
    return {
        "empty": case.empty,
        "vertices": case.vertices,
        "volume": case.volume,
        "minimal": case.facets,
        "rays": case.rays,
        "project": None if case.empty or not case.kept else supports(case.A, case.b, case.kept),
    }[operation]


def ways(n: int) -> Array:
    """Directions in which supports are compared: both ways along each coordinate, and random ones if there are more."""
    ends = np.vstack([np.eye(n), -np.eye(n)])
    return ends if n == 1 else np.vstack([ends, np.random.default_rng(0).normal(size=(20, n))])


def supports(A: Array, b: Array, kept: tuple[int, ...]) -> Array:
    """Greatest values along directions of some coordinates, by linear programs of scipy."""
    found = []
    for way in ways(len(kept)):
        cost = np.zeros(A.shape[1])
        cost[list(kept)] = way
        answer = linprog(-cost, A, b, bounds=(None, None), method="highs-ds")
        found.append(-answer.fun if answer.status == 0 else np.inf)
    return np.array(found)


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
            return same_shadow(answer, wanted, len(case.kept))


def needed(case: Case) -> int:
    """Rows whose half-space cuts something off, by one linear program each; looser copies at the end are none."""
    _, first = np.unique(np.round(case.A, 9), axis=0, return_index=True)
    A, b = case.A[np.sort(first)], case.b[np.sort(first)]
    count = 0
    for i in range(len(b)):
        rest = np.arange(len(b)) != i
        answer = linprog(-A[i], A[rest], b[rest], bounds=(None, None), method="highs-ds")
        count += answer.status != 0 or -answer.fun > b[i] + 1e-9
    return count


def count_vertices(case: Case) -> int:
    """Vertices that Qhull finds around the origin."""
    rows = np.column_stack([case.A, -case.b])
    found = HalfspaceIntersection(rows, np.zeros(case.A.shape[1])).intersections
    return len(np.unique(np.round(found, 7) + 0.0, axis=0))


def holds_vertices(case: Case, found: Any) -> bool:
    """Whether the points lie in the set, n rows hold at each, and their greatest values are those of the set."""
    points = np.asarray(found, dtype=float)
    slack = case.b - points @ case.A.T
    if (
        len(points) != count_vertices(case)
        or slack.min() < -SHARE
        or np.any(np.sum(slack <= SHARE, axis=1) < case.A.shape[1])
    ):
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


def same_shadow(found: tuple[Array, Array], wanted: Array, n: int) -> bool:
    """Whether rows reach as far along directions as the set does in the coordinates that are kept."""
    A, b = np.asarray(found[0], dtype=float).reshape(-1, n), np.asarray(found[1], dtype=float).ravel()
    reach = supports(A, b, tuple(range(n)))
    size = max([1e-12, *np.abs(wanted[np.isfinite(wanted)])])
    return all(x == y or abs(x - y) <= SHARE * size for x, y in zip(reach, wanted, strict=True))


# ---- tables ----------------------------------------------------------------------------------------------------

OPERATIONS = ("empty", "vertices", "rays", "volume", "minimal", "hull", "project")


QUICK, QUICK_CALLS, SLOW = 0.01, 10, 1.0
"""A call of less than 10 ms is made ten times as often, one of more than a second once."""
WORDS = ("right", "wrong", "error", "long")
UNIT = np.array([[0.0, 0], [1, 0], [0, 1], [1, 1]])


@dataclass(frozen=True)
class Outcome:
    """``right``, ``wrong``, ``error``, ``long`` or ``-``, and the seconds of an answer."""

    word: str
    seconds: float = 0.0


def outcome(name: str, operation: str, case: Case, wanted: Any, repeat: int, limit: float) -> Outcome:
    """One operation of one tool on one case, in a process that is ended if it takes too long."""
    if operation not in TOOLS[name]():
        return Outcome("-")
    ours, theirs = multiprocessing.Pipe(duplex=False)
    process = multiprocessing.get_context("fork").Process(
        target=_answered, args=(theirs, name, operation, case, repeat)
    )
    process.start()
    try:
        if not ours.poll(limit * repeat):
            return Outcome("long")
        seconds, answer = ours.recv()
        if isinstance(answer, Exception):
            return Outcome("error")
        return Outcome("right" if is_right(operation, case, answer, wanted) else "wrong", seconds)
    except Exception:
        return Outcome("error")
    finally:
        process.kill()
        process.join()


def _answered(pipe: Any, name: str, operation: str, case: Case, repeat: int) -> None:
    """Send the least time of some calls, and the answer; first a call on a square that does not count."""
    run = TOOLS[name]()[operation]
    with suppress(Exception):
        timed(run, arguments(operation, UNIT, np.vstack([np.eye(2), -np.eye(2)]), np.array([1.0, 1, 0, 0]), (0,)))
    given = arguments(operation, case.points, case.A, case.b, case.kept)
    try:
        tries = [timed(run, given)]
        more = repeat - 1 if tries[0][0] > QUICK else QUICK_CALLS * repeat
        tries += [timed(run, given) for _ in range(more if tries[0][0] < SLOW else 0)]
        pipe.send(min(tries, key=lambda pair: pair[0]))
    except Exception as error:
        pipe.send((0.0, RuntimeError(str(error))))


def arguments(operation: str, points: Array | None, A: Array, b: Array, kept: tuple[int, ...]) -> tuple[Any, ...]:
    """What an operation takes."""
    match operation:
        case "hull":
            return (points,)
        case "project":
            return A, b, np.array(kept)
        case _:
            return A, b


def timed(run: Callable[..., Any], given: tuple[Any, ...]) -> tuple[float, Any]:
    copies = [part.copy() for part in given]
    begin = time.perf_counter()
    answer = run(*copies)
    return time.perf_counter() - begin, answer


def installed() -> list[str]:
    """The tools that can be imported."""
    found = []
    for name, make in TOOLS.items():
        try:
            make()
            found.append(name)
        except ImportError:
            print(f"{name} is not installed")
    return found


Times = dict[tuple[str, str], list[tuple[float, float]]]


def table(title: str, cases: tuple[Case, ...], tools: list[str], repeat: int, limit: float) -> Iterator[str]:
    """Verdicts of all cases, then sums and ratios of time."""
    yield f"{title:39}" + "".join(f"{name:>11}" for name in tools)
    counts = {name: dict.fromkeys(WORDS, 0) for name in tools}
    times: Times = {}
    for operation, case in ((operation, case) for operation in OPERATIONS for case in cases):
        wanted = expected(operation, case)
        if wanted is None:
            continue
        found = {name: outcome(name, operation, case, wanted, repeat, limit) for name in tools}
        cells = [f"{o.seconds * 1e6:11.0f}" if o.word == "right" else f"{o.word:>11}" for o in found.values()]
        yield f"{operation:10} {case.name:28}" + "".join(cells)
        for name, one in found.items():
            counts[name][one.word] = counts[name].get(one.word, 0) + 1
            if name != "hysdel_py" and one.word == found["hysdel_py"].word == "right":
                times.setdefault((operation, name), []).append((one.seconds, found["hysdel_py"].seconds))
    for word in WORDS:
        yield f"{word:39}" + "".join(f"{counts[name][word]:11}" for name in tools)
    yield ""
    names = [name for name in tools if name != "hysdel_py"]
    yield from _ratios("geometric mean", geometric, times, names)
    yield ""
    yield from _ratios("sums", sums, times, names)
    yield ""


def geometric(pairs: list[tuple[float, float]]) -> float:
    """Geometric mean of the ratios."""
    return float(np.exp(np.mean([np.log(theirs / ours) for theirs, ours in pairs])))


def sums(pairs: list[tuple[float, float]]) -> float:
    """Ratio of the sums, in which long calls count most."""
    return sum(theirs for theirs, _ in pairs) / sum(ours for _, ours in pairs)


def _ratios(
    title: str, mean: Callable[[list[tuple[float, float]]], float], times: Times, names: list[str]
) -> Iterator[str]:
    """Time of a tool over that of this package, where both are right."""
    yield f"{f'time / hysdel_py, {title}':39}" + "".join(f"{name:>11}" for name in names)
    for operation in (*OPERATIONS, "all"):
        cells = [
            [
                pair
                for (done, tool), some in times.items()
                if tool == name and operation in (done, "all")
                for pair in some
            ]
            for name in names
        ]
        if any(cells):
            yield f"{operation:39}" + "".join(f"{mean(c):11.2f}" if c else f"{'-':>11}" for c in cells)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=5, metavar="N", help="calls of which the fastest counts")
    parser.add_argument("--limit", type=float, default=20.0, metavar="S", help="seconds of a call")
    parser.add_argument("--small", action="store_true", help="the small sets alone")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    tools = installed()
    groups = [("small: microseconds of a right answer", small_cases())]
    groups += [] if given.small else [("big: microseconds of a right answer", big_cases())]
    for title, cases in groups:
        for line in table(title, cases, tools, given.repeat, given.limit):
            print(line, flush=True)


if __name__ == "__main__":
    main()
