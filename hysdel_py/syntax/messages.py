"""What is said about syntax errors."""

from __future__ import annotations

from collections.abc import Sequence

from lark import Token

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.automaton import Automaton
from hysdel_py.syntax.lexing import END, is_keyword, span_of, too_many
from hysdel_py.syntax.repairs import Repair
from hysdel_py.syntax.source import Source, Span

__all__ = ["SyntaxReporter"]

# How a reader calls the terminals of the grammar; the others are shown as they are spelled.
_SPOKEN = {
    "NAME": "a name",
    "NUMBER": "a number",
    "FUNCTION": "a function (sin, cos, exp, log, sqrt)",
    "$END": "the end of the file",
}
_OPERATORS = {
    "OR": "|", "AND": "&", "NOT": "~", "IFF": "<->", "IMPLIES": "->", "IMPLIED_BY": "<-", "LE": "<=", "GE": ">=",
    "PLUS": "+", "MINUS": "-", "TIMES": "*", "OVER": "/", "CARET": "^", "LBRACE": "{", "RBRACE": "}", "LPAR": "(",
    "RPAR": ")", "LSQB": "[", "RSQB": "]", "SEMICOLON": ";", "COMMA": ",", "EQUAL": "=",
}  # fmt: skip
_START_OF_EXPRESSION = {"NUMBER", "NAME", "FUNCTION", "LPAR", "MINUS", "NOT", "TRUE", "FALSE"}
_BINARY = {"OR", "AND", "IFF", "IMPLIES", "IMPLIED_BY", "LE", "GE", "PLUS", "MINUS", "TIMES", "OVER", "CARET"}


class SyntaxReporter:
    """Puts syntax errors into words and counts them."""

    def __init__(self, source: Source, tokens: list[Token], automaton: Automaton, sink: Sink) -> None:
        self.count = 0
        self._source = source
        self._tokens = tokens
        self._automaton = automaton
        self._sink = sink

    def unexpected(self, position: int) -> None:
        """A token for which there is no repair."""
        if self._reports_open_comment(position):
            return
        self._unexpected(position, ())

    def repaired(self, repair: Repair, position: int, opening: int) -> None:
        """A token and the change that lets parsing go on; `opening` is the index of the brace around it."""
        if self._reports_open_comment(position):
            return
        if repair.is_keyword:
            self._misspelt(repair.insert[0][1], position)
        elif repair.is_brace:
            self._unclosed(opening, position, len(repair.insert))
        elif repair.insert and repair.insert[0][0] == "SEMICOLON":
            self._missing_semicolon(position)
        elif repair.insert:
            place = span_of(self._tokens[position]).start if not position else span_of(self._tokens[position - 1]).end
            self._unexpected(position, ((Span(place, place), repair.insert[0][1]),))
        else:
            self._unexpected(position, ((span_of(self._tokens[position]), ""),))

    def too_many(self, limit: int) -> None:
        """The last message of a file that has too many errors."""
        too_many(self._source, self._sink, limit)

    def _misspelt(self, keyword: str, position: int) -> None:
        token, span = self._tokens[position], span_of(self._tokens[position])
        fault = (
            f"keywords are written in capitals: {keyword}, not {token}"
            if token.upper() == keyword
            else f"expected {keyword}, found '{token}'"
        )
        self._error(Code.MISSPELT_KEYWORD, fault, span, help=f"did you mean {keyword}?", fixes=((span, keyword),))

    def _missing_semicolon(self, position: int) -> None:
        before = span_of(self._tokens[position - 1])
        self._error(
            Code.MISSING_SEMICOLON,
            "expected ';' after this",
            before,
            help="every item ends with a semicolon",
            fixes=((Span(before.end, before.end), ";"),),
        )

    def _unclosed(self, opening: int, position: int, count: int) -> None:
        token, span = self._tokens[position], span_of(self._tokens[opening])
        more = f"; {count - 1} more around it are open too" if count > 1 else ""
        if token.type == END:
            self._error(Code.UNCLOSED, f"this brace is never closed{more}", span, help="a '}' is missing")
        else:
            labels = (Label(span_of(token), "a '}' is missing before this"),)
            self._error(Code.UNCLOSED, f"this brace is not closed{more}", span, labels=labels)

    def _reports_open_comment(self, position: int) -> bool:
        """At the end of the file an open comment is the mistake, whatever is expected."""
        if self._tokens[position].type != END or not _comment_left_open(self._source):
            return False
        start = self._source.comments[-1].start
        self._error(Code.UNCLOSED, "this comment is never closed: */ is missing", Span(start, start + 2))
        return True

    def _unexpected(self, position: int, fixes: tuple[tuple[Span, str], ...]) -> None:
        token = self._tokens[position]
        span, expected = self._place(token), self._automaton.expected()
        found = "the end of the file" if token.type == END else f"'{token:.40}'"
        self._error(
            Code.UNEXPECTED,
            f"expected {_spoken_list(expected)}, found {found}",
            span,
            help=_advice(token, expected, self._source.text[span.start : span.start + 2]),
            labels=self._open_parenthesis(position) if "RPAR" in expected and token.type == "SEMICOLON" else (),
            fixes=fixes,
        )

    def _place(self, token: Token) -> Span:
        """Of a token; the end of the file is shown at the last character."""
        end = len(self._source.text.rstrip())
        return Span(max(end - 1, 0), end) if token.type == END else span_of(token)

    def _open_parenthesis(self, position: int) -> tuple[Label, ...]:
        """The last parenthesis before a token that is still open."""
        depth = 0
        for token in reversed(self._tokens[:position]):
            depth += (token.type == "RPAR") - (token.type == "LPAR")
            if depth < 0:
                return (Label(span_of(token), "opened here"),)
            if token.type == "SEMICOLON":
                break
        return ()

    def _error(
        self,
        code: Code,
        message: str,
        span: Span,
        *,
        help: str = "",
        labels: tuple[Label, ...] = (),
        fixes: tuple[tuple[Span, str], ...] = (),
    ) -> None:
        self.count += 1
        self._sink.error(code, message, span, help=help, labels=labels, fixes=fixes)


def _spoken_list(terminals: Sequence[str]) -> str:
    """Terminals in words, with those that start or continue an expression folded into one word."""
    rest = set(terminals)
    words = []
    if rest >= {"NUMBER", "NAME", "LPAR"}:
        words.append("an expression")
        rest -= _START_OF_EXPRESSION
    if len(rest & _BINARY) >= 3:
        words.append("an operator")
        rest -= _BINARY
    words += [_SPOKEN.get(name) or f"'{_OPERATORS.get(name, name)}'" for name in sorted(rest)]
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " or " + words[-1]


def _advice(token: Token, expected: Sequence[str], pair: str) -> str:  # noqa: PLR0911 -- a table of cases
    """Advice for a token; `pair` is it and the character behind it."""
    if "NAME" in expected and (is_keyword(token) or token.type == "FUNCTION"):
        return f"{token} is a word of the language and cannot be a name here"
    if pair == "==":
        return "there is no comparison by ==; use two conditions, one with <= and one with >="
    if token == "+" and "NUMBER" in expected:
        return "there is no unary plus"
    if token == "AUX":
        return "there is one AUX section and it comes first in IMPLEMENTATION"
    if token in ("<=", ">="):
        return "comparisons belong into AD (as name = left <= right) or stand alone in MUST; they cannot be chained"
    if token == "(" and "LSQB" in expected:
        return "variables are scalars: there are no vectors and no matrices"
    return "every item ends with a semicolon" if "SEMICOLON" in expected else ""


def _comment_left_open(source: Source) -> bool:
    if not source.comments:
        return False
    last = source.comments[-1]
    return last.end == len(source.text) and not source.text[last.start + 2 :].endswith("*/")
