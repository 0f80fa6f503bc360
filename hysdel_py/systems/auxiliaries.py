"""Finds the auxiliaries (d, z) that the rows of an Mld allow at a given state and input.

Bound propagation over the rows decides nearly always; what it leaves open is settled by branching on the Boolean
auxiliaries and, for intervals of real ones that stay wide, by two linear programs each. Whether the answer is unique is
part of the answer.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import SimulationError

if TYPE_CHECKING:
    from hysdel_py.systems.mld import Mld

__all__ = ["AuxiliarySolver"]

Vector = NDArray[np.float64]

_MAX_BRANCHES = 10_000
_MAX_VISITS_PER_ROW = 50  # propagation can converge without end; what it leaves open is branched on


@dataclass(slots=True)
class _Box:
    """Bounds of the auxiliaries, d before z, while they are narrowed."""

    low: list[float]
    high: list[float]

    def copy(self) -> _Box:
        return _Box(self.low.copy(), self.high.copy())


class AuxiliarySolver:
    """The rows of one Mld, prepared for many steps."""

    def __init__(self, mld: Mld) -> None:
        from scipy.sparse import hstack

        self._mld = mld
        self._matrix = hstack([mld.E2, mld.E3], format="csr")
        self._sizes = abs(self._matrix)
        self._tolerances = mld.tolerances
        self._unique = mld.tolerances.unique
        self._rounding = mld.tolerances.rounding
        pointers = self._matrix.indptr
        self._rows = [
            list(zip(self._matrix.indices[a:b].tolist(), self._matrix.data[a:b].tolist(), strict=True))
            for a, b in pairwise(pointers)
        ]
        self._rows_of: list[list[int]] = [[] for _ in range(mld.nd + mld.nz)]
        for index, row in enumerate(self._rows):
            for column, _ in row:
                self._rows_of[column].append(index)
        self._influential = self._find_influential()

    def _find_influential(self) -> NDArray[np.bool_]:
        """Which auxiliaries appear in a row or an equation at all."""
        mld = self._mld
        in_equations = np.hstack([np.vstack([mld.B2, mld.D2]), np.vstack([mld.B3, mld.D3])]).any(axis=0)
        in_rows = np.array([bool(rows) for rows in self._rows_of], dtype=bool)
        return in_equations | in_rows

    def solve(self, x: Vector, u: Vector) -> tuple[Vector, Vector]:
        """The unique (d, z) at a state and input.

        Raises
        ------
        SimulationError
            There is none, or there are several; says which rows or which auxiliaries are to blame.
        """
        mld = self._mld
        right = mld.E1 @ u + mld.E4 @ x + mld.E5
        # Terms moved to the right set the scale on which the rounding of a row can be trusted.
        scale = abs(mld.E1) @ abs(u) + abs(mld.E4) @ abs(x) + abs(mld.E5)
        slack = (self._tolerances.row + self._tolerances.rounding * scale).tolist()
        first: Vector | None = None
        for point in self._points(right.tolist(), slack):
            if first is None:
                first = point
            else:
                raise SimulationError((self._several(first, point),))
        if first is None:
            raise SimulationError((self._none(right, slack),))
        return first[: mld.nd], first[mld.nd :]

    def _points(self, right: list[float], slack: list[float]) -> Iterator[Vector]:
        """Points that satisfy all rows: two of them as soon as two exist."""
        nd, nz = self._mld.nd, self._mld.nz
        box = _Box([0.0] * nd + [-np.inf] * nz, [1.0] * nd + [np.inf] * nz)
        pending = [(box, list(range(len(self._rows))))]
        for _ in range(_MAX_BRANCHES):
            if not pending:
                return
            box, rows = pending.pop()
            if not self._propagate(box, rows, right, slack):
                continue
            branch = self._open_boolean(box)
            if branch is None:
                yield from self._real_points(box, right, slack)
                continue
            for value in (1.0, 0.0):
                child = box.copy()
                child.low[branch] = child.high[branch] = value
                pending.append((child, self._rows_of[branch]))
        raise SimulationError((f"the auxiliaries were not decided within {_MAX_BRANCHES} branches",))

    def _open_boolean(self, box: _Box) -> int | None:
        return next((i for i in range(self._mld.nd) if self._influential[i] and box.low[i] != box.high[i]), None)

    def _propagate(self, box: _Box, rows: list[int], right: list[float], slack: list[float]) -> bool:
        """Narrow the box by single rows until nothing changes; False if it became empty."""
        queue, queued = deque(rows), set(rows)
        visits = _MAX_VISITS_PER_ROW * max(1, len(self._rows))
        while queue and visits:
            visits -= 1
            index = queue.popleft()
            queued.discard(index)
            changed = self._narrow(self._rows[index], right[index] + slack[index], box)
            if changed is None:
                return False
            for column in changed:
                fresh = [row for row in self._rows_of[column] if row not in queued]
                queue.extend(fresh)
                queued.update(fresh)
        return True

    def _narrow(self, row: list[tuple[int, float]], right: float, box: _Box) -> list[int] | None:
        """Narrow by one row ``sum a w <= right``; the columns that changed, or None if the row cannot hold."""
        least, infinite, size = 0.0, -1, 0.0
        for column, a in row:
            end = box.low[column] if a > 0 else box.high[column]
            if abs(end) == np.inf:
                if infinite >= 0:
                    return []
                infinite = column
            else:
                least += a * end
                size += abs(a * end)
        if infinite < 0 and least > right + self._rounding * size:
            return None
        changed = []
        for column, a in row:
            if infinite not in (-1, column):
                continue
            own = 0.0 if infinite == column else a * (box.low[column] if a > 0 else box.high[column])
            limit = (right - least + own) / a
            if self._tighten(column, limit, box, upper=a > 0):
                changed.append(column)
                if box.low[column] > box.high[column]:
                    return None
        return changed

    def _tighten(self, column: int, limit: float, box: _Box, *, upper: bool) -> bool:
        """Apply a bound; for a Boolean anything short of the far end excludes it."""
        if column < self._mld.nd:
            if upper and limit < 1.0 and box.high[column] == 1.0:
                box.high[column] = 0.0 if limit >= 0.0 else -1.0
                return True
            if not upper and limit > 0.0 and box.low[column] == 0.0:
                box.low[column] = 1.0 if limit <= 1.0 else 2.0
                return True
            return False
        margin = 1e-12 * (1.0 + abs(limit))
        if upper and limit < box.high[column] - margin:
            box.high[column] = max(limit, box.low[column]) if limit > box.low[column] - margin else limit
            return True
        if not upper and limit > box.low[column] + margin:
            box.low[column] = min(limit, box.high[column]) if limit < box.high[column] + margin else limit
            return True
        return False

    def _real_points(self, box: _Box, right: list[float], slack: list[float]) -> Iterator[Vector]:
        """Points of a box whose Booleans are decided: one if the real auxiliaries are determined, else two."""
        low, high = np.array(box.low), np.array(box.high)
        low[~self._influential] = high[~self._influential] = 0.0
        nd = self._mld.nd
        # An interval that the slack of the rows alone can open is closed; polishing takes the slack out again.
        width = self._unique * (1.0 + np.minimum(abs(low), abs(high))) + 2.0 * sum(slack)
        open_columns = [i for i in range(nd, len(low)) if np.isinf(width[i]) or high[i] - low[i] > width[i]]
        if not open_columns:
            yield from self._judged((low + high) / 2.0, right, slack)
            return
        found = list(self._extreme_points(open_columns, low, high, np.array(right)))
        # A linear program may fail for the size of its numbers alone: what the definitions say decides then.
        yield from found or self._defined_points(low, high, right, slack)

    def _defined_points(self, low: Vector, high: Vector, right: list[float], slack: list[float]) -> Iterator[Vector]:
        """The points to which the definitions lead from both ends of a finite box: one where they agree."""
        if not (np.isfinite(low) & np.isfinite(high)).all():
            return
        points = [point for end in (low, high) for point in self._judged(end, right, slack)]
        same = np.allclose(points[0], points[-1], rtol=self._unique, atol=self._unique) if points else True
        yield from points[:1] if same else points

    def _judged(self, point: Vector, right: list[float], slack: list[float]) -> Iterator[Vector]:
        """A point without the slack, or the point itself, or nothing where neither keeps the rows."""
        # Propagation stops above the rounding of large numbers: a point of a narrow box may miss its definitions.
        polished = self._polished(point, right)
        if self._keeps_rows(polished, right, slack):
            yield polished
        elif self._keeps_rows(point, right, [4.0 * one for one in slack]):
            yield point

    def _keeps_rows(self, point: Vector, right: list[float], slack: list[float]) -> bool:
        rounding = self._rounding * (self._sizes @ abs(point))
        return bool((self._matrix @ point <= np.array(right) + np.array(slack) + rounding).all())

    def _polished(self, point: Vector, right: list[float]) -> Vector:
        """Take the slack out again: each real auxiliary to what the rows of its definition say at the other values."""
        polished = point.copy()
        for _ in range(self._mld.nz):  # as many sweeps as a chain of definitions may be long
            before = polished.copy()
            for column in range(self._mld.nd, len(point)):
                low, high = self._limits(column, polished, right)
                if np.isfinite(high - low):
                    polished[column] = (low + high) / 2.0
            if (polished == before).all():
                break
        return polished

    def _limits(self, column: int, point: Vector, right: list[float]) -> tuple[float, float]:
        """Range of a column by the rows of its own definition; rows that only read it would push it elsewhere."""
        low, high = -np.inf, np.inf
        name = self._mld.z[column - self._mld.nd].name
        for index in self._rows_of[column]:
            if self._mld.rows[index].defines != name:
                continue
            own = next(a for c, a in self._rows[index] if c == column)
            limit = (right[index] - sum(a * point[c] for c, a in self._rows[index] if c != column)) / own
            low, high = (low, min(high, limit)) if own > 0 else (max(low, limit), high)
        return low, high

    def _extreme_points(self, columns: list[int], low: Vector, high: Vector, right: Vector) -> Iterator[Vector]:
        from scipy.optimize import linprog

        bounds = np.column_stack([low, high])
        first: Vector | None = None
        for column in columns:
            for sign in (1.0, -1.0):
                cost = np.zeros(len(low))
                cost[column] = sign
                answer = linprog(cost, A_ub=self._matrix, b_ub=right, bounds=bounds, method="highs")
                if answer.status == 3:
                    raise SimulationError((f"{self._label(column)} is unbounded: nothing determines it",))
                if answer.x is None:
                    return
                if first is None:
                    first = answer.x
                elif abs(answer.x[column] - first[column]) > self._unique * (1.0 + abs(first[column])):
                    yield from (first, answer.x)
                    return
        if first is not None:
            yield first

    def _label(self, column: int) -> str:
        variable = (*self._mld.d, *self._mld.z)[column]
        return f"{variable.name} (line {variable.line})" if variable.line else variable.name

    def _several(self, first: Vector, second: Vector) -> str:
        column = int(np.argmax(abs(first - second)))
        return (
            f"the auxiliaries are not unique: {self._label(column)} may be {first[column]:.9g} or "
            f"{second[column]:.9g}; is it defined by an item?"
        )

    def _none(self, right: Vector, slack: list[float]) -> str:
        """Why nothing satisfies the rows: the first row that the propagation of all others refutes."""
        nd, nz = self._mld.nd, self._mld.nz
        box = _Box([0.0] * nd + [-np.inf] * nz, [1.0] * nd + [np.inf] * nz)
        blamed = self._refuting_row(box, right.tolist(), slack)
        if blamed is None:
            return "no values of the auxiliaries satisfy all rows together"
        origin = self._mld.rows[blamed]
        if origin.item in ("Cont_must", "Logic_must"):
            return f"MUST is violated in {origin}"
        if origin.item == "AD":
            return f"the state and input lie in the epsilon gap of {origin.defines}, or outside its range, in {origin}"
        return f"no values of the auxiliaries satisfy {origin}"

    def _refuting_row(self, box: _Box, right: list[float], slack: list[float]) -> int | None:
        """Sweep over all rows in order until one cannot hold; requirements come last, as they define nothing."""
        order = sorted(range(len(self._rows)), key=lambda i: self._mld.rows[i].item.endswith("_must"))
        changed = True
        sweeps = 0
        while changed and sweeps < _MAX_VISITS_PER_ROW:
            changed, sweeps = False, sweeps + 1
            for index in order:
                columns = self._narrow(self._rows[index], right[index] + slack[index], box)
                if columns is None:
                    return index
                changed = changed or bool(columns)
        return None
