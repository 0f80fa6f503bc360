"""In which order the definitions of a Dha are explored for its modes.

Input: a Dha. Output: steps such that each finds known what it reads. What costs nothing comes first (affine equations,
switches, logic), then requirements, which prune, then thresholds, which cut the cell; values are given to Boolean
states and inputs as late as possible, since each doubles the number of cells without making them smaller.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import (
    AffineEquation,
    AffineRequirement,
    Definition,
    Dha,
    DhaItem,
    Event,
    LogicEquation,
    LogicRequirement,
    Switch,
)

__all__ = ["Choose", "Loop", "Step", "decisive_booleans", "plan"]

_OF_NEXT_VALUES = frozenset({"Continuous", "Automata", "Cont_output", "Logic_output"})


@dataclass(frozen=True, slots=True)
class Choose:
    """Give a value to a Boolean state or input."""

    name: str


@dataclass(frozen=True, slots=True)
class Loop:
    """Settle definitions that depend on each other."""

    members: tuple[Definition, ...]


Step = Choose | Loop | Definition | AffineRequirement | LogicRequirement


def forms(item: DhaItem) -> tuple[Affine, ...]:
    """Affine forms of an item."""
    match item:
        case Event(form=form):
            return (form,)
        case Switch(then=then, otherwise=otherwise):
            return (then, otherwise)
        case AffineEquation(value=value) | AffineRequirement(value=value):
            return (value,)
        case _:
            return ()


def read_truths(item: DhaItem) -> tuple[str, ...]:
    """Booleans whose truth an item needs, beyond their values as numbers."""
    match item:
        case Switch(condition=condition):
            return (condition.name,)
        case LogicEquation(item=kind, value=formula) if kind in _OF_NEXT_VALUES and formula.literal is not None:
            return ()  # the next value is the variable, or one minus it
        case LogicEquation(value=formula) | LogicRequirement(value=formula):
            return formula.names
        case _:
            return ()


def read_numbers(item: DhaItem) -> tuple[str, ...]:
    """Variables that appear in the affine forms of an item."""
    return tuple(name for form in forms(item) for name, coefficient in form.terms if coefficient)


def decisive_booleans(dha: Dha) -> tuple[str, ...]:
    """Boolean states and inputs on which a region depends, in the order of the vectors."""
    found: set[str] = set()
    for item in dha.items:
        found.update(read_truths(item))
        if isinstance(item, Event | AffineRequirement):
            found.update(_behind(item, dha))
    return tuple(v.name for v in (*dha.x, *dha.u) if v.is_bool and v.name in found)


def _behind(item: DhaItem, dha: Dha) -> set[str]:
    """All variables that the number of an item depends on, through real auxiliaries."""
    reals = {v.name for v in dha.z}
    seen: set[str] = set()
    pending = list(read_numbers(item))
    while pending:
        name = pending.pop()
        if name not in seen:
            seen.add(name)
            if name in reals and name in dha.definitions:
                pending += read_numbers(dha.definitions[name])
    return seen


def plan(dha: Dha, chosen: tuple[str, ...]) -> tuple[Step, ...]:
    """Steps that end with all auxiliaries known, all requirements met and all `chosen` Booleans given.

    Parameters
    ----------
    chosen : tuple of str
        Boolean states and inputs that are to have a value in each mode.
    """
    auxiliaries = {v.name for v in (*dha.d, *dha.z)}
    known = {v.name for v in (*dha.x, *dha.u) if v.name not in chosen}
    known |= {name for name in auxiliaries if name not in dha.definitions}
    pending: list[Step] = [*_definitions(dha), *dha.requirements, *(Choose(name) for name in chosen)]
    steps = []
    while pending:
        ready = [step for step in pending if known.issuperset(needs(step))]
        step = min(ready, key=_cost)
        pending.remove(step)
        steps.append(step)
        known.update(_defines(step))
    return tuple(steps)


def _cost(step: Step) -> int:
    match step:
        case Switch() | AffineEquation() | LogicEquation():
            return 0
        case LogicRequirement():
            return 1
        case AffineRequirement():
            return 2
        case Event():
            return 3
        case Loop():
            return 4
        case Choose():
            return 5


def needs(step: Step) -> set[str]:
    """Names that have to be known before a step."""
    match step:
        case Choose():
            return set()
        case Loop(members=members):
            own = {member.name for member in members}
            return {name for member in members for name in needs(member)} - own
        case _:
            return {*read_truths(step), *read_numbers(step)}


def _defines(step: Step) -> tuple[str, ...]:
    match step:
        case Loop(members=members):
            return tuple(member.name for member in members)
        case AffineRequirement() | LogicRequirement():
            return ()
        case _:
            return (step.name,)


def _definitions(dha: Dha) -> Iterator[Definition | Loop]:
    """Definitions of the auxiliaries in file order; those of a circle together."""
    own = [v.name for v in (*dha.d, *dha.z) if v.name in dha.definitions]
    if not dha.algebraic_loop:
        order = {name: position for position, name in enumerate(dha.definitions)}
        yield from (dha.definitions[name] for name in sorted(own, key=order.__getitem__))
        return
    import networkx as nx

    graph = nx.DiGraph()
    graph.add_nodes_from(own)
    graph.add_edges_from((n, name) for name in own for n in needs(dha.definitions[name]) if n in set(own))
    for component in sorted(nx.strongly_connected_components(graph), key=lambda c: min(map(own.index, c))):
        members = tuple(dha.definitions[name] for name in own if name in component)
        circular = len(members) > 1 or graph.has_edge(members[0].name, members[0].name)
        yield Loop(members) if circular else members[0]
