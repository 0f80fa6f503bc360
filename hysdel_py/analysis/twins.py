"""Two copies of a Dha side by side under the same inputs, and conditions on how they differ."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from hysdel_py.analysis.monitor import Monitor, Signal, monitor_of_rows
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import (
    AffineEquation,
    AffineRequirement,
    Dha,
    DhaItem,
    Event,
    LogicEquation,
    LogicRequirement,
    Switch,
)
from hysdel_py.systems.formula import Formula
from hysdel_py.systems.signals import Variable

__all__ = ["COPIES", "differ", "equal", "of_copy", "twins"]

COPIES = ("first", "second")
"""Prefixes of the names in the two copies."""

Rename = Callable[[str], str]


def of_copy(copy: str, name: str) -> str:
    """Name of a variable in a copy."""
    return f"{copy}.{name}"


def twins(dha: Dha) -> Dha:
    """Two copies that share the inputs; a run of it is a pair of runs of the model.

    Input form: a Dha. Output form: a Dha with twice the states, outputs, auxiliaries and items. Preserved: ranges,
    origins and the order within each copy.
    """
    items = [_renamed(item, _renaming(copy, dha)) for copy in COPIES for item in dha.items]
    return replace(
        dha, name=f"twins of {dha.name}", x=_both(dha.x), y=_both(dha.y), d=_both(dha.d), z=_both(dha.z),
        items=tuple(items),
    )  # fmt: skip


def _both(variables: Sequence[Variable]) -> tuple[Variable, ...]:
    """The variables of both copies, reals before Booleans."""
    copied = [replace(v, name=of_copy(copy, v.name)) for copy in COPIES for v in variables]
    return tuple(sorted(copied, key=lambda v: v.is_bool))


def _renaming(copy: str, dha: Dha) -> Rename:
    inputs = {v.name for v in dha.u}
    return lambda name: name if name in inputs else of_copy(copy, name)


def _renamed(item: DhaItem, rename: Rename) -> DhaItem:
    match item:
        case Event(name=name, form=form):
            return replace(item, name=rename(name), form=_form(form, rename))
        case Switch(name=name, condition=condition, then=then, otherwise=otherwise):
            literal = replace(condition, name=rename(condition.name))
            return replace(
                item, name=rename(name), condition=literal, then=_form(then, rename), otherwise=_form(otherwise, rename)
            )
        case AffineEquation(name=name, value=form):
            return replace(item, name=rename(name), value=_form(form, rename))
        case LogicEquation(name=name, value=formula):
            return replace(item, name=rename(name), value=_formula(formula, rename))
        case AffineRequirement(value=form):
            return replace(item, value=_form(form, rename))
        case LogicRequirement(value=formula):
            return replace(item, value=_formula(formula, rename))


def _form(form: Affine, rename: Rename) -> Affine:
    return Affine(form.constant, tuple((rename(name), coefficient) for name, coefficient in form.terms))


def _formula(formula: Formula, rename: Rename) -> Formula:
    return Formula(tuple(rename(entry) if isinstance(entry, str) else entry for entry in formula.postfix))


def equal(variables: Sequence[Variable], vector: str, within: Mapping[str, float]) -> Monitor:
    """The condition that both copies have the same values, reals up to a distance each."""
    rows = [row for v in variables for row in _distances(v, within.get(v.name, 0.0), apart=False)]
    return monitor_of_rows("both copies agree", _signals(variables, vector), [rows])


def differ(variables: Sequence[Variable], vector: str, by: Mapping[str, float]) -> Monitor:
    """The condition that some variable differs between the copies, a real one by at least a distance."""
    pieces = [[row] for v in variables for row in _distances(v, by.get(v.name, 0.0), apart=True)]
    return monitor_of_rows("the copies differ", _signals(variables, vector), pieces)


def _distances(variable: Variable, distance: float, *, apart: bool) -> Iterator[Affine]:
    """Both directions of ``|first - second|`` at most, or at least, a distance; half of the way for a Boolean."""
    first, second = (of_copy(copy, variable.name) for copy in COPIES)
    size = 0.5 if variable.is_bool else distance
    for left, right in ((first, second), (second, first)):
        terms = ((right, 1.0), (left, -1.0)) if apart else ((left, 1.0), (right, -1.0))
        yield Affine(size if apart else -size, terms)


def _signals(variables: Sequence[Variable], vector: str) -> dict[str, Signal]:
    copied = [replace(v, name=of_copy(copy, v.name)) for copy in COPIES for v in variables]
    return {v.name: Signal(vector, v) for v in copied}
