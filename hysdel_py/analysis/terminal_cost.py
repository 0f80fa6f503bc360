"""By how much one more step at the end of a plan can add to its cost.

The added cost is that of the step and the change of the terminal weight. On each mode of the piecewise affine form it
is a quadratic function of states and inputs, which is bounded from above over the states in which a plan may end and
the inputs that lead back there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hysdel_py.analysis.hybrid_set import HybridSet
from hysdel_py.analysis.least_cost import Squares
from hysdel_py.analysis.output_limits import with_output_limits
from hysdel_py.analysis.pwa_branches import Branch
from hysdel_py.analysis.quadratic_bound import Quadratic, is_nowhere_positive
from hysdel_py.analysis.terminal_step import LastLaw, Limited, steps_between
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.systems.pwa import Pwa
from hysdel_py.systems.signals import Variable

__all__ = ["AddedCost", "greatest_addition"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Form = tuple[Matrix, Vector]
"""``M (v, s) + m`` of real states v and inputs s."""

_MARGIN = 0.01  # of what may be added: the bound is tried so much above the greatest value that was seen
_NEGLIGIBLE = 1e-9  # coefficients below this, relative to the greatest, are rounding
_ROUNDS = 20


@dataclass(frozen=True, eq=False, slots=True)
class AddedCost:
    """What one more step adds.

    Attributes
    ----------
    bound : float or None
        No step adds more; None where that was not found within the parts, or where there is no step.
    seen : float
        The greatest that was seen; minus infinity where there is no step.
    state : array of shape (n,) or None
        Real states where it was seen.
    regions : int
        Parts of the states, one for each mode.
    """

    bound: float | None
    seen: float
    state: Vector | None
    regions: int


def greatest_addition(
    pwa: Pwa,
    ends: HybridSet,
    limits: Limited,
    costs: tuple[Squares, Squares],
    law: LastLaw | None = None,
    *,
    allowed: float,
    parts: int,
) -> AddedCost:
    """Bound what one more step adds from above.

    Parameters
    ----------
    pwa : Pwa
    ends : HybridSet
        In which plans end, within the limits.
    limits : Limited
    costs : (Squares, Squares)
        Of a step and of the last state.
    law : LastLaw, optional
        The input of the step; without it the worst one that leads back counts.
    allowed : float
        What may be added; sets how fine the bound is looked for.
    parts : int
        Parts of a region that are looked at, at most.

    Raises
    ------
    ArgumentError
        A weighted signal that a mode leaves open.
    """
    pieces = list(_pieces(with_output_limits(pwa, limits.outputs), ends, limits, costs, law))
    seen, state = _seen(pieces)
    if seen == -np.inf:
        return AddedCost(None, seen, None, len(pieces))
    bound = seen + _MARGIN * max(1.0, abs(allowed))
    for _ in range(_ROUNDS):
        higher = None
        for function, region in pieces:
            shifted = Quadratic(function.H, function.g, function.c - bound)
            found = is_nowhere_positive(shifted, region, 0.0, parts)
            if not found.holds and found.witness is None:
                return AddedCost(None, seen, state, len(pieces))
            if not found.holds:
                higher = found.witness
                seen, state = float(function(higher[None])[0]), higher  # type: ignore[index]
                break
        if higher is None:
            return AddedCost(bound, seen, state, len(pieces))
        bound = seen + _MARGIN * max(1.0, abs(allowed))
    return AddedCost(None, seen, state, len(pieces))


def _seen(pieces: list[tuple[Quadratic, Polyhedron]]) -> tuple[float, Vector | None]:
    """The greatest value at a vertex."""
    seen, state = -np.inf, None
    for function, region in pieces:
        values = function(region.vertices)
        if len(values) and values.max() > seen:
            seen, state = float(values.max()), region.vertices[int(np.argmax(values))]
    return seen, state


def _pieces(
    pwa: Pwa, ends: HybridSet, limits: Limited, costs: tuple[Squares, Squares], law: LastLaw | None
) -> Iterator[tuple[Quadratic, Polyhedron]]:
    for branch, steps, _ in steps_between(pwa, ends, ends, limits, law):
        function = _addition(pwa, branch, *costs)
        if law is None:
            function, region = _without_inputs(function, steps, len(branch.f))
        else:
            function, region = _substituted(function, steps, law.reals(pwa))
        if not region.is_empty:
            yield function, region


def _substituted(function: Quadratic, region: Polyhedron, law: tuple[Matrix, Vector]) -> tuple[Quadratic, Polyhedron]:
    """Over the states alone, with the inputs of a law."""
    L, shift = law
    H, g = function.H, function.g
    moved = Quadratic(L.T @ H @ L, L.T @ (2 * H @ shift + g), float(shift @ H @ shift + g @ shift + function.c))
    return moved, region.preimage(L, shift)


def _without_inputs(function: Quadratic, region: Polyhedron, n: int) -> tuple[Quadratic, Polyhedron]:
    """Over the states alone where the inputs do not matter; rows of inputs are left out, which is no less safe."""
    size = max(float(np.abs(function.H).max(initial=0.0)), float(np.abs(function.g).max(initial=0.0)))
    of_inputs = max(float(np.abs(function.H[n:]).max(initial=0.0)), float(np.abs(function.g[n:]).max(initial=0.0)))
    if of_inputs > _NEGLIGIBLE * size:
        return function, region
    own = ~np.any(region.A[:, n:] != 0.0, axis=1)
    return Quadratic(function.H[:n, :n], function.g[:n], function.c), Polyhedron(region.A[own, :n], region.b[own])


@dataclass(frozen=True, eq=False, slots=True)
class _Moment:
    """The states ``M (v, s) + m`` with Boolean ones, before or after the step of a branch."""

    M: Matrix
    m: Vector
    word: tuple[bool, ...]


def _addition(pwa: Pwa, branch: Branch, stage: Squares, terminal: Squares) -> Quadratic:
    n = len(branch.f)
    here = _Moment(np.hstack([np.eye(n), np.zeros_like(branch.B)]), np.zeros(n), branch.word)
    after = _Moment(np.hstack([branch.A, branch.B]), branch.f, branch.next_word)
    cost = _square(stage, _forms(pwa, branch, stage, here))
    gain = _square(terminal, _forms(pwa, branch, terminal, after))
    loss = _square(terminal, _forms(pwa, branch, terminal, here))
    return Quadratic(cost.H + gain.H - loss.H, cost.g + gain.g - loss.g, cost.c + gain.c - loss.c)


def _square(squares: Squares, form: Form) -> Quadratic:
    M, m = form
    away = m - squares.r
    return Quadratic(M.T @ squares.Q @ M, 2 * M.T @ squares.Q @ away, float(away @ squares.Q @ away))


def _forms(pwa: Pwa, branch: Branch, squares: Squares, moment: _Moment) -> Form:
    """The signals of a cost."""
    rows = [_form(pwa, branch, signal, moment) for signal in squares.signals]
    size = moment.M.shape[1]
    return np.array([row for row, _ in rows]).reshape(-1, size), np.array([constant for _, constant in rows])


def _form(pwa: Pwa, branch: Branch, signal: tuple[str, str], moment: _Moment) -> tuple[Vector, float]:
    match signal:
        case "y", name:
            return _output(pwa, branch, name)
        case "d", name:
            return _auxiliary(pwa, branch, name, moment.M.shape[1])
        case "x", name:
            return _state(pwa, name, moment)
        case _, name:
            return _input(pwa, branch, name)


def _auxiliary(pwa: Pwa, branch: Branch, name: str, size: int) -> tuple[Vector, float]:
    value = dict(pwa.modes[branch.mode].word).get(name)
    if value is None:
        raise ArgumentError(f"the weighted Boolean {name} has both values in a mode of the piecewise affine form")
    return np.zeros(size), float(value)


def _state(pwa: Pwa, name: str, moment: _Moment) -> tuple[Vector, float]:
    logical, k = _place(pwa.x, name)
    return (np.zeros(moment.M.shape[1]), float(moment.word[k])) if logical else (moment.M[k], float(moment.m[k]))


def _input(pwa: Pwa, branch: Branch, name: str) -> tuple[Vector, float]:
    (n, m), (logical, k) = branch.B.shape, _place(pwa.u, name)
    return (np.zeros(n + m), float(branch.inputs[k])) if logical else (np.eye(n + m)[n + k], 0.0)


def _place(variables: Sequence[Variable], name: str) -> tuple[bool, int]:
    """Whether a variable is Boolean, and which of the Boolean or real ones it is."""
    logical = next(v.is_bool for v in variables if v.name == name)
    return logical, [v.name for v in variables if v.is_bool == logical].index(name)


def _output(pwa: Pwa, branch: Branch, name: str) -> tuple[Vector, float]:
    mode, variables = pwa.modes[branch.mode], (*pwa.x, *pwa.u)
    k = [v.name for v in pwa.y].index(name)
    row = np.concatenate([mode.C[k], mode.D[k]])
    real = np.array([not v.is_bool for v in variables])
    values = np.array([*branch.word, *branch.inputs], dtype=float)
    return row[real], float(mode.g[k] + row[~real] @ values)
