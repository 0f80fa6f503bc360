"""Generated Booleans of equal definition become one.

Input: a Dha. Output: a Dha without the generated Booleans whose definition another Boolean has already, and which
Boolean stands for each. Preserved: states, inputs, outputs, declared auxiliaries and their values; what is kept keeps
its origin.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

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
from hysdel_py.systems.formula import Formula, Literal

__all__ = ["Shared", "share"]


@dataclass(frozen=True, eq=False, slots=True)
class Shared:
    """Result of :func:`share`.

    Attributes
    ----------
    dha : Dha
    merged : mapping of name to name
        For each Boolean that is gone the one that stands for it.
    """

    dha: Dha
    merged: Mapping[str, str]


def share(dha: Dha) -> Shared:
    """Merge generated Booleans into the first Boolean of equal definition, until no two are equal.

    A threshold equals another if form and epsilon do, a formula another if it reads the same.
    """
    merged: dict[str, str] = {}
    while found := _equal(dha):
        dha = _renamed(dha, found)
        merged = {name: found.get(kept, kept) for name, kept in merged.items()} | found
    return Shared(dha, merged)


def _equal(dha: Dha) -> dict[str, str]:
    generated = {v.name for v in dha.d if v.generated}
    booleans = {v.name for v in dha.d}
    first: dict[object, str] = {}
    merged = {}
    for item in dha.items:
        if isinstance(item, Event | LogicEquation) and item.name in booleans:
            kept = first.setdefault(_meaning(item), item.name)
            if kept != item.name and item.name in generated:
                merged[item.name] = kept
    return merged


def _meaning(item: Event | LogicEquation) -> object:
    if isinstance(item, LogicEquation):
        return item.value
    terms = tuple(sorted((name, c) for name, c in item.form.terms if c))
    return item.form.constant, terms, item.epsilon


def _renamed(dha: Dha, names: Mapping[str, str]) -> Dha:
    items = (item for item in dha.items if getattr(item, "name", "") not in names)
    d = tuple(v for v in dha.d if v.name not in names)
    return replace(dha, d=d, items=tuple(_item(item, names) for item in items))


def _item(item: DhaItem, names: Mapping[str, str]) -> DhaItem:
    match item:
        case Event():
            return replace(item, form=_form(item.form, names))
        case Switch():
            condition = Literal(names.get(item.condition.name, item.condition.name), item.condition.positive)
            return replace(
                item, condition=condition, then=_form(item.then, names), otherwise=_form(item.otherwise, names)
            )
        case AffineEquation() | AffineRequirement():
            return replace(item, value=_form(item.value, names))
        case LogicEquation() | LogicRequirement():
            return replace(item, value=_formula(item.value, names))


def _form(form: Affine, names: Mapping[str, str]) -> Affine:
    if not any(name in names for name, _ in form.terms):
        return form
    return _sum(Affine(0.0, ((names.get(name, name), c),)) for name, c in form.terms) + Affine(form.constant)


def _sum(forms: Iterable[Affine]) -> Affine:
    total = Affine()
    for form in forms:
        total = total + form
    return total


def _formula(formula: Formula, names: Mapping[str, str]) -> Formula:
    return Formula(tuple(names.get(entry, entry) if isinstance(entry, str) else entry for entry in formula.postfix))
