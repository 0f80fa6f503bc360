"""The operations of sets.py by each tool; each takes (A, b), or points, and gives plain arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import hysdel_py as hys

Array = NDArray[np.float64]


def of_hysdel() -> dict[str, Callable[..., Any]]:
    """The operations of this package."""
    return {
        "empty": lambda A, b: hys.Polyhedron(A, b).is_empty,
        "vertices": lambda A, b: hys.Polyhedron(A, b).vertices,
        "rays": lambda A, b: _generators(hys.Polyhedron(A, b).generators),
        "volume": lambda A, b: hys.Polyhedron(A, b).volume,
        "minimal": lambda A, b: hys.Polyhedron(A, b).minimal().m,
        "hull": lambda V: _rows(hys.Polyhedron.hull(V)),
        "project": lambda A, b, kept: _rows(hys.Polyhedron(A, b).project(kept.tolist())),
    }


def _rows(p: Any) -> tuple[Array, Array]:
    return p.A, p.b


def _generators(g: Any) -> tuple[int, int]:
    """Points, and directions in which the set goes on without end; a line counts twice."""
    return len(g.points), len(g.rays) + 2 * len(g.lines)


def of_polytope() -> dict[str, Callable[..., Any]]:
    """The operations of polytope."""
    import polytope as pc

    def made(A: Array, b: Array) -> Any:
        return pc.Polytope(A, b)

    return {
        "empty": lambda A, b: bool(pc.is_empty(made(A, b))),
        "vertices": lambda A, b: pc.extreme(made(A, b)),
        "volume": lambda A, b: pc.volume(made(A, b)),
        "minimal": lambda A, b: len(pc.reduce(made(A, b)).b),
        "hull": lambda V: _rows(pc.qhull(V)),
        "project": lambda A, b, kept: _rows(made(A, b).project((kept + 1).tolist())),
    }


def of_pypoman() -> dict[str, Callable[..., Any]]:
    """The operations of pypoman."""
    import pypoman

    def project(A: Array, b: Array, kept: Array) -> tuple[Array, Array]:
        E = np.eye(A.shape[1])[kept]
        points = np.array(pypoman.project_polytope((E, np.zeros(len(kept))), (A, b), method="cdd"))
        return pypoman.compute_polytope_halfspaces(list(points.reshape(-1, len(kept))))

    return {
        "vertices": lambda A, b: np.array(pypoman.compute_polytope_vertices(A, b)),
        "hull": lambda V: pypoman.compute_polytope_halfspaces(list(V)),
        "project": project,
    }


def of_cdd() -> dict[str, Callable[..., Any]]:
    """The operations of pycddlib."""
    import cdd

    def matrix(A: Array, b: Array) -> Any:
        return cdd.matrix_from_array(np.column_stack([b, -A]).tolist(), rep_type=cdd.RepType.INEQUALITY)

    def generators(A: Array, b: Array) -> tuple[Array, int]:
        found = cdd.copy_generators(cdd.polyhedron_from_matrix(matrix(A, b)))
        rows = np.array(found.array).reshape(-1, A.shape[1] + 1)
        return rows, len(found.lin_set)

    def points(A: Array, b: Array) -> Array:
        rows, _ = generators(A, b)
        if np.any(rows[:, 0] == 0):
            raise ValueError("unbounded")
        return rows[:, 1:]

    def rays(A: Array, b: Array) -> tuple[int, int]:
        rows, lines = generators(A, b)
        # A cone has no point among its generators there: the origin goes without saying.
        return max(int(np.sum(rows[:, 0] != 0)), 1), int(np.sum(rows[:, 0] == 0)) + lines

    def hull(V: Array) -> tuple[Array, Array]:
        rows = np.column_stack([np.ones(len(V)), V]).tolist()
        given = cdd.matrix_from_array(rows, rep_type=cdd.RepType.GENERATOR)
        return sides(cdd.copy_inequalities(cdd.polyhedron_from_matrix(given)), V.shape[1])

    def sides(found: Any, n: int) -> tuple[Array, Array]:
        rows = np.array(found.array).reshape(-1, n + 1)
        equal = rows[sorted(found.lin_set)]
        rows = np.vstack([rows, -equal])
        return -rows[:, 1:], rows[:, 0]

    def minimal(A: Array, b: Array) -> int:
        given = matrix(A, b)
        cdd.matrix_canonicalize(given)
        return len(given.array)

    def project(A: Array, b: Array, kept: Array) -> tuple[Array, Array]:
        given = matrix(A, b)
        gone = set(range(1, A.shape[1] + 1)) - set((kept + 1).tolist())
        return sides(cdd.block_elimination(given, gone), len(kept))

    return {
        "empty": lambda A, b: len(generators(A, b)[0]) == 0,
        "vertices": points,
        "rays": rays,
        "minimal": minimal,
        "hull": hull,
        "project": project,
    }


TOOLS: dict[str, Callable[[], dict[str, Callable[..., Any]]]] = {
    "hysdel_py": of_hysdel, "polytope": of_polytope, "pypoman": of_pypoman, "pycddlib": of_cdd,
}  # fmt: skip
