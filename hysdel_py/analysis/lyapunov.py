"""Quadratic and piecewise quadratic Lyapunov functions of piecewise affine systems.

Decrease from cell to cell is a linear matrix inequality, made less demanding by what is known of the cell (M. Johansson
and A. Rantzer, "Computation of piecewise quadratic Lyapunov functions for hybrid systems", IEEE Trans. Automatic
Control 43, 1998; discrete time: D. Mignone, G. Ferrari-Trecate and M. Morari, "Stability and stabilization of piecewise
affine and hybrid systems: an LMI approach", CDC 2000). What the solver returns is checked again by eigenvalues.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.analysis.affine_lyapunov import cut_along_steps, cut_at_origin, search_affine
from hysdel_py.analysis.cells import AffineLaw, Cell, cells_of, escape, transitions
from hysdel_py.analysis.matrix_inequalities import Inequalities
from hysdel_py.analysis.reach import HasPwa, pwa_of
from hysdel_py.analysis.value_decrease import DecreaseSettings, decrease_of
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.systems.pwa import Pwa

__all__ = ["Lyapunov", "LyapunovTolerances", "lyapunov"]

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class LyapunovTolerances:
    """Tolerances of the search.

    Attributes
    ----------
    origin : float
        A cell belongs to the equilibrium, and a row passes through it, up to this distance.
    margin : float
        Share of the demanded margins that must be left in the check of what the solver returned.
    """

    origin: float = 1e-7
    margin: float = 0.5


@dataclass(frozen=True, eq=False, slots=True)
class Lyapunov:
    """What was found.

    Attributes
    ----------
    found : bool
        Whether V is positive and decreases along every step within the cells, by more than rounding. False says that
        no such function was found, not that the system is unstable.
    kind : str
        As asked for.
    cells : tuple of Cell
        In coordinates whose origin is the equilibrium.
    P : array of shape (count, n + 1, n + 1)
        ``V(x) = (x, 1)' P_i (x, 1)`` in cell i, for x measured from the equilibrium.
    equilibrium : array of shape (n,)
    margin : float
        Least eigenvalue of all inequalities, relative to the unit that was demanded; positive in a certificate.
    message : str
        What the solver, or the check, said.
    escape : array of shape (n,) or None
        A state whose step leaves the cells; None if there is none.
    witness : array of shape (n,) or None
        A state at which a value function was found not to be positive or not to fall.
    """

    found: bool
    kind: str
    cells: tuple[Cell, ...]
    P: Matrix
    equilibrium: Vector
    margin: float
    message: str
    escape: Vector | None = None
    witness: Vector | None = None

    @property
    def is_kept(self) -> bool:
        """Whether no step leaves the cells. If not, V certifies the decrease only while a run stays in them."""
        return self.escape is None

    @property
    def proves_stability(self) -> bool:
        """Whether every run from the cells converges to the equilibrium."""
        return self.found and self.is_kept

    def value(self, x: ArrayLike) -> float:
        """Value of V at a state; the least one where cells meet.

        Raises
        ------
        ArgumentError
            The state lies in no cell, or there is no function.
        """
        away = np.asarray(x, dtype=float) - self.equilibrium
        point = np.append(away, 1.0)
        values = [float(point @ P @ point) for cell, P in zip(self.cells, self.P, strict=False)
                  if cell.region.contains(away, cell.region.precision.empty)]  # fmt: skip
        if len(self.P) == 0 or not values:
            raise ArgumentError("there is no value: the state lies in no cell, or no function was found")
        return min(values)


def lyapunov(
    system: Pwa | HasPwa,
    kind: Literal["quadratic", "piecewise", "affine", "value"] = "piecewise",
    *,
    law: AffineLaw | None = None,
    equilibrium: ArrayLike | None = None,
    cuts: int = 0,
    tolerances: LyapunovTolerances = LyapunovTolerances(),
) -> Lyapunov:
    """Search a Lyapunov function of a system without inputs, or of its closed loop with an explicit law.

    Parameters
    ----------
    system : Pwa or Model
        With real states alone.
    kind : {"quadratic", "piecewise", "affine", "value"}
        One quadratic function for all cells, one quadratic or affine function for each, or the value function of the
        law, which is checked and not searched.
    law : ExplicitLaw, optional
    equilibrium : array_like of shape (n,), optional
        The state that is to be stable; zero by default.
    cuts : int
        How often cells are cut along their steps before an affine function is searched, which gives it more pieces;
        those that hold the equilibrium are cut by the planes of the coordinates in any case.
    tolerances : LyapunovTolerances

    Returns
    -------
    Lyapunov

    Raises
    ------
    ArgumentError
        Boolean states, inputs without a law, a state that is no equilibrium, a value function that is asked for and
        not known, cells without bounds for an affine function; or clarabel, the extra `stability`, which quadratic
        functions need, is not installed.
    """
    if kind not in ("quadratic", "piecewise", "affine", "value"):
        raise ArgumentError(f"kind is {kind!r}: 'quadratic', 'piecewise', 'affine' or 'value' was expected")
    pwa = pwa_of(system)
    centre = _state(equilibrium, len(pwa.x))
    cells = tuple(_moved(cell, centre) for cell in cells_of(pwa, law))
    _check_equilibrium(cells, centre, tolerances)
    found = _of_kind(kind, cells, tolerances, centre=centre, law=law, cuts=cuts)
    away = escape(found.cells)
    return replace(found, equilibrium=centre, escape=None if away is None else away + centre)


def _of_kind(
    kind: str,
    cells: tuple[Cell, ...],
    tolerances: LyapunovTolerances,
    *,
    centre: Vector,
    law: AffineLaw | None,
    cuts: int,
) -> Lyapunov:
    match kind:
        case "value":
            return _value_function(cells, centre, law)
        case "affine":
            return _affine(cells, cuts, tolerances)
        case _:
            P, margin, message = _Search(cells, kind, tolerances).solve()
            return Lyapunov(margin > tolerances.margin, kind, cells, P, centre, margin, message)


def _affine(cells: tuple[Cell, ...], cuts: int, tolerances: LyapunovTolerances) -> Lyapunov:
    if isinstance(cuts, bool) or not isinstance(cuts, int) or cuts < 0:
        raise ArgumentError(f"cuts is {cuts!r}: a whole number of at least 0 was expected")
    cells = cut_at_origin(cells, [_at_origin(cell, tolerances) for cell in cells])
    for _ in range(cuts):
        cells = cut_along_steps(cells)
    n = len(cells[0].f)
    found = search_affine(cells, [_at_origin(cell, tolerances) for cell in cells], tolerances.origin)
    P = np.zeros((len(found.c), n + 1, n + 1))
    P[:, :n, n] = P[:, n, :n] = found.p / 2
    P[:, n, n] = found.c
    kept = found.rate > tolerances.margin
    return Lyapunov(kept, "affine", cells, P, np.zeros(n), found.rate, found.message)


def _value_function(cells: tuple[Cell, ...], centre: Vector, law: AffineLaw | None) -> Lyapunov:
    """The value function of a law, less its value at the equilibrium, as a candidate that is checked."""
    if law is None or not getattr(law, "has_value", False):
        raise ArgumentError("there is no value function: give a law that has one, from before it was merged")
    n = len(centre)
    move = np.block([[np.eye(n), centre[:, None]], [np.zeros((1, n)), 1.0]])
    P = np.array([move.T @ _value_form(law, int(cell.law or 0)) @ move for cell in cells])
    P[:, n, n] -= law.value(centre)  # type: ignore[attr-defined]
    found = decrease_of(cells, P, DecreaseSettings())
    witness = None if found.witness is None else found.witness + centre
    margin = 1.0 if found.holds else -np.inf
    return Lyapunov(found.holds, "value", cells, P, centre, margin, found.message, witness=witness)


def _value_form(law: Any, region: int) -> Matrix:
    P, q = np.asarray(law.P[region]), np.asarray(law.q[region])
    return np.block([[P / 2, q[:, None] / 2], [q[None] / 2, float(law.r[region])]])


def _state(given: ArrayLike | None, n: int) -> Vector:
    centre = np.zeros(n) if given is None else np.asarray(given, dtype=float)
    if centre.shape != (n,) or not np.isfinite(centre).all():
        raise ArgumentError(f"equilibrium: {n} finite numbers were expected, found {given!r}")
    return centre


def _moved(cell: Cell, centre: Vector) -> Cell:
    """A cell in coordinates whose origin is a given state."""
    region = Polyhedron(cell.region.A, cell.region.b - cell.region.A @ centre, cell.region.precision)
    return Cell(region, cell.A, cell.A @ centre + cell.f - centre, cell.mode, cell.law)


def _check_equilibrium(cells: Sequence[Cell], centre: Vector, tolerances: LyapunovTolerances) -> None:
    here = [cell for cell in cells if _at_origin(cell, tolerances)]
    drift = max((float(np.abs(cell.f).max()) for cell in here), default=np.inf)
    if not drift <= tolerances.origin * max(1.0, float(np.abs(centre).max(initial=0.0))):
        raise ArgumentError(f"the state {centre.tolist()} is no equilibrium: a step moves it by {drift:.3g}")


def _at_origin(cell: Cell, tolerances: LyapunovTolerances) -> bool:
    return bool(np.all(cell.region.b >= -tolerances.origin * np.maximum(1.0, cell.region.lengths)))


class _Search:
    """The inequalities of all cells and transitions."""

    def __init__(self, cells: Sequence[Cell], kind: str, tolerances: LyapunovTolerances) -> None:
        self._cells = cells
        self._tolerances = tolerances
        self._system = Inequalities()
        self._at_origin = [_at_origin(cell, tolerances) for cell in cells]
        self._n = len(cells[0].f)
        common = self._system.symmetric(self._n) if kind == "quadratic" else None
        self._P = [self._function(i) if common is None else _padded(common) for i in range(len(cells))]

    def _function(self, cell: int) -> dict[int, Matrix]:
        """Unknowns of one function; it is zero at the equilibrium."""
        if self._at_origin[cell]:
            return _padded(self._system.symmetric(self._n))
        return self._system.symmetric(self._n + 1)

    def solve(self) -> tuple[Matrix, float, str]:
        """Functions, the least eigenvalue relative to what was demanded, and the word of the solver."""
        for i, cell in enumerate(self._cells):
            self._demand(self._rows(cell.region, self._at_origin[i]), (1.0, self._P[i]), at_origin=self._at_origin[i])
        for i, j, states in transitions(self._cells):
            step = np.block([[self._cells[i].A, self._cells[i].f[:, None]], [np.zeros((1, self._n)), 1.0]])
            after = {k: np.asarray(step.T @ M @ step) for k, M in self._P[j].items()}
            both = self._at_origin[i] and self._at_origin[j]
            self._demand(self._rows(states, both), (1.0, self._P[i]), (-1.0, after), at_origin=both)
        values, word = self._system.solve()
        if values is None:
            return np.zeros((0, self._n + 1, self._n + 1)), -np.inf, word
        P = np.array([sum(values[k] * M for k, M in basis.items()) for basis in self._P])
        return P, self._margin(values), word

    def _rows(self, region: Polyhedron, at_origin: bool) -> Matrix:
        """Forms that are not negative in a region; at the equilibrium only those that vanish there."""
        unit = region.minimal().normalised()
        if at_origin:
            through = np.abs(unit.b) <= self._tolerances.origin
            return np.column_stack([-unit.A[through], np.zeros(int(through.sum()))])
        return np.vstack([np.column_stack([-unit.A, unit.b]), np.eye(self._n + 1)[-1]])

    def _demand(self, rows: Matrix, *terms: tuple[float, dict[int, Matrix]], at_origin: bool) -> None:
        """The terms exceed the squared distance to the equilibrium wherever the rows are not negative."""
        size = self._n + (not at_origin)
        more = self._system.multipliers(rows)
        unit = np.eye(self._n + 1)[:size, :size]
        unit[self._n :] = 0.0
        self._system.require(-unit, *((f, _cut(basis, size)) for f, basis in (*terms, (-1.0, more))))

    def _margin(self, values: Vector) -> float:
        """Least eigenvalue of all inequalities with the demanded unit given back, and least multiplier."""
        least = 1.0
        clipped = values.copy()
        clipped[self._system.positive] = np.maximum(values[self._system.positive], 0.0)
        for constant, terms in self._system.blocks:
            total = constant + sum((clipped[k] * M for k, M in terms.items()), np.zeros_like(constant))
            least = min(least, 1.0 + float(np.linalg.eigvalsh(total)[0]))
        return least


def _padded(basis: dict[int, Matrix]) -> dict[int, Matrix]:
    """Quadratic forms in x as forms in (x, 1)."""
    return {k: np.pad(M, (0, 1)) for k, M in basis.items()}


def _cut(basis: dict[int, Matrix], size: int) -> dict[int, Matrix]:
    return {k: M[:size, :size] for k, M in basis.items()}
