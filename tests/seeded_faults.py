"""Faults put into an Mld or a Pwa on purpose, as a lowering with a mistake would make them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array

from hysdel_py.geometry.polyhedron import Polyhedron

INEQUALITIES = ("E1", "E2", "E3", "E4")
EQUATIONS = ("A", "B1", "B2", "B3", "B5", "C", "D1", "D2", "D3", "D5")


def with_rows(mld, rows, E5, origins=None):
    """The form with other rows; `rows` are dense."""
    sparse = {name: csr_array(rows[name]) for name in INEQUALITIES}
    return replace(mld, **sparse, E5=E5, rows=mld.rows if origins is None else origins)


def dense_rows(mld):
    return {name: getattr(mld, name).toarray() for name in INEQUALITIES}


def row_scale(mld, i):
    """Greatest size of a coefficient of a row."""
    return max(*(abs(rows[i]).max(initial=0.0) for rows in dense_rows(mld).values()), abs(mld.E5[i])) or 1.0


def drop_row(mld, i):
    rows = {name: np.delete(matrix, i, axis=0) for name, matrix in dense_rows(mld).items()}
    return with_rows(mld, rows, np.delete(mld.E5, i), mld.rows[:i] + mld.rows[i + 1 :])


def flip_row(mld, i):
    rows = dense_rows(mld)
    for matrix in rows.values():
        matrix[i] *= -1.0
    E5 = mld.E5.copy()
    E5[i] *= -1.0
    return with_rows(mld, rows, E5)


def shift_row(mld, i, amount):
    """A wrong interval end: the constant of a row, and with it a Boolean that it belongs to."""
    E5 = mld.E5.copy()
    E5[i] += amount
    return with_rows(mld, dense_rows(mld), E5)


def change_constant(mld, i, amount, column):
    """A wrong big-M: the coefficient of one Boolean."""
    rows = dense_rows(mld)
    rows["E2"][i, column] += amount
    return with_rows(mld, rows, mld.E5.copy())


def change_epsilon(mld, i, amount):
    """Another epsilon in the first row of an event, ``(m - eps) d - f <= -eps``."""
    rows = dense_rows(mld)
    column = [v.name for v in mld.d].index(mld.rows[i].defines)
    rows["E2"][i, column] -= amount
    E5 = mld.E5.copy()
    E5[i] -= amount
    return with_rows(mld, rows, E5)


def change_coefficient(mld, name, place, amount):
    """Another coefficient of a row, an update or an output."""
    matrix = getattr(mld, name)
    changed = matrix.toarray() if name in INEQUALITIES else matrix.copy()
    changed[place] += amount
    if name in INEQUALITIES:
        return with_rows(mld, dense_rows(mld) | {name: changed}, mld.E5.copy())
    return replace(mld, **{name: changed})


def event_rows(mld):
    """First rows of the events."""
    return [i for i, origin in enumerate(mld.rows) if origin.item == "AD" and origin.subindex == 1]


def random_fault(mld, generator):
    """(kind, faulty form) of one fault, None where the drawn kind has no place in this form."""
    kinds = {"dropped row": _dropped, "flipped row": _flipped, "wrong interval": _shifted, "wrong big-M": _big_m,
             "wrong epsilon": _epsilon, "wrong coefficient": _coefficient, "wrong equation": _equation}  # fmt: skip
    kind = list(kinds)[int(generator.integers(len(kinds)))]
    faulty = kinds[kind](mld, generator)
    return None if faulty is None else (kind, faulty)


def _row(mld, generator):
    return int(generator.integers(mld.ne))


def _amount(generator, scale):
    return float(generator.choice([-1.0, 1.0]) * generator.choice([0.01, 0.1, 0.5]) * scale)


def _dropped(mld, generator):
    return drop_row(mld, _row(mld, generator)) if mld.ne else None


def _flipped(mld, generator):
    return flip_row(mld, _row(mld, generator)) if mld.ne else None


def _shifted(mld, generator):
    if not mld.ne:
        return None
    i = _row(mld, generator)
    return shift_row(mld, i, _amount(generator, row_scale(mld, i)))


def _big_m(mld, generator):
    places = np.argwhere(mld.E2.toarray())
    if not len(places):
        return None
    i, j = places[int(generator.integers(len(places)))]
    return change_constant(mld, int(i), _amount(generator, row_scale(mld, i)), int(j))


def _epsilon(mld, generator):
    rows = event_rows(mld)
    if not rows:
        return None
    i = rows[int(generator.integers(len(rows)))]
    return change_epsilon(mld, i, float(generator.choice([0.05, -0.05, 0.3]) * row_scale(mld, i)))


def _coefficient(mld, generator):
    name = str(generator.choice(INEQUALITIES))
    places = np.argwhere(getattr(mld, name).toarray())
    if not len(places):
        return None
    place = tuple(int(k) for k in places[int(generator.integers(len(places)))])
    return change_coefficient(mld, name, place, _amount(generator, row_scale(mld, place[0])))


def _equation(mld, generator):
    name = str(generator.choice(EQUATIONS))
    matrix = getattr(mld, name)
    if not matrix.size:
        return None
    place = tuple(int(generator.integers(n)) for n in matrix.shape)
    return change_coefficient(mld, name, place, _amount(generator, abs(matrix).max() or 1.0))


# ---- faults of a Pwa -------------------------------------------------------------------------------------------------


def lose_mode(pwa, i):
    """The form without a mode; without its tree too, which would still lead there."""
    modes = tuple(replace(mode, index=k) for k, mode in enumerate(m for m in pwa.modes if m.index != i))
    kept = [leaf for leaf, owner in enumerate(pwa.owner) if owner != i]
    owner = tuple(pwa.owner[leaf] - (pwa.owner[leaf] > i) for leaf in kept)
    leaves = tuple(pwa.leaves[leaf] for leaf in kept)
    return replace(pwa, modes=modes, owner=owner, leaves=leaves, tree=None, tests=(), dead_ends=())


def with_mode(pwa, i, **changed):
    """The form with other fields of a mode."""
    return replace(pwa, modes=tuple(replace(m, **changed) if m.index == i else m for m in pwa.modes))


def change_map(pwa, i, name, place, amount):
    """Another coefficient or offset of an update or an output."""
    matrix = getattr(pwa.modes[i], name).copy()
    matrix[place] += amount
    return with_mode(pwa, i, **{name: matrix})


def drop_region_row(pwa, i, row):
    region, sources = pwa.modes[i].region, pwa.modes[i].sources
    kept = Polyhedron(np.delete(region.A, row, axis=0), np.delete(region.b, row), region.precision)
    return with_mode(pwa, i, region=kept, sources=sources[:row] + sources[row + 1 :])


def change_region_row(pwa, i, row, sign=1.0, amount=0.0):
    """A row that is flipped, or moved by an amount."""
    region = pwa.modes[i].region
    A, b = region.A.copy(), region.b.copy()
    A[row] *= sign
    b[row] = sign * b[row] + amount
    return with_mode(pwa, i, region=Polyhedron(A, b, region.precision))


def swap_words(pwa, i, j):
    first, second = pwa.modes[i].word, pwa.modes[j].word
    return with_mode(with_mode(pwa, i, word=second), j, word=first)


def region_row_scale(pwa, i, row):
    """Greatest size of a term of a row of a region within the ranges."""
    region = pwa.modes[i].region
    sizes = [max(abs(end) for end in (v.low, v.high)) for v in (*pwa.x, *pwa.u)]
    return float(max(*(abs(region.A[row]) * np.minimum(sizes, 1e3)), abs(region.b[row]), 1e-3))


PWA_FAULTS = ("lost mode", "changed coefficient", "changed offset", "dropped region row", "moved region row",
              "flipped region row", "swapped words")  # fmt: skip


def pwa_fault(pwa, kind, generator):
    """The form with a fault of a kind, None where that has no place in it."""
    i = int(generator.integers(len(pwa.modes)))
    rows = [k for k, source in enumerate(pwa.modes[i].sources) if source.kind.value != "boolean"]
    row = int(generator.choice(rows)) if rows else None
    match kind:
        case "lost mode":
            return lose_mode(pwa, i)
        case "changed coefficient" | "changed offset":
            return _changed_map(pwa, i, "ABCD" if kind == "changed coefficient" else "fg", generator)
        case "swapped words":
            others = [m.index for m in pwa.modes if m.word != pwa.modes[i].word]
            return swap_words(pwa, i, int(generator.choice(others))) if others else None
        case _ if row is None:
            return None
        case "dropped region row":
            return drop_region_row(pwa, i, row)
        case "flipped region row":
            return change_region_row(pwa, i, row, sign=-1.0)
        case "moved region row":
            return change_region_row(pwa, i, row, amount=_amount(generator, region_row_scale(pwa, i, row)))


def _changed_map(pwa, i, names, generator):
    sized = [name for name in names if getattr(pwa.modes[i], name).size]
    if not sized:
        return None
    name = str(generator.choice(sized))
    matrix = getattr(pwa.modes[i], name)
    place = tuple(int(generator.integers(n)) for n in matrix.shape)
    return change_map(pwa, i, name, place, _amount(generator, abs(matrix).max() or 1.0))
