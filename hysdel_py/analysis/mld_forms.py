"""The rows and equations of an Mld as affine forms over names."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from hysdel_py.systems.affine import Affine
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import Variable

__all__ = ["equations", "idle_auxiliaries", "row_forms"]


def row_forms(mld: Mld) -> tuple[Affine, ...]:
    """For each row the form that is at most zero."""
    blocks = ((mld.E2, mld.d, 1.0), (mld.E3, mld.z, 1.0), (mld.E1, mld.u, -1.0), (mld.E4, mld.x, -1.0))
    parts = [_sparse_terms(*block) for block in blocks]
    return tuple(
        Affine(-float(constant), tuple(term for part in parts for term in part[i])) for i, constant in enumerate(mld.E5)
    )


def _sparse_terms(matrix: Any, group: Sequence[Variable], sign: float) -> list[list[tuple[str, float]]]:
    rows = matrix.tocsr()
    return [
        [
            (group[j].name, sign * float(c))
            for j, c in zip(rows.indices[a:b], rows.data[a:b], strict=True)
            if c
        ]
        for a, b in pairwise(rows.indptr)
    ]  # fmt: skip


def equations(mld: Mld) -> tuple[dict[str, Affine], dict[str, Affine]]:
    """Right sides of the updates by state and of the outputs by output."""
    updates = _dense(mld, mld.x, (mld.A, mld.B1, mld.B2, mld.B3), mld.B5)
    outputs = _dense(mld, mld.y, (mld.C, mld.D1, mld.D2, mld.D3), mld.D5)
    return updates, outputs


def _dense(mld: Mld, left: Sequence[Variable], blocks: Sequence[Any], constants: Any) -> dict[str, Affine]:
    groups = (mld.x, mld.u, mld.d, mld.z)
    found = {}
    for i, variable in enumerate(left):
        terms = [
            (v.name, float(c)) for block, group in zip(blocks, groups, strict=True)
            for v, c in zip(group, block[i], strict=True) if c
        ]  # fmt: skip
        found[variable.name] = Affine(float(constants[i]), tuple(terms))
    return found


def idle_auxiliaries(mld: Mld) -> frozenset[str]:
    """Auxiliaries in no row and no equation; a step gives them the value 0."""
    updates, outputs = equations(mld)
    used = {name for form in (*row_forms(mld), *updates.values(), *outputs.values()) for name, _ in form.terms}
    return frozenset(v.name for v in (*mld.d, *mld.z) if v.name not in used)
