"""Mistakes in sound items of a model that has others.

The stages of the compiler need what the stages before them make, so a mistake that an early one finds would hide those
of the later ones. Here the items that nothing is wrong with are lowered all the same, only for what is said about them.
An item that reads something whose declaration or definition is wrong is left out, since what would be said about it
might be a consequence.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Iterable, Mapping
from dataclasses import replace

from hysdel_py.diagnostics.diagnostic import Diagnostic, Severity
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.big_m import Ranges
from hysdel_py.lowering.constants import Constants
from hysdel_py.lowering.dha import to_dha
from hysdel_py.lowering.rows import item_rows
from hysdel_py.semantics.expressions import leaves
from hysdel_py.semantics.lints import read_by
from hysdel_py.semantics.symbols import BIG_M_BOUND, EPSILON, PREDEFINED, Role, Symbol
from hysdel_py.semantics.typed_model import Item, TypedModel
from hysdel_py.syntax.source import Span

__all__ = ["LONGEST", "report_on_sound_items"]

LONGEST = 100_000
"""Longer texts are not looked at again once they have a mistake."""

_OF_VALUE = (Role.AUX, Role.STATE)  # what has a range by its definition


def report_on_sound_items(
    model: TypedModel, values: Mapping[str, float], sink: Sink, without_range: frozenset[str] = frozenset()
) -> None:
    """Add the errors that lowering finds in items which no error is about so far.

    Parameters
    ----------
    values : mapping
        Values of parameters as far as they are known.
    without_range : frozenset of str
        Names whose declared range could not be understood.
    """
    if len(model.source.text) > LONGEST:
        return
    numbers = _with_gap_and_bound(model, values)
    first, second = Sink(), Sink()
    sound = _sound(model, numbers, sink.diagnostics, without_range)
    to_dha(sound, numbers, Constants.AFFINE, first)
    sounder = _sound(sound, numbers, (*sink.diagnostics, *first.diagnostics), without_range)
    dha = to_dha(sounder, numbers, Constants.AFFINE, Sink())
    ranges = Ranges(dha, second, {symbol.name: symbol.span for symbol in model.symbols if symbol.line})
    for item in dha.items:
        for _ in item_rows(item, ranges, second):
            pass
    sink.include(d for d in (*first.diagnostics, *second.diagnostics) if d.severity is Severity.ERROR)


def _with_gap_and_bound(model: TypedModel, values: Mapping[str, float]) -> dict[str, float]:
    """The values with some for what is read by its name; which ones does not matter where there is an error anyway."""
    numbers = dict(values)
    if not 0 < numbers.get(EPSILON, 0.0) < math.inf:
        numbers[EPSILON] = PREDEFINED[EPSILON]
    if any(s.name == BIG_M_BOUND for s in model.parameters) and not 0 < numbers.get(BIG_M_BOUND, 0.0) < math.inf:
        numbers[BIG_M_BOUND] = 1.0
    return numbers


def _sound(
    model: TypedModel, values: Mapping[str, float], found: Iterable[Diagnostic], without_range: frozenset[str]
) -> TypedModel:
    """The model with its sound items only, and without ranges that cannot be computed."""
    places = sorted(d.span.start for d in found if d.severity is Severity.ERROR and d.span is not None)
    wrong = {s.name for s in model.symbols if s.line and _holds_any(s.span, places)} | without_range
    wrong |= {s.name for s in model.parameters if s.name not in values}
    wrong |= {s.name for s in model.symbols if any(leaf.name in wrong for leaf in _of_range(s))}
    items = [item for item in model.items if not _holds_any(item.span, places)]
    symbols = tuple(replace(s, bounds=None) if s.name in wrong else s for s in model.symbols)
    return replace(model, symbols=symbols, items=_without_readers(items, symbols, wrong))


def _holds_any(span: Span, places: list[int]) -> bool:
    """Whether one of the sorted places lies in a span."""
    index = bisect_left(places, span.start)
    return index < len(places) and places[index] < span.end


def _of_range(symbol: Symbol) -> list[Symbol]:
    return [leaf for bound in symbol.bounds or () for leaf in leaves(bound)]


def _without_readers(items: list[Item], symbols: tuple[Symbol, ...], wrong: set[str]) -> tuple[Item, ...]:
    """Items that read nothing wrong, and nothing that only an item which was left out would define."""
    ranged_by_definition = {s.name for s in symbols if s.role in _OF_VALUE and s.is_real and s.bounds is None}
    reads = [{symbol.name for symbol in read_by(item)} for item in items]
    kept = list(range(len(items)))
    while True:
        defined = {target.name for k in kept if (target := items[k].target) is not None}
        unknown = wrong | (ranged_by_definition - defined)
        left = [k for k in kept if not reads[k] & unknown]
        if len(left) == len(kept):
            return tuple(items[k] for k in kept)
        kept = left
