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
    "LT": "<", "GT": ">", "EQ": "==", "COLON": ":",
    "OR": "|", "AND": "&", "NOT": "~", "IFF": "<->", "IMPLIES": "->", "IMPLIED_BY": "<-", "LE": "<=", "GE": ">=",
    "PLUS": "+", "MINUS": "-", "TIMES": "*", "OVER": "/", "CARET": "^", "LBRACE": "{", "RBRACE": "}", "LPAR": "(",
    "RPAR": ")", "LSQB": "[", "RSQB": "]", "SEMICOLON": ";", "COMMA": ",", "EQUAL": "=",
    "QUOTE": "'",
}  # fmt: skip
_START_OF_EXPRESSION = {"NUMBER", "NAME", "FUNCTION", "LPAR", "LSQB", "MINUS", "NOT", "TRUE", "FALSE"}
_BINARY = {
    "OR", "AND", "IFF", "IMPLIES", "IMPLIED_BY", "LE", "GE", "LT", "GT", "EQ", "PLUS", "MINUS", "TIMES", "OVER",
    "CARET", "QUOTE",
}  # fmt: skip
_BEHIND = {"INDEX": "a name", "MODULE": "'{'"}  # what makes these words keywords
_ALSO_NAMES = {"FOR", "INDEX", "MODULE"}  # words that are not worth mentioning where a name is expected


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
            self._unexpected(position, (self._insertion(repair, position),))
        else:
            self._unexpected(position, ((span_of(self._tokens[position]), ""),))

    def open_bracket(self, repair: Repair, position: int) -> None:
        """A semicolon that ends an item in which a bracket is still open."""
        expected = [name for name in self._automaton.expected() if name != "SEMICOLON"]
        self._error(
            Code.UNEXPECTED,
            f"expected {_spoken_list(expected)}, found ';'",
            span_of(self._tokens[position]),
            labels=self._still_open(position, "LSQB", "RSQB"),
            fixes=(self._insertion(repair, position),),
        )

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

    def _insertion(self, repair: Repair, position: int) -> tuple[Span, str]:
        """The supposed tokens as a change of the text."""
        place = span_of(self._tokens[position - 1]).end if position else span_of(self._tokens[position]).start
        return Span(place, place), "".join(text for _, text in repair.insert)

    def _unexpected(self, position: int, fixes: tuple[tuple[Span, str], ...]) -> None:
        token = self._tokens[position]
        span, expected = self._place(token), self._automaton.expected()
        word = str(token)
        if token.type == "NAME" and word in expected and word in _BEHIND:
            # Without what has to follow it the word was read as a name.
            help = (
                f"no comment may stand behind {word}" if self._source.text[span.end :].lstrip().startswith("/") else ""
            )
            self._error(Code.UNEXPECTED, f"expected {_BEHIND[word]} behind {word}", span, help=help)
            return
        found = "the end of the file" if token.type == END else f"'{token:.40}'"
        self._error(
            Code.UNEXPECTED,
            f"expected {_spoken_list(expected)}, found {found}",
            span,
            help=self._advice(position, expected),
            labels=self._still_open(position, "LPAR", "RPAR")
            if "RPAR" in expected and token.type == "SEMICOLON"
            else (),
            fixes=fixes,
        )

    def _place(self, token: Token) -> Span:
        """Of a token; the end of the file is shown at the last character."""
        end = len(self._source.text.rstrip())
        return Span(max(end - 1, 0), end) if token.type == END else span_of(token)

    def _still_open(self, position: int, opening: str, closing: str) -> tuple[Label, ...]:
        """The last parenthesis or bracket before a token that is still open."""
        depth = 0
        for index in range(position - 1, -1, -1):
            token = self._tokens[index]
            depth += (token.type == closing) - (token.type == opening)
            if depth < 0:
                return (Label(span_of(token), "opened here"),)
            if token.type == ("SEMICOLON" if opening == "LPAR" else "LBRACE"):
                break
        return ()

    def _advice(self, position: int, expected: Sequence[str]) -> str:
        """Advice for a token."""
        token = self._tokens[position]
        if "NAME" in expected and (is_keyword(token) or token.type == "FUNCTION"):
            return f"{token} is a word of the language and cannot be a name here"
        if token == "QUERIES":
            return "queries are an extension: write /* extension: queries */ in front of SYSTEM"
        if token == "+" and "NUMBER" in expected:
            return "there is no unary plus"
        if token == "=":
            if position > 2 and self._tokens[position - 3].upper() == "FOR":
                return "keywords are written in capitals: FOR"
            return "equal is written ==, at most <= and at least >=" if _BINARY & set(expected) else ""
        return "every item ends with a semicolon" if "SEMICOLON" in expected and "RSQB" not in expected else ""

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
    if "NAME" in rest:
        rest -= _ALSO_NAMES
    if rest >= {"NUMBER", "NAME", "LPAR"}:
        words.append("an expression")
        rest -= _START_OF_EXPRESSION
    if len(rest & _BINARY) >= 3:
        words.append("an operator")
        rest -= _BINARY
    words += [_SPOKEN.get(name) or f"'{_OPERATORS.get(name, name)}'" for name in sorted(rest)]
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " or " + words[-1]


def _comment_left_open(source: Source) -> bool:
    if not source.comments:
        return False
    last = source.comments[-1]
    return last.end == len(source.text) and not source.text[last.start + 2 :].endswith("*/")
