"""Regions of different sequences that overlap: what is never best is removed.

With the norms 1 and infinity values are affine, so that the part of a region where another one is better is a
polyhedron. It is cut out, and what is left is cut into polyhedra: a partition remains. With norm 2 that part is bounded
by a quadric; regions stay whole, and one is removed if others that are proven to be nowhere worse cover it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.hybrid_dominance import Region, is_never_best, meet, scale_of
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.control.hybrid_sequences import TIE, SequenceLaw
from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.parametric.cover import Rows, parts_outside, point_inside
from hysdel_py.optimize.parametric.settings import MpQpSettings

__all__ = ["as_single", "joined", "without_overlaps"]

Vector = NDArray[np.float64]

_ROOM = 1e-7
"""A piece that is left of a region holds a ball of this radius (parameters scaled to [-1, 1])."""


def without_overlaps(law: HybridLaw) -> HybridLaw:
    """The same law without regions that are never best; for the norms 1 and infinity without overlaps."""
    kept: dict[int, list[tuple[int, Rows | None]]] = {}
    for regions in _groups(law):
        for region, rows in _partitioned(regions) if law.norm != "2" else _undominated(regions):
            kept.setdefault(region.sequence, []).append((region.number, rows))
    sequences = tuple(
        SequenceLaw(sequence.word, _cut(sequence.law, kept[number]))
        for number, sequence in enumerate(law.sequences)
        if number in kept
    )
    return replace(law, sequences=sequences, partition=law.norm != "2" or len(sequences) < 2)


def as_single(law: HybridLaw, booleans: Mapping[str, float]) -> ExplicitLaw:
    """All regions for some values of the Boolean parameters as one law."""
    if not law.partition:
        raise ArgumentError("regions of different sequences overlap: law.reduced() parts them for the norms 1 and inf")
    names = [parameter.name for parameter in law.parameters.boolean]
    if sorted(booleans) != sorted(names):
        raise ArgumentError(f"booleans names {', '.join(booleans) or 'nothing'}: {', '.join(names)} were expected")
    word = tuple(int(booleans[name]) for name in names)
    laws = [sequence.law for sequence in law.sequences if sequence.word[: len(word)] == word]
    if not laws:
        raise ArgumentError("no sequence has a region for these values of the Boolean parameters")
    return replace(joined(laws), complete=law.complete)


def joined(laws: Sequence[ExplicitLaw]) -> ExplicitLaw:
    """The regions of several laws over the same parameters one after another, overlaps included."""
    offsets = np.cumsum([0, *(len(part.b) for part in laws)])
    starts = [part.starts[:-1] + offset for part, offset in zip(laws, offsets[:-1], strict=True)]
    joined: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in laws]) for name in "AbKkPqr"}
    return replace(
        laws[0],
        **joined,
        starts=np.concatenate([*starts, offsets[-1:]]),
        active=tuple(rows for part in laws for rows in part.active),
        complete=all(part.complete for part in laws),
    )


def _groups(law: HybridLaw) -> Iterator[list[Region]]:
    """Regions that can overlap: those of equal Boolean parameters."""
    size = len(law.parameters.boolean)
    groups: dict[tuple[int, ...], list[Region]] = {}
    for number, sequence in enumerate(law.sequences):
        scale = scale_of(sequence.law.domain)
        groups.setdefault(sequence.word[:size], []).extend(
            Region.of(sequence.law, number, region, scale) for region in range(sequence.law.count)
        )
    yield from groups.values()


def _partitioned(regions: list[Region]) -> Iterator[tuple[Region, Rows | None]]:
    """Pieces of the regions in which they are best."""
    settings = MpQpSettings()
    for region in regions:
        pieces, touched = [region.rows], False
        for rival in regions:
            if rival.sequence == region.sequence or not pieces or not meet(region, rival):
                continue
            better = _better(region, rival)
            if better is None:
                continue
            left = [part for piece in pieces for part in _without(piece, better, settings)]
            touched = touched or len(left) != len(pieces) or any(a is not b for a, b in zip(left, pieces, strict=True))
            pieces = left
        for piece in pieces:
            yield region, region.unscaled(piece) if touched else None


def _better(region: Region, rival: Region) -> Rows | None:
    """Where the rival is to be preferred; None if nowhere."""
    slope, offset = rival.q - region.q, rival.r - region.r
    size = max(1.0, abs(region.r), float(np.abs(region.q).max(initial=0.0)))
    if np.abs(slope).sum() + abs(offset) <= TIE * size:
        return rival.rows if rival.sequence < region.sequence else None
    length = float(np.linalg.norm(slope))
    if length <= TIE * size:
        return rival.rows if offset < 0 else None
    return np.vstack([slope / length, rival.rows[0]]), np.append(-offset / length, rival.rows[1])


def _without(piece: Rows, better: Rows, settings: MpQpSettings) -> list[Rows]:
    """What is left of a piece, itself if it loses nothing."""
    both = np.vstack([piece[0], better[0]]), np.concatenate([piece[1], better[1]])
    if point_inside(both, _ROOM, settings) is None:
        return [piece]
    return [part for part in parts_outside(piece, better) if point_inside(part, _ROOM, settings) is not None]


def _undominated(regions: list[Region]) -> Iterator[tuple[Region, Rows | None]]:
    """Regions that are not proven to be never best; of equal ones the first stays."""
    kept = list(range(len(regions)))
    for number in reversed(range(len(regions))):
        region = regions[number]
        rivals = [regions[other] for other in kept if regions[other].sequence != region.sequence]
        if is_never_best(region, rivals):
            kept.remove(number)
    yield from ((regions[number], None) for number in kept)


def _cut(law: ExplicitLaw, entries: list[tuple[int, Rows | None]]) -> ExplicitLaw:
    """A law of some regions of another one, with other rows where they are given."""
    rows = [law.rows(region) if own is None else _minimal(own) for region, own in entries]
    chosen = [region for region, _ in entries]
    return replace(
        law,
        A=np.vstack([A for A, _ in rows]),
        b=np.concatenate([b for _, b in rows]),
        starts=np.cumsum([0, *(len(b) for _, b in rows)]),
        K=law.K[chosen],
        k=law.k[chosen],
        P=law.P[chosen],
        q=law.q[chosen],
        r=law.r[chosen],
        active=tuple(law.active[region] for region in chosen),
    )


def _minimal(rows: Rows) -> Rows:
    polyhedron = Polyhedron(*rows).minimal()
    return polyhedron.A, polyhedron.b
