"""Polyhedra for sets.py, with what is known of them by construction."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, product
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """``A w <= b``, what is known of it, and the size of each coordinate.

    What is None is not known; a word says that linear programs of scipy judge the answer.
    """

    name: str
    A: Array
    b: Array
    vertices: Array | str | None = None  # of a bounded one
    volume: float | None = None
    facets: int | str | None = None  # rows that are needed, of one with inner points
    empty: bool = False
    rays: tuple[int, int] | None = None  # points and ways to infinity, of an unbounded one
    kept: tuple[int, ...] = (0,)  # coordinates of the projection; none if it is not asked for

    @property
    def points(self) -> Array | None:
        """Vertices that are known."""
        return None if self.vertices is None or isinstance(self.vertices, str) else self.vertices

    @property
    def scale(self) -> Array:
        """Size of each coordinate."""
        return np.ones(self.A.shape[1]) if self.points is None else np.maximum(np.ptp(self.points, axis=0), 1e-12)


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
    return Case(name, np.vstack([A, A]), np.concatenate([b, 2 * b]), "held", facets="counted")


def random_rows(name: str, n: int, rows: int, seed: int, kept: tuple[int, ...]) -> Case:
    """Random half-spaces at distances from 0.8 to 1.2 of the origin, in a box."""
    draw = np.random.default_rng(seed)
    A = draw.normal(size=(rows - 2 * n, n))
    A = np.vstack([A / np.linalg.norm(A, axis=1, keepdims=True), np.eye(n), -np.eye(n)])
    b = np.concatenate([0.8 + 0.4 * draw.random(rows - 2 * n), np.full(2 * n, 1.5)])
    return Case(name, A, b, "held", facets="counted", kept=kept)


def cross(n: int, inside: int, seed: int) -> Case:
    """The cross-polytope: 2 n vertices, 2^(n-1) rows through each; turned into a greater space, where it is flat."""
    signs, corners = np.array(list(product([1.0, -1.0], repeat=n))), np.vstack([np.eye(n), -np.eye(n)])
    if inside == n:
        return Case(
            f"cross-polytope in {n}",
            signs,
            np.ones(len(signs)),
            corners,
            2.0**n / factorial(n),
            len(signs),
            kept=(0, 1),
        )
    frame = np.linalg.qr(np.random.default_rng(seed).normal(size=(inside, inside)))[0]
    flat, across = frame[:n], frame[n:]
    A = np.vstack([signs @ flat, across, -across])
    b = np.concatenate([np.ones(len(signs)), np.zeros(2 * len(across))])
    return Case(f"flat cross-polytope, {n} in {inside}", A, b, corners @ flat, 0.0, kept=(0, 1))


def pyramid(sides: int, *, base: bool) -> Case:
    """A pyramid over a regular polygon, all rows but one through its tip; without its base a cone downwards."""
    angle = 2 * np.pi * np.arange(sides) / sides
    walls = np.column_stack([np.cos(angle), np.sin(angle), np.ones(sides)])
    radius = 1 / np.cos(np.pi / sides)
    turned = angle + np.pi / sides
    rim = np.column_stack([radius * np.cos(turned), radius * np.sin(turned), np.zeros(sides)])
    if not base:
        return Case(f"cone of {sides} rows in 3", walls, np.ones(sides), rays=(1, sides), facets=sides, kept=(0, 1))
    A, b = np.vstack([walls, [[0, 0, -1.0]]]), np.append(np.ones(sides), 0.0)
    corners, volume = np.vstack([rim, [[0, 0, 1.0]]]), sides * np.tan(np.pi / sides) / 3
    return Case(f"pyramid, {sides} rows at its tip", A, b, corners, volume, sides + 1, kept=(0, 1))


def cyclic(count: int, n: int) -> Case:
    """Points on the curve (cos t, sin t, cos 2t, sin 2t): all of them are neighbours; rows by Gale's condition."""
    angle = 2 * np.pi * np.arange(count) / count
    points = np.column_stack([f(k * angle) for k in range(1, n // 2 + 1) for f in (np.cos, np.sin)])
    rows, sides = [], []
    for pairs in combinations(range(count), n // 2):
        chosen = sorted({i for p in pairs for i in (p, (p + 1) % count)})
        if len(chosen) == n:
            row = np.linalg.svd(np.column_stack([points[chosen], -np.ones(n)]))[2][-1]
            row *= 1.0 if row[-1] > 0 else -1.0  # the origin is inside
            rows.append(row[:-1]), sides.append(row[-1])
    return Case(f"cyclic, {count} points in {n}", np.array(rows), np.array(sides), points, None, len(rows), kept=(0, 1))


def cloud(count: int, n: int, seed: int) -> Case:
    """Points on the unit sphere; no rows are given."""
    points = np.random.default_rng(seed).normal(size=(count, n))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return Case(f"{count} points in {n}", np.zeros((0, n)), np.zeros(0), points, kept=())


def small_cases() -> tuple[Case, ...]:
    """Sets that ask for nothing special, then those that often do."""
    simplex = np.vstack([np.zeros(3), np.eye(3)])
    tent = np.array([[1, 0, 1], [-1, 0, 1], [0, 1, 1], [0, -1, 1], [0, 0, -1]], dtype=float)
    tip = np.array([[1, 1, 0], [1, -1, 0], [-1, 1, 0], [-1, -1, 0], [0, 0, 1]], dtype=float)
    turn = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    sliver = np.array([[-1, -5e-7], [-1, 5e-7], [1, -5e-7], [1, 5e-7]], dtype=float) @ turn.T
    eye = np.eye(2)
    return (
        box("square", [-1, -1], [1, 1]),
        box("box in 4", [-1] * 4, [1, 2, 3, 4]),
        Case("simplex in 3", np.vstack([-np.eye(3), np.ones(3)]), np.array([0, 0, 0, 1.0]), simplex, 1 / 6, 4),
        Case("pyramid, 4 rows at its tip", tent, np.array([1, 1, 1, 1, 0.0]), tip, 4 / 3, 5),
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
        Case("quadrant", -eye, np.zeros(2), facets=2, rays=(1, 2)),
        Case("strip", np.array([[1.0, 0], [-1, 0]]), np.ones(2), facets=2, rays=(2, 2)),
        Case("empty", np.vstack([eye, -eye]), np.array([1.0, 1, -2, 1]), empty=True),
    )


def big_cases() -> tuple[Case, ...]:
    """More rows, points and coordinates, and many rows through one vertex."""
    cube = box("cube in 6", [-1] * 6, [1] * 6)
    return (
        random_rows("100 rows in 3", 3, 100, 4, (0, 1)),
        random_rows("60 rows in 4", 4, 60, 5, (0, 1)),
        random_rows("40 rows in 5", 5, 40, 6, (0, 1)),
        random_rows("30 rows in 6", 6, 30, 7, (0, 1)),
        cube,
        cross(5, 5, 0),
        cross(4, 6, 8),
        pyramid(60, base=True),
        pyramid(60, base=False),
        cyclic(14, 4),
        cyclic(10, 6),
        cloud(200, 2, 9),
        cloud(200, 3, 10),
        cloud(100, 4, 11),
    )
