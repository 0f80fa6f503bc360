"""What the writers of simulators share: refusals, and logic as flat statements."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.semantics.symbols import Role
from hysdel_py.semantics.typed_model import TypedModel
from hysdel_py.syntax.source import Span
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.formula import Connective, Formula

__all__ = ["LogicWriter", "refuse_loop", "refuse_undefined"]

_LONGEST = 100


def refuse_loop(dha: Dha, sink: Sink) -> None:
    """Report an algebraic loop: no order of statements evaluates it."""
    loop = dha.algebraic_loop
    if loop:
        origin = dha.definitions[loop[0]].origin
        sink.error(
            Code.ALGEBRAIC_LOOP,
            f"no simulator can be written: algebraic loop {' -> '.join(loop)}",
            Span(origin.start, origin.end),
            help="break the loop by a state",
        )


def refuse_undefined(model: TypedModel, dha: Dha, sink: Sink, *, only_used: bool) -> None:
    """Report names that nothing defines: all of them, or only auxiliaries that something reads."""
    for symbol in model.symbols:
        missing = symbol.role in (Role.STATE, Role.OUTPUT, Role.AUX) and symbol.name not in dha.definitions
        if missing and (not only_used or symbol.name in dha.undefined_but_used):
            message = f"no simulator can be written: the {symbol.spoken} {symbol.name} is never defined"
            sink.error(Code.NEVER_DEFINED, message, symbol.span)


@dataclass(frozen=True, slots=True)
class LogicWriter:
    """Spells formulas in a programming language.

    Attributes
    ----------
    true, false : str
    negated, equal, both, either : str
        Patterns with {0} and {1} for the operands, each in parentheses.
    variable : callable
        Text of a Boolean variable as a condition.
    temporary : str
        Pattern of an assignment to a temporary name, with {0} for the name and {1} for the value.
    """

    true: str
    false: str
    negated: str
    both: str
    either: str
    equal: str
    variable: Callable[[str], str]
    temporary: str

    def write(self, formula: Formula, fresh: Iterator[str]) -> tuple[list[str], str]:
        """Statements and the condition that stands for the formula after them; long parts get names of their own."""
        lines: list[str] = []
        stack: list[str] = []
        for entry in formula.postfix:
            text = self._entry(entry, stack)
            if len(text) > _LONGEST:
                name = next(fresh)
                lines.append(self.temporary.format(name, text))
                text = name
            stack.append(text)
        return lines, stack[0]

    def _entry(self, entry: str | bool | Connective, stack: list[str]) -> str:
        if isinstance(entry, bool):
            return self.true if entry else self.false
        if isinstance(entry, str):
            return self.variable(entry)
        if entry is Connective.NOT:
            return self.negated.format(stack.pop())
        right, left = stack.pop(), stack.pop()
        if entry is Connective.IMPLIES:
            left = self.negated.format(left)
        elif entry is Connective.IMPLIED_BY:
            right = self.negated.format(right)
        patterns = {Connective.AND: self.both, Connective.IFF: self.equal}
        return patterns.get(entry, self.either).format(left, right)
