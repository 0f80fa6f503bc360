"""The MLD form of a piecewise affine system that is given by matrices: one binary and one product per mode.

Exactly one mode is chosen; its guard holds through big-M rows from the box of (x, u), and its product
d * (A x + B u + f) is the next state. Modes may share their edges: either of them may then be chosen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Kind, Type, Variable


@dataclass(frozen=True)
class Mode:
    """``x+ = A x + B u + f`` where ``G x + H u <= g``."""

    A: np.ndarray
    B: np.ndarray
    f: np.ndarray
    G: np.ndarray
    H: np.ndarray
    g: np.ndarray


@dataclass(frozen=True)
class Box:
    """Ends of the states and inputs; Boolean inputs by index."""

    x: tuple[np.ndarray, np.ndarray]
    u: tuple[np.ndarray, np.ndarray]
    booleans: tuple[int, ...] = ()


def interval(matrix, ends):
    """Least and greatest values of ``matrix v`` between the ends."""
    low, high = ends
    one, other = np.where(matrix == 0, 0.0, matrix * low), np.where(matrix == 0, 0.0, matrix * high)
    return np.minimum(one, other).sum(axis=1), np.maximum(one, other).sum(axis=1)


def mld_of_modes(modes: list[Mode], box: Box, C: np.ndarray, D: np.ndarray, g: np.ndarray) -> Mld:
    """Return the form; the output ``C x + D u + g`` is the same in all modes."""
    nx, nu, s = len(box.x[0]), len(box.u[0]), len(modes)
    rows = Rows(nu, s, s * nx, nx)
    rows.add(1.0, d=dict.fromkeys(range(s), 1.0))
    rows.add(-1.0, d=dict.fromkeys(range(s), -1.0))
    ends = np.concatenate([box.x[0], box.u[0]]), np.concatenate([box.x[1], box.u[1]])
    z = [Variable("", Type.REAL, Kind.REAL_AUX)] * (s * nx)
    for i, mode in enumerate(modes):
        add_guard(rows, i, mode, ends)
        low, high = (end + mode.f for end in interval(np.hstack([mode.A, mode.B]), ends))
        for j in range(nx):
            column = i * nx + j
            z[column] = Variable(f"z{i}_{j}", Type.REAL, Kind.REAL_AUX, min(0.0, low[j]), max(0.0, high[j]))
            add_product(rows, (column, i), (mode.A[j], mode.B[j], mode.f[j]), (low[j], high[j]))
    pick = np.hstack([np.eye(nx)] * s)
    nothing = np.zeros((nx, nx)), np.zeros((nx, nu)), np.zeros((nx, s))
    return Mld(
        "modes", variables("x", Kind.STATE, box.x), variables("u", Kind.INPUT, box.u, box.booleans),
        tuple(Variable(f"y{i + 1}", Type.REAL, Kind.OUTPUT) for i in range(len(C))),
        tuple(Variable(f"mode{i + 1}", Type.BOOL, Kind.BOOLEAN_AUX, 0, 1) for i in range(s)), tuple(z),
        *nothing, pick, np.zeros(nx), C, D, np.zeros((len(C), s)), np.zeros((len(C), s * nx)), g,
        *rows.matrices(), rows.origins(), (), (),
    )  # fmt: skip


def variables(letter, kind, ends, booleans=()):
    return tuple(
        Variable(f"{letter}{i + 1}", Type.BOOL if i in booleans else Type.REAL, kind, float(low), float(high))
        for i, (low, high) in enumerate(zip(*ends, strict=True))
    )


def add_guard(rows, i, mode, ends):
    """``G x + H u <= g + M (1 - d)`` with the least M that says nothing for d = 0."""
    most = interval(np.hstack([mode.G, mode.H]), ends)[1] - mode.g
    for row, M in enumerate(np.maximum(most, 0.0)):
        rows.add(mode.g[row] + M, d={i: M}, x=-mode.G[row], u=-mode.H[row])


def add_product(rows, where, form, ends):
    """``z = d (a x + b u + f)`` with the ends of the bracket."""
    (z, d), (a, b, f), (low, high) = where, form, ends
    rows.add(0.0, z={z: 1.0}, d={d: -high})
    rows.add(0.0, z={z: -1.0}, d={d: low})
    rows.add(f - low, z={z: 1.0}, d={d: -low}, x=a, u=b)
    rows.add(high - f, z={z: -1.0}, d={d: high}, x=-a, u=-b)


class Rows:
    """Rows ``E2 d + E3 z <= E1 u + E4 x + E5`` as they grow."""

    def __init__(self, nu, nd, nz, nx):
        self.sizes = {"u": nu, "d": nd, "z": nz, "x": nx}
        self.entries = {key: [] for key in self.sizes}
        self.E5 = []

    def add(self, constant, **parts):
        for key, size in self.sizes.items():
            part = parts.get(key, {})
            row = np.zeros(size)
            if isinstance(part, dict):
                for column, value in part.items():
                    row[column] = value
            else:
                row[:] = part
            self.entries[key].append(row)
        self.E5.append(constant)

    def matrices(self):
        dense = {key: np.array(rows).reshape(len(self.E5), self.sizes[key]) for key, rows in self.entries.items()}
        return (*(csr_array(dense[key]) for key in "udzx"), np.array(self.E5, dtype=float))

    def origins(self):
        return tuple(RowOrigin("AD", "AD", "", (), 1, 1, 1, 0, "mode") for _ in self.E5)
