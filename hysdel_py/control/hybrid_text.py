"""Explicit hybrid laws as text."""

from __future__ import annotations

from collections.abc import Iterator

from hysdel_py.control.explicit_parameters import Parameter
from hysdel_py.control.explicit_text import region_text
from hysdel_py.control.hybrid_law import HybridLaw

__all__ = ["describe_hybrid", "describe_sequence"]


def describe_hybrid(law: HybridLaw, regions: bool) -> str:
    """Sizes, parameters and sequences; rows and moves of each region where they are asked for."""
    return "\n".join([*_head(law), *_sequences(law, regions)]) + "\n"


def describe_sequence(law: HybridLaw, number: int) -> str:
    """The switches of a sequence that are on, by name."""
    word = law.sequences[number].word
    on = [name for name, bit in zip(law.switches, word, strict=True) if bit]
    return ", ".join(on) or "all switches off"


def _head(law: HybridLaw) -> Iterator[str]:
    r = law.report
    yield (
        f"explicit hybrid law: norm {law.norm}, horizon {law.horizon}, {len(law.sequences)} sequences, {law.count} "
        f"regions{' without overlaps' if law.partition else ', the least value decides where they overlap'}"
    )
    yield "complete" if law.complete else f"incomplete ({r.stop}): other plans may cost less or hold other points"
    yield (
        f"search: {r.tried} sequences looked at, {r.propagated} given up by propagation, {r.infeasible} by their rows, "
        f"{r.flat} flat, {r.solved} solved, {r.found} regions found"
    )
    yield from (f"  {_parameter(parameter)}" for parameter in law.parameters.every)


def _parameter(parameter: Parameter) -> str:
    if parameter.is_fixed:
        return f"{parameter.name} = {parameter.value:g} (fixed)"
    return f"{parameter.name} in {{0, 1}}" if parameter.is_bool else (
        f"{parameter.name} in [{parameter.low:g}, {parameter.high:g}]"
    )  # fmt: skip


def _sequences(law: HybridLaw, regions: bool) -> Iterator[str]:
    for number, sequence in enumerate(law.sequences):
        yield f"sequence {number}, {sequence.law.count} regions: {describe_sequence(law, number)}"
        if regions:
            for region in range(sequence.law.count):
                yield from (f"  {line}" for line in region_text(sequence.law, region))
