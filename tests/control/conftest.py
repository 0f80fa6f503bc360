"""Small MLD systems, written out by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_array

from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Kind, Type, Variable

EPS = 1e-6


def variable(name, kind, low=0.0, high=1.0, boolean=False, line=0):
    return Variable(name, Type.BOOL if boolean else Type.REAL, kind, low, high, line=line)


def origin(defines="", depends=(), line=0, text=""):
    return RowOrigin("AD", "AD", defines, tuple(depends), 1, 1, 1, line, text)


def assemble(name, x, u, y, d, z, update, output, rows):
    """Build an Mld from dense blocks: update and output as (X, U, D, Z, const), rows as a list of
    (d coefficients, z coefficients, u coefficients, x coefficients, constant, origin)."""
    nx, nu, nd, nz = len(x), len(u), len(d), len(z)

    def block(matrix, m, n):
        return np.asarray(matrix, dtype=float).reshape(m, n)

    def column(i, n):
        return csr_array(np.array([row[i] for row in rows], dtype=float).reshape(len(rows), n))

    A, B1, B2, B3 = (block(part, nx, n) for part, n in zip(update[:4], (nx, nu, nd, nz), strict=True))
    C, D1, D2, D3 = (block(part, len(y), n) for part, n in zip(output[:4], (nx, nu, nd, nz), strict=True))
    return Mld(
        name, x, u, y, d, z, A, B1, B2, B3, np.asarray(update[4], dtype=float),
        C, D1, D2, D3, np.asarray(output[4], dtype=float),
        column(2, nu), column(0, nd), column(1, nz), column(3, nx), np.array([row[4] for row in rows], dtype=float),
        tuple(row[5] for row in rows),
        tuple(origin(v.name, line=20 + i, text=f"{v.name} = ...") for i, v in enumerate(x)),
        tuple(origin(v.name) for v in y),
    )  # fmt: skip


def fold(right=-0.5, left=0.8, span=10.0, power=1.0):
    """x+ = right x + u where x >= 0, left x + u elsewhere; y = x. d = [x >= 0], z = d x."""
    side = origin("side", ("x",), 7, "side = x >= 0;")
    part = origin("part", ("side", "x"), 9, "part = {IF side THEN x};")
    rows = [
        ([span], [0], [0], [1], span, side),
        ([-(span + EPS)], [0], [0], [-1], -EPS, side),
        ([-span], [1], [0], [0], 0, part),
        ([-span], [-1], [0], [0], 0, part),
        ([span], [1], [0], [1], span, part),
        ([span], [-1], [0], [-1], span, part),
    ]
    return assemble(
        "fold",
        (variable("x", Kind.STATE, -span, span),),
        (variable("push", Kind.INPUT, -power, power),),
        (variable("seen", Kind.OUTPUT, -np.inf, np.inf),),
        (variable("side", Kind.BOOLEAN_AUX, boolean=True, line=7),),
        (variable("part", Kind.REAL_AUX, -span, span, line=9),),
        ([[left]], [[1]], [[0]], [[right - left]], [0]),
        ([[1]], [[0]], [[0]], [[0]], [0]),
        rows,
    )


def fold_step(right=-0.5, left=0.8):
    def step(x, u):
        side = float(x[0] >= 0)
        return (right if side else left) * x + u, x.copy(), np.array([side]), side * x

    return step


def heater():
    """A temperature, a Boolean state that remembers the switch, and heat where switch and memory are both on.

    T+ = 0.9 T + 3 heat + fan; on+ = switch; heat = on & switch; y = (T + 0.5 fan, heat).
    """
    heat = origin("heat", ("on", "switch"), 5, "heat = on & switch;")
    rows = [
        ([1], [], [0, 0], [0, 1], 0, heat),
        ([1], [], [0, 1], [0, 0], 0, heat),
        ([-1], [], [0, -1], [0, -1], 1, heat),
    ]
    return assemble(
        "heater",
        (variable("T", Kind.STATE, -50, 50), variable("on", Kind.STATE, boolean=True)),
        (variable("fan", Kind.INPUT, -1, 1), variable("switch", Kind.INPUT, boolean=True)),
        (variable("felt", Kind.OUTPUT, -np.inf, np.inf), variable("hot", Kind.OUTPUT, boolean=True)),
        (variable("heat", Kind.BOOLEAN_AUX, boolean=True, line=5),),
        (),
        ([[0.9, 0], [0, 0]], [[1, 0], [0, 1]], [[3], [0]], [], [0, 0]),
        ([[1, 0], [0, 0]], [[0.5, 0], [0, 0]], [[0], [1]], [], [0, 0]),
        rows,
    )


def heater_step(x, u):
    heat = float(x[1] and u[1])
    y = np.array([x[0] + 0.5 * u[0], heat])
    return np.array([0.9 * x[0] + 3 * heat + u[0], u[1]]), y, np.array([heat]), np.zeros(0)


@pytest.fixture(scope="session")
def systems():
    return SimpleNamespace(
        fold=fold, fold_step=fold_step, heater=heater, heater_step=heater_step, assemble=assemble,
        variable=variable, origin=origin,
    )  # fmt: skip
