"""Syntax tree to scalar syntax tree.

Input: an ast.System with vectors, matrices, loops and modules, and the values that the caller gives. Output: an
ast.System of scalars with the same meaning; an element of ``x`` is named ``x(2)``, what belongs to a module ``t1.x``.
Preserved: the order of declarations and items, and every position.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from hysdel_py.diagnostics.sink import Sink
from hysdel_py.elaboration.declarations import DeclarationElaborator
from hysdel_py.elaboration.items import ItemElaborator
from hysdel_py.elaboration.scope import Scope
from hysdel_py.semantics.symbols import PREDEFINED
from hysdel_py.syntax import ast
from hysdel_py.syntax.ast import SectionKind

__all__ = ["Instance", "elaborate"]


@dataclass(frozen=True, slots=True)
class Instance:
    """A file in its place: the whole, with an empty prefix, or a module of it."""

    prefix: str
    system: ast.System


def elaborate(
    instances: tuple[Instance, ...], given: Mapping[str, object], sink: Sink
) -> tuple[ast.System, dict[str, object]]:
    """Make a model scalar.

    Parameters
    ----------
    instances : tuple of Instance
        The whole first, then its modules, each before its own modules.
    given : mapping
        Values of parameters from the caller.

    Returns
    -------
    system, given
        The scalar system and the values for its parameters.
    """
    before = sink.error_count
    values = dict(given)
    numbers = dict(PREDEFINED)
    numbers.update((name, float(v)) for name, v in values.items() if isinstance(v, int | float))
    shared = Scope("", sink, {}, set(), numbers)
    scopes = {instance.prefix: replace(shared, prefix=instance.prefix, iterators={}) for instance in instances}
    declared: dict[str, tuple[ast.DeclarationSection, ...]] = {}
    for instance in reversed(instances):  # a whole may use the sizes of its modules
        elaborator = DeclarationElaborator(scopes[instance.prefix], values)
        declared[instance.prefix] = elaborator.sections(_as_part(instance))
    # Errors of syntax do not hide those of sound items; sizes that are wrong would.
    sound = sink.error_count == before
    sections = tuple(s for i in instances for s in _item_sections(i, scopes[i.prefix])) if sound else ()
    whole = instances[0].system
    declarations = tuple(section for instance in instances for section in declared[instance.prefix])
    return ast.System(whole.name, declarations, sections, whole.span, dialect=whole.dialect), values


def _as_part(instance: Instance) -> tuple[ast.DeclarationSection, ...]:
    """Sections of declarations; inputs and outputs of a module are auxiliaries of the whole."""
    if not instance.prefix:
        return instance.system.declarations
    connected = (SectionKind.INPUT, SectionKind.OUTPUT)
    return tuple(
        replace(section, kind=SectionKind.AUX) if section.kind in connected else section
        for section in instance.system.declarations
    )


def _item_sections(instance: Instance, scope: Scope) -> Iterator[ast.ItemSection]:
    elaborator = ItemElaborator(scope)
    booleans = {d.name for s in instance.system.declarations for d in s.declarations if d.type == "BOOL"}
    for section in instance.system.sections:
        items = tuple(elaborator.items(section.items))
        if not instance.prefix or section.kind is not SectionKind.OUTPUT:
            yield replace(section, items=items)
            continue
        for item in items:
            base = _base(item)[len(instance.prefix) :]
            kind = SectionKind.LOGIC if base in booleans else SectionKind.LINEAR
            yield replace(section, kind=kind, items=(item,))


def _base(item: ast.Item) -> str:
    """Name of what an item defines, without its indices."""
    assert isinstance(item, ast.Equation)
    assert isinstance(item.target, ast.Name)
    return item.target.name.partition("(")[0]
