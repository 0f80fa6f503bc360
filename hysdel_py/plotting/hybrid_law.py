"""Pictures of explicit hybrid laws: where regions of several sequences overlap, that with the least value is shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.explicit_parameters import Parameter
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.control.hybrid_overlaps import joined
from hysdel_py.control.hybrid_sequences import TIE
from hysdel_py.errors import ArgumentError
from hysdel_py.plotting.law import Shown, check_words, draw, name_kinds, new_partition
from hysdel_py.plotting.law_pieces import colour_of, kinds_of, law_text, ranked, values_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["best_regions", "plot_hybrid_law"]

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

NONE = -1
"""No region holds the point."""

_ALONG = 4001
"""Points along the axis of a law over one parameter."""


def plot_hybrid_law(
    law: HybridLaw,
    what: str = "partition",
    *,
    section: Mapping[str, float] | None = None,
    by: str = "law",
    move: str | int = 0,
    points: int = 500,
) -> Figure:
    """Draw a hybrid law over two of its real parameters, or one.

    Parameters
    ----------
    law : HybridLaw
    what : str
        ``"partition"``, ``"move"`` or ``"value"``. Over one parameter all three show the moves, and the value beneath.
    section : mapping of name to number, optional
        Parameters that are fixed. Of the others the first two real ones are drawn; the rest is put at the middle of
        its box, Booleans at 0.
    by : str
        ``"law"``: equal moves have equal colours; ``"region"``: every region has its own.
    move : str or int
        The input shown by ``what="move"``, by name or number.
    points : int
        Points along each axis where regions overlap: their borders are curves there, and the picture consists of dots.

    Raises
    ------
    ArgumentError
        An unknown name, word or number, or there is nothing in the section.
    """
    number = _checked(law, what, by, move, points)
    drawn, values = _chosen(law, {} if section is None else section)
    cut = _cut(law, values, [parameter.name for parameter in drawn])
    shown = _labels(law, drawn, values)
    if cut.p == 1:
        cut = cut if law.partition else _pieces_along(cut)
    if cut.p == 1 or law.partition:
        return draw(cut, shown, what, by=by, move=number)
    best = best_regions(cut, _grid(cut, points)).reshape(points, points)
    return _dots(cut, best, by, shown) if what == "partition" else _map(cut, best, what, number, shown)


def best_regions(law: ExplicitLaw, points: Array) -> Numbers:
    """The region with the least value at each point, -1 where there is none; of equal values the first region's.

    Parameters
    ----------
    law : ExplicitLaw
        Regions of several sequences one after another, in the order of the sequences.
    points : array of shape (n, p)
    """
    best, least = np.full(len(points), NONE, dtype=np.int64), np.full(len(points), np.inf)
    for region in range(law.count):
        A, b = law.rows(region)
        inside = np.flatnonzero((points @ A.T <= b + law.tolerance).all(axis=1))
        values = values_of(law, region, points[inside])
        known = np.where(np.isfinite(least[inside]), least[inside], 0.0)
        better = (best[inside] == NONE) | (values < known - TIE * np.maximum(1.0, np.abs(known)))
        best[inside[better]] = region
        least[inside[better]] = values[better]
    return best


def _checked(law: HybridLaw, what: str, by: str, move: str | int, points: int) -> int:
    """The number of the input to be shown."""
    check_words(what, by)
    if not (isinstance(points, int) and points >= 2):
        raise ArgumentError(f"points is {points!r}: a number of at least 2 was expected")
    names = [variable.name for variable in law.u]
    if move in names:
        return names.index(str(move))
    if isinstance(move, int) and 0 <= move < len(names):
        return move
    raise ArgumentError(f"move is {move!r}: one of {', '.join(names)}, or its number from 0 on, was expected")


def _chosen(law: HybridLaw, section: Mapping[str, float]) -> tuple[list[Parameter], dict[str, float]]:
    """The parameters on the axes, and the values of all others."""
    if not isinstance(section, Mapping):
        raise ArgumentError(f"section is {section!r}: a mapping of names of parameters to numbers was expected")
    free = {parameter.name: parameter for parameter in law.parameters.free}
    unknown = [name for name in section if name not in free]
    if unknown:
        raise ArgumentError(f"{', '.join(unknown)} is no free parameter of the law: there are {', '.join(free)}")
    drawn = [parameter for parameter in law.parameters.real if parameter.name not in section][:2]
    if not drawn:
        raise ArgumentError("all real parameters are fixed: ask the law for its move there instead")
    rest = [parameter for parameter in free.values() if parameter not in drawn]
    return drawn, {parameter.name: _value(parameter, section) for parameter in rest}


def _value(parameter: Parameter, section: Mapping[str, float]) -> float:
    middle = 0.0 if parameter.is_bool else 0.5 * (parameter.low + parameter.high)
    given = section.get(parameter.name, middle)
    if not isinstance(given, int | float | np.number):
        raise ArgumentError(f"section: {parameter.name} is {given!r}: a number was expected")
    value = float(given)
    if parameter.is_bool and value not in (0.0, 1.0):
        raise ArgumentError(f"{parameter.name} is {value:g}: it is Boolean, 0 or 1 was expected")
    return value


def _cut(law: HybridLaw, values: Mapping[str, float], drawn: list[str]) -> ExplicitLaw:
    """All regions in the section, overlaps included."""
    word = tuple(int(values[parameter.name]) for parameter in law.parameters.boolean)
    laws = [sequence.law for sequence in law.sequences if sequence.word[: len(word)] == word]
    nothing = ArgumentError("the section meets no region: other values were expected")
    if not laws:
        raise nothing
    real: dict[str | int, float] = {p.name: values[p.name] for p in law.parameters.real if p.name not in drawn}
    whole = joined(laws)
    cut = whole.fixed(real) if real else whole
    if not cut.count:
        raise nothing
    return cut


def _labels(law: HybridLaw, drawn: list[Parameter], values: Mapping[str, float]) -> Shown:
    units = {variable.name: variable.unit for variable in (*law.x, *law.u)}
    axes = [f"{p.name} [{units[p.signal]}]" if units.get(p.signal) else p.name for p in drawn]
    moves = tuple(variable.label for variable in law.u)
    title = ", ".join(f"{name} = {value:.4g}" for name, value in values.items())
    return Shown(axes, f"at {title}" if title else "", ", ".join(moves), moves)


def _grid(law: ExplicitLaw, points: int) -> Array:
    low, high = law.domain.bounding_box
    across, upwards = (np.linspace(low[i], high[i], points) for i in range(2))
    return np.stack(np.meshgrid(across, upwards), axis=-1).reshape(-1, 2)


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Neighbouring points with the same best region."""

    region: int
    low: float
    high: float


def _pieces_along(law: ExplicitLaw) -> ExplicitLaw:
    """A law over one parameter without overlaps: an interval for each stretch in which one region is best."""
    (low,), (high,) = law.domain.bounding_box
    stretches = _stretches(law, np.linspace(float(low), float(high), _ALONG))
    regions = [stretch.region for stretch in stretches]
    return replace(
        law,
        A=np.tile([[-1.0], [1.0]], (len(stretches), 1)),
        b=np.array([end for stretch in stretches for end in (-stretch.low, stretch.high)]),
        starts=np.arange(0, 2 * len(stretches) + 1, 2),
        active=tuple(law.active[region] for region in regions),
        **{name: getattr(law, name)[regions] for name in "KkPqr"},
    )


def _stretches(law: ExplicitLaw, along: Array) -> list[_Stretch]:
    best = best_regions(law, along[:, None])
    changes = np.flatnonzero(np.diff(best)) + 1
    middles = 0.5 * (along[changes - 1] + along[changes])
    ends = np.concatenate([along[:1], middles, along[-1:]])
    found = best[np.concatenate([[0], changes])]
    parts = zip(found.tolist(), ends[:-1].tolist(), ends[1:].tolist(), strict=True)
    return [_Stretch(region, start, end) for region, start, end in parts if region != NONE]


def _dots(law: ExplicitLaw, best: Numbers, by: str, shown: Shown) -> Figure:
    from matplotlib.colors import to_rgba

    figure, axes = new_partition(law, shown)
    counts = np.bincount(best[best != NONE], minlength=law.count)
    kinds = kinds_of(law, by)
    rank = ranked(kinds, counts.tolist()) if by == "law" else {kind: kind for kind in kinds}
    colours = [to_rgba(colour_of(rank[kind])) for kind in kinds]
    image = np.array([*colours, (1.0, 1.0, 1.0, 0.0)])[best]  # the last one, which is -1, where there is nothing
    axes.imshow(image, extent=_extent(law), origin="lower", aspect="auto", interpolation="nearest")
    areas = {rank[kind]: float(counts[np.array(kinds) == kind].sum()) for kind in kinds}
    texts = {rank[kinds[region]]: law_text(law, region) for region in reversed(range(law.count))}
    seen = {kind: area for kind, area in areas.items() if area > 0}
    name_kinds(axes, seen if by == "law" else {}, texts, shown.move)
    return figure


def _map(cut: ExplicitLaw, best: Numbers, what: str, move: int, shown: Shown) -> Figure:
    """Moves or values as colours."""
    figure, axes = new_partition(cut, shown)
    grid = _grid(cut, len(best))
    heights = np.full(best.size, np.nan)
    for region in np.unique(best[best != NONE]).tolist():
        held = np.flatnonzero(best.ravel() == region)
        affine = grid[held] @ cut.K[region, move] + cut.k[region, move]
        heights[held] = affine if what == "move" else values_of(cut, region, grid[held])
    image = axes.imshow(heights.reshape(best.shape), extent=_extent(cut), origin="lower", aspect="auto",
                        cmap="cividis", interpolation="nearest")  # fmt: skip
    figure.colorbar(image, ax=axes, label=shown.moves[move] if what == "move" else "value")
    return figure


def _extent(law: ExplicitLaw) -> tuple[float, float, float, float]:
    low, high = law.domain.bounding_box
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])
