"""Finding the modes of growing models, and finding the mode of a point.

python benchmarks/modes.py            all tables, as in docs/pwa.md
python benchmarks/modes.py --quick    the smallest sizes only
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

import hysdel_py as hys
from hysdel_py.geometry.solver import LpSolver
from hysdel_py.systems.dha import Dha, Event

MOST_WORDS = 1024
"""Plain enumeration of more words than this is not run."""
POINTS = 400

TANKS = """SYSTEM tanks {
  INTERFACE {
    PARAMETER { REAL n; REAL pipe = 0.3; REAL ts = 0.1; }
    STATE { REAL h(n) [0, 1]; }
    INPUT { REAL q [0, 0.5]; }
  }
  IMPLEMENTATION {
    AUX { INDEX i; BOOL above(n); BOOL falls(n - 1); REAL flow(n - 1); REAL head(n); }
    AD { above = h >= pipe; FOR (i = 1:n - 1) { falls(i) = h(i) >= h(i + 1); } }
    DA {
      FOR (i = 1:n) { head(i) = {IF above(i) THEN h(i) - pipe ELSE 0}; }
      FOR (i = 1:n - 1) { flow(i) = {IF falls(i) THEN head(i) ELSE 0}; }
    }
    CONTINUOUS { h = h + ts*([q; flow] - [flow; h(n)]); }
  }
}"""
CARS = """SYSTEM cars {
  INTERFACE {
    PARAMETER { REAL n; REAL ts = 0.2; REAL brake_at = 10; REAL coast_at = 25; }
    STATE { REAL p(n) [0, 500], v(n) [0, 40]; }
    INPUT { REAL lead [-3, 2]; }
  }
  IMPLEMENTATION {
    AUX { INDEX i; BOOL near(n - 1), middle(n - 1); REAL a(n - 1); }
    AD { FOR (i = 1:n - 1) { near(i) = p(i) - p(i + 1) <= brake_at; middle(i) = p(i) - p(i + 1) <= coast_at; } }
    DA { FOR (i = 1:n - 1) { a(i) = {IF near(i) THEN -3 ELSE {IF middle(i) THEN 0 ELSE 1.5}}; } }
    CONTINUOUS { p = p + ts*v; v = v + ts*[lead; a]; }
  }
}"""


def random_model(events: int, dimension: int, seed: int) -> str:
    """The text of a model whose events are random hyperplanes through the middle part of a box."""
    rng = np.random.default_rng(seed)
    names = [f"x{i}" for i in range(dimension)]
    thresholds = []
    for k in range(events):
        normal, offset = rng.normal(size=dimension), rng.uniform(-0.7, 0.7)
        form = " + ".join(f"({c:.6f})*{x}" for c, x in zip(normal, names, strict=True))
        thresholds.append(f"d{k} = {form} <= {offset:.6f};")
    choices = [f"z{k} = {{IF d{k} THEN {rng.normal():.4f}*x0 ELSE {rng.normal():.4f}}};" for k in range(events)]
    total = " + ".join(f"z{k}" for k in range(events))
    return (
        f"SYSTEM random {{ INTERFACE {{ STATE {{ REAL {', '.join(f'{x} [-1, 1]' for x in names)}; }} }}\n"
        f"IMPLEMENTATION {{ AUX {{ BOOL {', '.join(f'd{k}' for k in range(events))};\n"
        f"REAL {', '.join(f'z{k}' for k in range(events))}; }}\n"
        f"AD {{ {' '.join(thresholds)} }} DA {{ {' '.join(choices)} }}\n"
        f"CONTINUOUS {{ {' '.join(f'{x} = 0.5*{x};' for x in names[1:])} x0 = 0.1*({total}); }} }} }}"
    )


@dataclass(frozen=True)
class Case:
    """A model with a name for the table."""

    name: str
    load: Callable[[], hys.Model]


def cases(*, quick: bool) -> Iterator[Case]:
    """Models of growing size."""
    for n in (2, 3) if quick else (2, 3, 4, 5):
        yield Case(f"{n} tanks", lambda n=n: hys.load(TANKS, n=n))
    for n in (2, 3) if quick else (2, 3, 4, 5):
        yield Case(f"{n} cars", lambda n=n: hys.load(CARS, n=n))
    for events, dimension in ((6, 2),) if quick else ((6, 2), (10, 2), (20, 2), (10, 3), (14, 3)):
        yield Case(f"{events} random planes, {dimension} states", lambda e=events, d=dimension: hys.load(random_model(e, d, 1)))  # fmt: skip  # noqa: E501
    for name in ("clutch", "two_rooms", "three_tanks"):
        yield Case(name, lambda name=name: hys.load(name))


def enumerate_words(dha: Dha) -> tuple[int, int, float] | None:
    """Words, non-empty words and seconds of one linear program for each word of the events; None if there are too many.

    Only for models whose events read states and inputs alone.
    """
    columns = {v.name: k for k, v in enumerate((*dha.x, *dha.u))}
    events = [item for item in dha.items if isinstance(item, Event)]
    readable = all(name in columns for event in events for name, _ in event.form.terms)
    if not readable or 2 ** len(events) > MOST_WORDS:
        return None
    low = np.array([v.low for v in (*dha.x, *dha.u)])
    high = np.array([v.high for v in (*dha.x, *dha.u)])
    rows = np.zeros((len(events), len(columns)))
    for row, event in zip(rows, events, strict=True):
        for name, coefficient in event.form.terms:
            row[columns[name]] += coefficient
    constants = np.array([event.form.constant for event in events])
    gaps = np.array([event.epsilon for event in events])
    solver, found, start = LpSolver(), 0, time.perf_counter()
    for word in product((1.0, -1.0), repeat=len(events)):
        sign = np.array(word)
        A, b = sign[:, None] * rows, -sign * constants - np.where(sign < 0, gaps, 0.0)
        weights = np.linalg.norm(A, axis=1)[:, None]
        cost = np.append(np.zeros(len(columns)), 1.0)
        answer = solver.maximise(cost, np.hstack([A, weights]), b, np.append(low, -1e3), np.append(high, 1.0))
        found += answer.value >= -1e-9
    return 2 ** len(events), found, time.perf_counter() - start


def report_modes(*, quick: bool) -> None:
    """Print the table of the search for modes."""
    print("| model | binaries | modes (flat) | LPs | LPs per mode | ms | ms per mode | plain: words | plain: ms |")
    print("|---|---|---|---|---|---|---|---|---|")
    for case in cases(quick=quick):
        dha = case.load().dha
        start = time.perf_counter()
        pwa = hys.to_pwa(dha)
        ms = 1e3 * (time.perf_counter() - start)
        modes, flat = len(pwa.modes), sum(mode.is_flat for mode in pwa.modes)
        plain = enumerate_words(dha)
        words = f"{plain[0]} | {1e3 * plain[2]:.0f}" if plain else f"{2.0 ** len(dha.d):.0f} | "
        print(
            f"| {case.name} | {len(dha.d)} | {modes} ({flat}) | {pwa.effort.programs} | "
            f"{pwa.effort.programs / modes:.1f} | {ms:.0f} | {ms / modes:.2f} | {words} |"
        )


def report_location(*, quick: bool) -> None:
    """Print the table of the search for the mode of a point: the tree against one region after the other."""
    print("| model | modes | depth of the tree | tree, us per point | scan, us per point | ratio |")
    print("|---|---|---|---|---|---|")
    for case in cases(quick=quick):
        pwa = case.load().pwa
        rng = np.random.default_rng(0)
        low = np.array([v.low for v in (*pwa.x, *pwa.u)])
        high = np.array([v.high for v in (*pwa.x, *pwa.u)])
        boolean = np.array([v.is_bool for v in (*pwa.x, *pwa.u)])
        points = np.where(boolean, rng.integers(2, size=(POINTS, len(low))), rng.uniform(low, high, (POINTS, len(low))))
        by_tree = _median_us(lambda w, tree=pwa.tree: tree.locate(w, absolute=1e-9, relative=1e-14).leaf, points)
        by_scan = _median_us(lambda w, modes=pwa.modes: _scan(modes, w), points)
        print(
            f"| {case.name} | {len(pwa.modes)} | {pwa.tree.depth} | {by_tree:.1f} | {by_scan:.1f} | "
            f"{by_scan / by_tree:.1f} |"
        )


def _scan(modes: tuple, w: np.ndarray) -> int:
    for mode in modes:
        if np.all(mode.region.A @ w <= mode.region.b + 1e-9):
            return mode.index
    return -1


def _median_us(find: Callable[[np.ndarray], int], points: np.ndarray) -> float:
    times = []
    for point in points:
        start = time.perf_counter()
        find(point)
        times.append(time.perf_counter() - start)
    return 1e6 * statistics.median(times)


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="the smallest sizes only")
    options = parser.parse_args()
    report_modes(quick=options.quick)
    print()
    report_location(quick=options.quick)


if __name__ == "__main__":
    main()
