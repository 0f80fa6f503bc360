"""Lyapunov functions of piecewise affine systems: quadratic, affine by pieces, or the value function of a law.

Each kind is searched, or checked, in a module of its own; here are the question, the answer and what they share.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.analysis.affine_lyapunov import cut_along_steps, cut_at_origin, search_affine
from hysdel_py.analysis.cells import AffineLaw, Cell, cells_of, escape, thin_cells
from hysdel_py.analysis.counts import counted
from hysdel_py.analysis.quadratic_lyapunov import (
    DEFAULT_LYAPUNOV_TOLERANCES,
    LyapunovTolerances,
    QuadraticSearch,
    at_origin,
)
from hysdel_py.analysis.reach import HasPwa, pwa_of
from hysdel_py.analysis.value_decrease import DecreaseSettings, decrease_of
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.systems.pwa import Pwa

__all__ = ["Lyapunov", "LyapunovTolerances", "lyapunov"]

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]


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
    tolerances: LyapunovTolerances = DEFAULT_LYAPUNOV_TOLERANCES,
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
        Boolean states, inputs without a law, a mode without inner points that steps otherwise than the states around
        it, a state that is no equilibrium, a value function that is asked for and
        not known, cells without bounds for an affine function; or clarabel, the extra `stability`, which quadratic
        functions need, is not installed.
    """
    if kind not in ("quadratic", "piecewise", "affine", "value"):
        raise ArgumentError(f"kind is {kind!r}: 'quadratic', 'piecewise', 'affine' or 'value' was expected")
    pwa = pwa_of(system)
    centre = _state(equilibrium, len(pwa.x))
    cells = tuple(_moved(cell, centre) for cell in cells_of(pwa, law, flat=True))
    _check_equilibrium(cells, centre, tolerances)
    cells = _with_inner_points(cells, tolerances)
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
            P, margin, message = QuadraticSearch(cells, kind, tolerances).solve()
            return Lyapunov(margin > tolerances.margin, kind, cells, P, centre, margin, message)


def _affine(cells: tuple[Cell, ...], cuts: int, tolerances: LyapunovTolerances) -> Lyapunov:
    cells = cut_at_origin(cells, [at_origin(cell, tolerances) for cell in cells])
    for _ in range(counted(cuts, 0, "cuts")):
        cells = cut_along_steps(cells)
    n = len(cells[0].f)
    found = search_affine(cells, [at_origin(cell, tolerances) for cell in cells], tolerances.origin)
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
    try:
        centre = np.zeros(n) if given is None else np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        centre = np.zeros(0 if n else 1)
    if centre.shape != (n,) or not np.isfinite(centre).all():
        raise ArgumentError(f"equilibrium: {n} finite numbers were expected, found {given!r}")
    return centre


def _moved(cell: Cell, centre: Vector) -> Cell:
    """A cell in coordinates whose origin is a given state."""
    region = Polyhedron(cell.region.A, cell.region.b - cell.region.A @ centre, cell.region.precision)
    return Cell(region, cell.A, cell.A @ centre + cell.f - centre, cell.mode, cell.law)


def _with_inner_points(cells: tuple[Cell, ...], tolerances: LyapunovTolerances) -> tuple[Cell, ...]:
    """Cells that functions are searched for; one without inner points may be the equilibrium alone."""
    thin = [cell for cell in thin_cells(cells) if cell.region.dimension or not at_origin(cell, tolerances)]
    if thin:
        raise ArgumentError(
            f"mode {thin[0].mode} holds on states without inner points and steps otherwise than those around it: no "
            "function is searched for it; let one of its thresholds be strict, or take a coordinate out of an equality"
        )
    return tuple(cell for cell in cells if cell.region.ball.radius > cell.region.precision.empty)


def _check_equilibrium(cells: Sequence[Cell], centre: Vector, tolerances: LyapunovTolerances) -> None:
    here = [cell for cell in cells if at_origin(cell, tolerances)]
    if not here:
        raise ArgumentError(f"the state {centre.tolist()} is no equilibrium: it lies in no cell")
    drift = max(float(np.abs(cell.f).max()) for cell in here)
    if not drift <= tolerances.origin * max(1.0, float(np.abs(centre).max(initial=0.0))):
        raise ArgumentError(f"the state {centre.tolist()} is no equilibrium: a step moves it by {drift:.3g}")
