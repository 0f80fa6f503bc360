"""Slices of an explicit law: some parameters set to numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import isfinite, nan
from typing import Any

import numpy as np

from hysdel_py.control.explicit_law import Array, ExplicitLaw, Vector
from hysdel_py.control.law_signals import LawSignals
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron

__all__ = ["fix", "section"]

_SAME = 1e-9
"""Difference of the coefficients up to which a row is one of the domain."""
_SHORT = 1e-12
"""A row of unit length that is shorter after fixing says nothing about the other parameters."""


def fix(law: ExplicitLaw, values: Mapping[str | int, float]) -> ExplicitLaw:
    """The law over the parameters that are not given.

    Parameters
    ----------
    law : ExplicitLaw
    values : mapping of names or positions to numbers

    Raises
    ------
    ArgumentError
        An unknown parameter, none left, or a value that the domain does not hold.
    """
    given = {_position(law, name): _number(value, name) for name, value in _mapping(values).items()}
    fixed = np.array(sorted(given), dtype=int)
    free = np.array([j for j in range(law.p) if j not in given], dtype=int)
    if not len(free):
        raise ArgumentError("all parameters are given: call the law instead")
    at = np.array([given[j] for j in fixed.tolist()])
    pieces = [(region, _cut(law.polyhedron(region), free, fixed, at)) for region in range(law.count)]
    kept = [(region, piece) for region, piece in pieces if piece is not None]
    A, b = _rows(law.domain.A, law.domain.b, free, fixed, at)
    real = np.linalg.norm(A, axis=1) > _SHORT
    _check_inside(law, given, b[~real])
    regions = [region for region, _ in kept]
    K, k = law.K[regions], law.k[regions]
    P, q, r = _value(law, regions, free, fixed, at)
    return replace(
        law,
        A=np.vstack([np.zeros((0, len(free))), *(piece.A for _, piece in kept)]),
        b=np.concatenate([np.zeros(0), *(piece.b for _, piece in kept)]),
        starts=np.cumsum([0, *(piece.m for _, piece in kept)]),
        K=K[:, :, free],
        k=k + K[:, :, fixed] @ at,
        P=P,
        q=q,
        r=r,
        active=tuple(law.active[region] for region in regions),
        domain=Polyhedron(A[real], b[real]),
        names=tuple(law.names[j] for j in free.tolist()),
        signals=_signals(law, given),
        objective=None if law.objective is None else law.objective.fixed(free, fixed, at),
    )


def _signals(law: ExplicitLaw, given: Mapping[int, float]) -> LawSignals | None:
    """What the parameters stand for, with those that are given among the fixed ones."""
    if law.signals is None:
        return None
    return replace(law.signals, fixed=(*law.signals.fixed, *((law.names[j], given[j]) for j in sorted(given))))


def section(law: ExplicitLaw, values: Mapping[str | int, float], window: Polyhedron) -> ExplicitLaw:
    """The law in a window, its regions continued beyond the domain.

    A region that the domain alone ends goes on: what lies outside the domain is where its law leads, not what was asked
    for. Pictures of laws often show sections like this.

    Parameters
    ----------
    law : ExplicitLaw
    values : mapping of names or positions to numbers
        Parameters to set.
    window : Polyhedron
        Of the others, in their order.

    Raises
    ------
    ArgumentError
        An unknown parameter, none left, or a window of another dimension.
    """
    open_law = fix(_without_ends(law), values)
    if window.n != open_law.p:
        raise ArgumentError(f"window has {window.n} columns: {open_law.p} were expected, {', '.join(open_law.names)}")
    pieces = [(i, _inside(open_law.polyhedron(i), window)) for i in range(open_law.count)]
    kept = [(i, piece) for i, piece in pieces if piece is not None]
    return replace(_chosen(open_law, kept), domain=window)


def _without_ends(law: ExplicitLaw) -> ExplicitLaw:
    """The same law without the rows that are those of its domain."""
    length = law.domain.lengths
    ends = np.column_stack([law.domain.A, law.domain.b]) / length[:, None]
    rows = np.column_stack([law.A, law.b])
    same = np.abs(rows[:, None] - ends[None]) <= _SAME * np.maximum(1.0, np.abs(ends))
    inner = np.array([not row.all(axis=1).any() for row in same], dtype=bool)
    before = np.concatenate([[0], np.cumsum(inner)])
    nowhere = Polyhedron(np.zeros((0, law.p)), np.zeros(0))
    return replace(law, A=law.A[inner], b=law.b[inner], starts=before[law.starts], domain=nowhere)


def _inside(region: Polyhedron, window: Polyhedron) -> Polyhedron | None:
    piece = region & window
    return None if piece.is_empty or piece.is_flat else _scaled(piece.minimal())


def _scaled(piece: Polyhedron) -> Polyhedron:
    return Polyhedron(piece.A / piece.lengths[:, None], piece.b / piece.lengths)


def _chosen(law: ExplicitLaw, kept: list[tuple[int, Polyhedron]]) -> ExplicitLaw:
    """Some regions of a law, with new rows."""
    regions = [i for i, _ in kept]
    values = {name: getattr(law, name)[regions] for name in ("P", "q", "r")} if law.has_value else {}
    return replace(
        law,
        A=np.vstack([np.zeros((0, law.p)), *(piece.A for _, piece in kept)]),
        b=np.concatenate([np.zeros(0), *(piece.b for _, piece in kept)]),
        starts=np.cumsum([0, *(piece.m for _, piece in kept)]),
        K=law.K[regions],
        k=law.k[regions],
        active=tuple(law.active[i] for i in regions),
        **values,
    )


def _position(law: ExplicitLaw, name: str | int) -> int:
    if isinstance(name, str) and name in law.names:
        return law.names.index(name)
    if isinstance(name, int) and 0 <= name < law.p:
        return name
    raise ArgumentError(f"{name!r} is no parameter of the law: {', '.join(law.names)} were expected")


def _mapping(values: Any) -> Mapping[str | int, Any]:
    if not isinstance(values, Mapping):
        raise ArgumentError(f"the values are {values!r}: a mapping of parameters to numbers was expected")
    return values


def _number(value: Any, name: str | int) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = nan
    if not isfinite(number):
        raise ArgumentError(f"{name} is {value!r}: a finite number was expected")
    return number


def _check_inside(law: ExplicitLaw, given: Mapping[int, float], sides: Vector) -> None:
    """Refuse values beyond an end of the domain, where the law would say that there is no plan."""
    if np.any(sides < -law.tolerance):
        values = ", ".join(f"{law.names[j]} = {value:g}" for j, value in given.items())
        raise ArgumentError(f"{values} lies outside the box of the law: a value inside was expected; widen the box")


def _rows(A: Array, b: Vector, free: Array, fixed: Array, at: Vector) -> tuple[Array, Vector]:
    return A[:, free].copy(), b - A[:, fixed] @ at


def _cut(region: Polyhedron, free: Array, fixed: Array, at: Vector) -> Polyhedron | None:
    """Section of a region with rows of length one, or None if it has no inner points."""
    A, b = _rows(region.A, region.b, free, fixed, at)
    length = np.linalg.norm(A, axis=1)
    real = length > _SHORT
    if np.any(b[~real] < 0):
        return None
    section = Polyhedron(A[real] / length[real, None], b[real] / length[real])
    return None if section.is_empty or section.is_flat else section.minimal()


def _value(law: ExplicitLaw, kept: list[int], free: Array, fixed: Array, at: Vector) -> tuple[Array, Array, Vector]:
    """Values of some regions with the given parameters put in."""
    if not law.has_value:
        return np.zeros((0, len(free), len(free))), np.zeros((0, len(free))), np.zeros(0)
    P, q = law.P[kept], law.q[kept]
    across = P[:, free][:, :, fixed] @ at
    own = 0.5 * (P[:, fixed][:, :, fixed] @ at) @ at
    return P[:, free][:, :, free], q[:, free] + across, law.r[kept] + q[:, fixed] @ at + own
