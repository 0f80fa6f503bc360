"""Warnings where logic operators meet without parentheses and few readers know which binds tighter."""

from __future__ import annotations

from collections.abc import Iterator

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax import ast
from hysdel_py.syntax.dialect import Dialect
from hysdel_py.syntax.operators import ARROWS, COMPARISONS, Op
from hysdel_py.syntax.structure import expressions_in

__all__ = ["warn_of_mixed_logic"]


def warn_of_mixed_logic(system: ast.System, sink: Sink) -> None:
    """Report where ``|``, in HYSDEL 3 also ``&``, and an arrow meet without parentheses."""
    pending = list(expressions_in(system))
    while pending:
        node = pending.pop()
        pending.extend(ast.children(node))
        fact = _doubt(node, system.dialect) if isinstance(node, ast.Apply) else ""
        if fact:
            marks = "|, & and arrows" if system.dialect is Dialect.HYSDEL_3 else "| and arrows"
            sink.warning(Code.MIXED_LOGIC, fact, node.span, help=f"put parentheses where {marks} meet")


def _doubt(node: ast.Apply, dialect: Dialect) -> str:
    """What a reader may not expect of a node and its operands, empty if nothing."""
    operands = {part.op for part in _bare(node)}
    if node.op is Op.OR and operands & ARROWS:
        return "| binds weaker than the arrows: a | b -> c is a | (b -> c)"
    if dialect is Dialect.HYSDEL_2:
        return ""
    if node.op is Op.AND and operands & ARROWS:
        return "& binds weaker than the arrows in hysdel 3: a & b -> c is a & (b -> c)"
    if node.op in ARROWS and operands & {Op.AND, Op.OR}:
        op = (Op.AND if Op.AND in operands else Op.OR).value
        return (
            f"an arrow parts an item of MUST in hysdel 3: a {op} b -> c is (a {op} b) -> c here, "
            f"and a {op} (b -> c) elsewhere"
        )
    return ""


def _bare(node: ast.Apply) -> Iterator[ast.Apply]:
    """Operands without parentheses; a chain of comparisons counts as one comparison."""
    return (part for part in node.args if isinstance(part, ast.Apply) and not _is_chain(part))


def _is_chain(node: ast.Apply) -> bool:
    """Whether a conjunction was written ``a <= b <= c``: its last two links share an operand."""
    if node.op is not Op.AND:
        return False
    left, right = node.args
    last = left.args[1] if isinstance(left, ast.Apply) and left.op is Op.AND else left
    links = [part for part in (last, right) if isinstance(part, ast.Apply) and part.op in COMPARISONS]
    return len(links) == 2 and links[0].args[1] is links[1].args[0]
