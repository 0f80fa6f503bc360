"""Parsing that goes on after a mistake, so that one run finds the mistakes of the whole file.

A token that is not expected is first repaired where one small change lets the parser go on: a missing semicolon or
brace is supposed, a surplus mark skipped, a misspelt keyword read as what it resembles. Where nothing helps, the item
that holds the token is given up and parsing resumes behind its semicolon; the names in it count as lost, and nothing is
said about them later. No token is read twice for good, so the work is linear in the length of the text.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lark import Token
from lark.exceptions import UnexpectedToken

from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax import ast, repairs
from hysdel_py.syntax.automaton import Automaton
from hysdel_py.syntax.braces import ClosedBraces
from hysdel_py.syntax.lexing import BAD, COMMENT_STARTS, END, is_keyword, opens_section, span_of, tokenize
from hysdel_py.syntax.messages import SyntaxReporter
from hysdel_py.syntax.source import Source

if TYPE_CHECKING:
    from lark import Lark

__all__ = ["MAX_SYNTAX_ERRORS", "Recovered", "parse_tokens"]

MAX_SYNTAX_ERRORS = 50
"""After so many syntax errors reading stops."""

_MAX_GIVEN_UP = 1000  # items that are skipped, with or without a report, before reading stops
_CONTAINERS = frozenset({"INTERFACE", "IMPLEMENTATION", "NAME"})  # what stands before a brace that holds sections

_BEFORE_CHOICE = frozenset({"EQUAL", "THEN", "ELSE"})  # what stands before the brace of an IF


@dataclass(frozen=True, slots=True)
class Recovered:
    """What could be read.

    Attributes
    ----------
    system : System or None
        None where the text holds no system, or where reading was given up.
    lost : frozenset of str
        Names in the parts that were skipped: nothing is known about what they are.
    """

    system: ast.System | None
    lost: frozenset[str]


@dataclass(slots=True)
class _Frame:
    """An open brace and the item that is being read inside it.

    `brace` is the index of its token, -1 for the file; `holds_sections` tells STATE or LOGIC from INTERFACE; `first` is
    the index of the item's first token and `depth` the height of the parser's stack below it, -1 between items.
    """

    brace: int
    holds_sections: bool
    first: int = -1
    depth: int = -1


class _GivenUp(Exception):  # noqa: N818 -- internal signal
    """Nothing more can be read."""


def parse_tokens(lark: Lark, source: Source, sink: Sink) -> Recovered:
    """Parse a text; every syntax error is in the sink."""
    tokens, complete = tokenize(lark, source, sink, MAX_SYNTAX_ERRORS)
    if not complete:
        return Recovered(None, frozenset())
    parsing = _Parsing(lark, tokens, source, sink)
    try:
        parsing.run()
    except _GivenUp:
        return Recovered(None, frozenset())
    return Recovered(parsing.result, frozenset(parsing.lost))


class _Parsing:
    """One pass over the tokens."""

    def __init__(self, lark: Lark, tokens: list[Token], source: Source, sink: Sink) -> None:
        self.result: ast.System | None = None
        self.lost: set[str] = set()
        self._tokens = tokens
        self._source = source
        self._sink = sink
        self._state = lark.parse_interactive("").parser_state
        self._automaton = Automaton(self._state, lark)
        self._reporter = SyntaxReporter(source, tokens, self._automaton, sink)
        self._frames = [_Frame(-1, True)]
        self._fresh = False  # whether nothing has been accepted since an item was given up
        self._given_up = 0
        self._brackets = 0  # open ones of the item: a semicolon inside parts rows of a matrix
        self._unbalanced = False  # whether whole sections were skipped, so that the last braces prove nothing
        self._closed = ClosedBraces(tokens, source)

    def run(self) -> None:
        """Feed all tokens."""
        position = 0
        while position < len(self._tokens):
            token = self._tokens[position]
            if self._brackets and token.type == "SEMICOLON":
                self._close_brackets(position)
            if self._feed(token):
                self._note_structure(str(token.type), position)
                position += 1
            else:
                position = self._recover(position)

    def _feed(self, token: Token) -> bool:
        """Give a token to the parser; False if it is not expected."""
        try:
            value = self._state.feed_token(token, token.type == END)
        except UnexpectedToken:
            return False
        if token.type == END:
            self.result = value if isinstance(value, ast.System) else None
        self._fresh = False
        return True

    def _note_structure(self, type_: str, index: int, *, supposed: bool = False) -> None:
        """Keep account of items and braces; a supposed token stands before the one at the index."""
        frame = self._frames[-1]
        starts = frame.depth < 0
        if starts:
            frame.first, frame.depth = index, len(self._state.state_stack) - 1
        self._brackets += (type_ == "LSQB") - (type_ == "RSQB")
        if starts:
            self._brackets = 0
        if type_ == "SEMICOLON" and not self._brackets:
            frame.depth = -1
        elif type_ == "LBRACE" and self._tokens[index - 1].type not in _BEFORE_CHOICE:
            self._frames.append(_Frame(index, self._tokens[index - 1].type in _CONTAINERS))
        elif type_ == "RBRACE" and starts and len(self._frames) > 1:
            self._close(-1 if supposed else index)

    def _close(self, index: int) -> None:
        closed = self._frames.pop()
        self._frames[-1].depth = -1
        self._closed.note(closed.brace, index)

    # ---- after a mistake ----------------------------------------------------------------------------------------

    def _recover(self, position: int) -> int:
        """Report what is wrong unless it is a consequence; the place where to go on."""
        if self._tokens[position].type == BAD:
            return self._skip_characters(position) or self._give_up(position)
        repair = self._repair(position)
        if repair is not None:
            if not self._fresh and not (self._unbalanced and repair.is_brace):
                opening = self._closed.likely_open(position, self._frames[-1].brace)
                self._reporter.repaired(repair, position, opening)
                self._stop_at_limit()
            return self._apply(repair, position)
        if not self._fresh and not (self._unbalanced and len(self._frames) == 1):
            self._reporter.unexpected(position)
            self._stop_at_limit()
        return self._give_up(position)

    def _repair(self, position: int) -> repairs.Repair | None:
        """A repair; right behind an item that was given up only a missing brace is believed, and nothing is said."""
        if self._fresh and self._tokens[position].type != END and not opens_section(self._tokens, position):
            return None
        within = self._frames[-1].depth >= 0
        repair = repairs.find(self._automaton, self._tokens, position, within_item=within, brackets=self._brackets)
        return None if self._fresh and repair is not None and not repair.is_brace else repair

    def _close_brackets(self, position: int) -> None:
        """Suppose what is missing before a semicolon that ends an item but would be taken for one in a matrix."""
        if self._frames[-1].depth < 0:
            return
        repair = repairs.close_brackets(self._automaton, self._tokens, position, self._brackets)
        if repair is not None:
            self._reporter.open_bracket(repair, position)
            self._stop_at_limit()
            self._apply(repair, position)

    def _stop_at_limit(self) -> None:
        if self._reporter.count >= MAX_SYNTAX_ERRORS:
            self._reporter.too_many(MAX_SYNTAX_ERRORS)
            raise _GivenUp

    def _skip_characters(self, position: int) -> int:
        """Where to go on behind foreign characters between items, or behind a foreign comment; 0 if nowhere."""
        token, after = self._tokens[position], position + 1
        if token.startswith(COMMENT_STARTS):
            line = self._source.line_of(span_of(token))
            while self._tokens[after].type != END and self._source.line_of(span_of(self._tokens[after])) == line:
                after += 1
        elif self._frames[-1].depth >= 0 or self._tokens[after].start_pos == token.end_pos:
            return 0
        types = repairs.window(self._tokens, after)
        return after if self._automaton.accepted(types) == len(types) else 0

    def _apply(self, repair: repairs.Repair, position: int) -> int:
        here = self._tokens[position]
        for type_, text in repair.insert:
            end = here.end_pos if repair.skip else here.start_pos
            self._feed(Token(type_, text, start_pos=here.start_pos, end_pos=end))
            self._note_structure(type_, position, supposed=True)
        return position + repair.skip

    def _give_up(self, position: int) -> int:
        """Give up the item that is being read, or the section where none is."""
        self._given_up += 1
        if self._given_up > _MAX_GIVEN_UP:
            self._reporter.too_many(MAX_SYNTAX_ERRORS)
            raise _GivenUp
        if len(self._frames) == 1:
            return self._leave_file()
        frame = self._frames[-1]
        start = frame.first if frame.depth >= 0 else position
        self._truncate(frame)
        resumed = self._end_of_item(position, self._braces(start, position))
        if resumed == position and self._tokens[position].type == END and self._fresh:
            raise _GivenUp
        if resumed == position and self._tokens[position].type == "RBRACE" and not self._automaton.accepted(["RBRACE"]):
            resumed = self._drop_frame(position)
        self._lose(start, resumed)
        self._fresh = True
        return resumed

    def _leave_file(self) -> int:
        """Behind the system nothing matters; before it nothing can be understood."""
        if self._frames[0].first >= 0 and self._automaton.accepted([END]):
            return len(self._tokens) - 1
        raise _GivenUp

    def _truncate(self, frame: _Frame) -> None:
        if frame.depth >= 0:
            del self._state.state_stack[frame.depth :]
            del self._state.value_stack[frame.depth - 1 :]
            frame.depth = -1

    def _drop_frame(self, position: int) -> int:
        """Leave a section that may not be empty but lost all it held."""
        frame = self._frames.pop()
        outer = self._frames[-1]
        self._lose(outer.first if outer.depth >= 0 else frame.brace, position)
        self._truncate(outer)
        return position + 1

    def _lose(self, start: int, end: int) -> None:
        self.lost.update(str(token) for token in self._tokens[start:end] if token.type == "NAME")

    def _braces(self, start: int, end: int) -> int:
        """How many braces are open behind a range of tokens."""
        types = [token.type for token in self._tokens[start:end]]
        return max(0, types.count("LBRACE") - types.count("RBRACE"))

    def _end_of_item(self, position: int, depth: int) -> int:
        """Behind the semicolon of the item at a position, or at what must be outside of it; `depth` braces are open."""
        sections, passed = self._frames[-1].holds_sections, False
        for index in range(position, len(self._tokens)):
            token = self._tokens[index]
            if token.type == END or (index > position and depth == 0 and opens_section(self._tokens, index)):
                return index
            if token.type == "LBRACE":
                depth += 1
                self._unbalanced |= sections
            elif token.type == "RBRACE" and depth == 0:
                if passed or self._closes(index):
                    return index + passed
            elif token.type == "RBRACE":
                depth -= 1
                if depth == 0 and not self._ends_later(index, sections):
                    return index + 1
            elif token.type == "SEMICOLON" and sections:
                # The opening brace of a section is lost, so that the next closing one belongs to it.
                passed |= depth == 0
                self._unbalanced |= passed
            elif token.type == "SEMICOLON" and (depth == 0 or self._item_follows(index)):
                return index + 1
        return len(self._tokens) - 1

    def _closes(self, index: int) -> bool:
        """Whether what stands behind a closing brace may stand there; otherwise the brace is a stray one."""
        return self._tokens[index + 1].type in ("RBRACE", END) or is_keyword(self._tokens[index + 1])

    def _ends_later(self, index: int, sections: bool) -> bool:
        """Whether a closing brace belongs to an item whose semicolon is still to come."""
        return not sections and self._tokens[index + 1].type == "SEMICOLON"

    def _item_follows(self, index: int) -> bool:
        """Whether a definition or an end follows a semicolon, although a brace is open."""
        return [token.type for token in self._tokens[index + 1 : index + 3]] == ["NAME", "EQUAL"]
