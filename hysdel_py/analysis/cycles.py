"""Limit cycles of a piecewise affine system that runs by itself, by enumeration of the sequences of cells.

A run of period T through cells i0, i1, ..., back to i0 is a fixed point of one affine map. The sequences are followed
step by step with the polyhedron of the first states that take them, so that an empty polyhedron ends the branch and the
enumeration is complete: where nothing is found there is no cycle of that period.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.cells import AffineLaw, Cell, cells_of
from hysdel_py.analysis.counts import counted
from hysdel_py.analysis.reach import HasPwa, pwa_of
from hysdel_py.errors import SimulationError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.systems.pwa import Pwa

__all__ = ["Cycle", "CycleSettings", "Cycles", "limit_cycles"]

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class CycleSettings:
    """Limits and tolerances of the search.

    Attributes
    ----------
    most : int
        Sequences of cells that are followed at most.
    apart : float
        States of a cycle that are no farther from each other are an equilibrium, relative to their size.
    close : float
        A replayed cycle comes back to its first state up to this, relative to its size.
    """

    most: int = 20000
    apart: float = 1e-6
    close: float = 1e-7


@dataclass(frozen=True, eq=False)
class Cycle:
    """A run that comes back.

    Attributes
    ----------
    states : array of shape (period, n)
    cells : tuple of int
        The cell of each state.
    map : array of shape (n, n)
        Slope of the map over one period.
    """

    states: Matrix
    cells: tuple[int, ...]
    map: Matrix

    @property
    def period(self) -> int:
        """Number of steps until it comes back; 1 for an equilibrium."""
        return len(self.states)

    @cached_property
    def contraction(self) -> float:
        """Spectral radius over one period: below 1 neighbouring runs approach the cycle, while in the same cells."""
        return float(np.abs(np.linalg.eigvals(self.map)).max(initial=0.0))

    @property
    def is_attractive(self) -> bool:
        """Whether runs that start near it, and stay in the same cells, converge to it."""
        return self.contraction < 1.0


@dataclass(frozen=True, eq=False, slots=True)
class Cycles:
    """What was found.

    Attributes
    ----------
    cycles : tuple of Cycle
        By period, each once, replayed by the system, a closed loop by the maps of its cells; equilibria are those of
        period 1.
    longest : int
        Longest period that was asked for.
    is_complete : bool
        Whether all sequences of cells were followed, each gave at most one cycle, and none was refused because it
        lies on the false side of a threshold up to rounding: then there are no others.
    sequences : int
        Sequences that were followed.
    """

    cycles: tuple[Cycle, ...]
    longest: int
    is_complete: bool
    sequences: int

    @property
    def equilibria(self) -> tuple[Cycle, ...]:
        """Those of period 1."""
        return tuple(cycle for cycle in self.cycles if cycle.period == 1)

    @property
    def oscillations(self) -> tuple[Cycle, ...]:
        """Those of a longer period."""
        return tuple(cycle for cycle in self.cycles if cycle.period > 1)


def limit_cycles(
    system: Pwa | HasPwa, longest: int = 6, *, law: AffineLaw | None = None, settings: CycleSettings = CycleSettings()
) -> Cycles:
    """Equilibria and limit cycles of a system without inputs, or of its closed loop with an explicit law.

    Parameters
    ----------
    system : Pwa or Model
        With real states alone.
    longest : int
        Longest period.
    law : ExplicitLaw, optional
    settings : CycleSettings

    Returns
    -------
    Cycles
        Where `is_complete`, there are no others up to that period.

    Raises
    ------
    ArgumentError
        Boolean states, inputs without a law, a period below 1.

    Examples
    --------
    >>> from hysdel_py import load
    >>> model = load("SYSTEM s { INTERFACE { STATE { REAL v [-4, 4]; } } IMPLEMENTATION { AUX { BOOL up; REAL z; }"
    ...              " AD { up = v >= 0; } DA { z = {IF up THEN -1 ELSE 1}; } CONTINUOUS { v = 0.5*v + z; } } }")
    >>> [[round(float(v), 4) for v in cycle.states[:, 0]] for cycle in limit_cycles(model, 4).cycles]
    [[-0.6667, 0.6667]]
    """
    longest = counted(longest, 1, "longest")
    pwa = pwa_of(system)
    search = _Search(cells_of(pwa, law, flat=True), settings)
    for period in range(1, longest + 1):
        search.run(period)
    found = [cycle for cycle in search.found if law is not None or _is_run(pwa, cycle, settings)]
    # One that is refused lies on a threshold, where rounding decides whether it is a run.
    is_complete = search.is_complete and len(found) == len(search.found)
    return Cycles(tuple(found), longest, is_complete, search.sequences)


def _is_run(pwa: Pwa, cycle: Cycle, settings: CycleSettings) -> bool:
    """Whether the system itself takes the steps; on a threshold the cell of its false side does not count."""
    try:
        after = np.array([pwa.step(x)[0] for x in cycle.states])
    except SimulationError:
        return False
    return bool(np.abs(after - np.roll(cycle.states, -1, axis=0)).max() <= settings.close * _size(cycle.states))


@dataclass(frozen=True, eq=False, slots=True)
class _Path:
    """A sequence of cells, the first states that take it, and the state after it as a map of the first one."""

    cells: tuple[int, ...]
    starts: Polyhedron
    M: Matrix
    c: Vector


class _Search:
    """Follows sequences of cells and keeps what comes back."""

    def __init__(self, cells: Sequence[Cell], settings: CycleSettings) -> None:
        self._cells = cells
        self._settings = settings
        self.found: list[Cycle] = []
        self.is_complete = True
        self.sequences = 0

    def run(self, period: int) -> None:
        """Look for all cycles of a period."""
        for path in self._paths(period):
            if path.cells == _least_rotation(path.cells):
                self._close(path)

    def _paths(self, period: int) -> Iterator[_Path]:
        """Sequences of so many cells that some state takes; the first cell has the least number of all."""
        n = len(self._cells[0].f) if self._cells else 0
        pending = [_Path((i,), cell.region, np.eye(n), np.zeros(n)) for i, cell in enumerate(self._cells)][::-1]
        while pending:
            path = self._stepped(pending.pop())
            if self.sequences >= self._settings.most:
                self.is_complete = False
                return
            self.sequences += 1
            if len(path.cells) == period:
                yield path
                continue
            for j in range(len(self._cells) - 1, path.cells[0] - 1, -1):
                starts = path.starts & self._cells[j].region.preimage(path.M, path.c)
                if not starts.is_empty:
                    pending.append(_Path((*path.cells, j), starts.minimal(), path.M, path.c))

    def _stepped(self, path: _Path) -> _Path:
        """The path with the step from its last cell."""
        cell = self._cells[path.cells[-1]]
        return _Path(path.cells, path.starts, cell.A @ path.M, cell.A @ path.c + cell.f)

    def _close(self, path: _Path) -> None:
        """The fixed point of a path, if it lies among the first states."""
        n = len(path.c)
        closing = np.eye(n) - path.M
        singular = n > 0 and np.linalg.svd(closing, compute_uv=False)[-1] <= self._settings.apart
        start = (
            self._any_fixed_point(path, closing) if singular else np.asarray(np.linalg.solve(closing, path.c), float)
        )
        if start is None or not path.starts.contains(start, self._settings.close * _size(start)):
            return
        # A singular map may have a whole line of fixed points, of which one is kept.
        self.is_complete &= not singular
        states = self._replayed(start, path)
        if states is not None and not self._is_known(states):
            self.found.append(Cycle(states, path.cells, path.M))

    def _any_fixed_point(self, path: _Path, closing: Matrix) -> Vector | None:
        both = path.starts.with_rows(np.vstack([closing, -closing]), np.concatenate([path.c, -path.c]))
        return None if both.is_empty else both.relative_ball.centre

    def _replayed(self, start: Vector, path: _Path) -> Matrix | None:
        """States of one turn, None where a state repeats within it or the run does not come back."""
        settings, states, x = self._settings, [], start
        for cell in (self._cells[i] for i in path.cells):
            if not cell.region.contains(x, settings.close * _size(start)):
                return None
            states.append(x)
            x = cell.A @ x + cell.f
        if np.abs(x - start).max(initial=0.0) > settings.close * _size(start):
            return None
        repeats = [k for k in range(1, len(states)) if np.abs(states[k] - start).max() <= settings.apart * _size(start)]
        return None if repeats else np.array(states)

    def _is_known(self, states: Matrix) -> bool:
        """Whether the cycle was found before, through another cell of a common boundary or from another state."""
        reach = self._settings.apart * _size(states)
        return any(
            known.period == len(states)
            and any(np.abs(known.states - shift).max() <= reach for shift in _shifts(states))
            for known in self.found
        )


def _shifts(states: Matrix) -> Iterator[Matrix]:
    return (np.roll(states, k, axis=0) for k in range(len(states)))


def _size(states: Matrix) -> float:
    return max(1.0, float(np.abs(states).max(initial=0.0)))


def _least_rotation(cells: tuple[int, ...]) -> tuple[int, ...]:
    return min(cells[k:] + cells[:k] for k in range(len(cells)))
