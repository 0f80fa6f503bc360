"""Notes about a typed model that is correct: what nothing needs."""

from __future__ import annotations

import re
from collections import Counter

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.semantics.expressions import leaves
from hysdel_py.semantics.symbols import BIG_M_BOUND, EPSILON, Symbol
from hysdel_py.semantics.typed_model import Choice, Item, Threshold, Triple, TypedModel
from hysdel_py.syntax.source import Span

__all__ = ["note_unused_parameters", "read_by"]

_WORD = re.compile(r"[A-Za-z_]\w*")
_READ_BY_TOOLS = frozenset({"ts", "Ts", "T_s", EPSILON, BIG_M_BOUND})  # these are read by their name

_ONLY_IN_THE_WHOLE = (f".{EPSILON}", f".{BIG_M_BOUND}")


def note_unused_parameters(model: TypedModel, sink: Sink) -> None:
    """Say which declared parameters nothing reads; libraries of parameters are common, so it is only a note."""
    used = {leaf.name for item in model.items for leaf in read_by(item)}
    used |= {leaf.name for query in model.queries for part in query.expressions() for leaf in leaves(part)}
    for symbol in model.symbols:
        for expression in (*(symbol.bounds or ()), *((symbol.value,) if symbol.value else ())):
            used |= {leaf.name for leaf in leaves(expression)}
    words = Counter(_WORD.findall(model.source.excerpt(Span(0, len(model.source.text)))))
    for symbol in model.parameters:
        # Sizes, indices and loops are gone from the typed model; a second mention in the text is taken for a use.
        mentioned = words[symbol.name.rpartition(".")[2].partition("(")[0]] > 1
        if symbol.line and symbol.name.endswith(_ONLY_IN_THE_WHOLE):
            own = symbol.name.rpartition(".")[2]
            sink.warning(
                Code.UNUSED_PARAMETER,
                f"{symbol.name} has no effect: {own} of the whole counts for its modules too",
                symbol.span,
                help=f"declare {own} in the whole, or give the thresholds of the module a [min, max, epsilon]",
            )
        elif symbol.line and not mentioned and symbol.name not in used | _READ_BY_TOOLS:
            sink.note(Code.UNUSED_PARAMETER, f"the parameter {symbol.name} is never used", symbol.span)


def read_by(item: Item) -> list[Symbol]:
    """Variables and parameters that an item reads, repeats included, also in its triples."""
    triples = [triple for triple in _triples(item) if triple is not None]
    limits = [part for triple in triples for part in (triple.low, triple.high, triple.epsilon)]
    return [leaf for expression in (*item.expressions(), *limits) for leaf in leaves(expression)]


def _triples(item: Item) -> tuple[Triple | None, ...]:
    match item.body:
        case Threshold(triple=triple):
            return (triple,)
        case Choice(then=then, otherwise=otherwise):
            return then.triple, otherwise.triple if otherwise is not None else None
        case _:
            return ()
