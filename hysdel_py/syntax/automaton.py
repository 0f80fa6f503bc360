"""The tables of the parser, asked what would happen without letting it happen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lark import Lark
    from lark.lexer import TerminalDef
    from lark.parsers.lalr_parser_state import ParserState

__all__ = ["Automaton"]


class Automaton:
    """The parser's stack of states and what could follow on it; values are not touched."""

    def __init__(self, state: ParserState[Any], lark: Lark) -> None:
        self._state = state
        self._table: dict[Any, dict[str, tuple[Any, Any]]] = state.parse_conf.states
        self._end = state.parse_conf.end_state
        self._keywords = frozenset(terminal.name for terminal in lark.terminals if _is_keyword(terminal))

    def accepted(self, types: Sequence[str]) -> int:
        """How many of these tokens the parser would take, one after the other."""
        stack = list(self._state.state_stack)
        for count, type_ in enumerate(types):
            if not self._shift(stack, type_):
                return count
        return len(types)

    def expected(self) -> list[str]:
        """Types of the tokens that the parser would take now, in alphabetical order."""
        candidates = [name for name in self._table[self._state.state_stack[-1]] if name.isupper()]
        return sorted(name for name in candidates if self.accepted([name]))

    def expected_keywords(self) -> list[str]:
        """Keywords among the expected tokens."""
        return [name for name in self.expected() if name in self._keywords]

    def _shift(self, stack: list[Any], type_: str) -> bool:
        """Reduce as the table says until the token is shifted; False if it is not expected."""
        from lark.parsers.lalr_analysis import Shift

        while True:
            entry = self._table[stack[-1]].get(type_)
            if entry is None:
                return False
            action, argument = entry
            if action is Shift:
                stack.append(argument)
                return True
            size = len(argument.expansion)
            if size:
                del stack[-size:]
            stack.append(self._table[stack[-1]][argument.origin.name][1])
            if type_ == "$END" and stack[-1] == self._end:
                return True


def _is_keyword(terminal: TerminalDef) -> bool:
    """Whether a terminal of the grammar is a word that is named as it is spelled, whatever has to follow it."""
    return terminal.pattern.value.split("(?=")[0] == terminal.name
