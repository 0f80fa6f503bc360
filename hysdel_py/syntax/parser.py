"""Text to syntax tree."""

from __future__ import annotations

from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax import ast
from hysdel_py.syntax.source import Source, Span

if TYPE_CHECKING:
    from lark import Lark
    from lark.exceptions import UnexpectedInput

__all__ = ["grammar_text", "parse"]

# How a reader calls the terminals of the grammar; the others are shown as they are spelled.
_SPOKEN = {
    "NAME": "a name",
    "FOR": "'FOR'",
    "INDEX": "'INDEX'",
    "MODULE": "'MODULE'",
    "NUMBER": "a number",
    "FUNCTION": "a function (sin, cos, exp, log, sqrt)",
    "$END": "the end of the file",
}
_HINTS = {
    "#": "comments are written /* like this */ or // like this",
    "%": "comments are written /* like this */ or // like this",
    ".": "a dot stands between the names of a module and of what it holds, without blanks",
    "_": "names start with a letter",
}


def grammar_text() -> str:
    """The grammar: inside an installed package, beside the package in a checkout."""
    installed = resources.files("hysdel_py") / "grammar" / "hysdel.lark"
    if installed.is_file():
        return installed.read_text(encoding="utf-8")
    return (Path(__file__).parents[2] / "grammar" / "hysdel.lark").read_text(encoding="utf-8")


@cache
def _lark() -> Lark:
    from lark import Lark

    from hysdel_py.syntax.tree_to_ast import TreeToAst

    return Lark(
        grammar_text(),
        start="file",
        parser="lalr",
        lexer="basic",
        keep_all_tokens=True,
        maybe_placeholders=False,
        transformer=TreeToAst(),
    )


def parse(source: Source, sink: Sink) -> ast.System | None:
    """Parse a source text.

    Returns
    -------
    System or None
        None after an error, which is in the sink. A text without a system gives an empty system and a warning, as
        the original compiler accepts it.
    """
    from lark.exceptions import UnexpectedInput

    try:
        tree = _lark().parse(source.text)
    except UnexpectedInput as error:
        _report(error, source, sink)
        return None
    system = tree if isinstance(tree, ast.System) else None
    if system is None:
        sink.warning(Code.EMPTY, f"{source.name} holds no SYSTEM: the model is empty")
        return ast.System("", (), (), Span(0, len(source.text)))
    return system


def _report(error: UnexpectedInput, source: Source, sink: Sink) -> None:
    from lark.exceptions import UnexpectedCharacters, UnexpectedToken

    if isinstance(error, UnexpectedCharacters):
        offset = error.pos_in_stream or 0
        character = source.text[offset]
        shown = character if character.isprintable() else f"U+{ord(character):04X}"
        sink.error(
            Code.BAD_CHARACTER,
            f"the character '{shown}' does not belong to the language",
            Span(offset, offset + 1),
            help=_HINTS.get(character, ""),
        )
    elif isinstance(error, UnexpectedToken):
        token = error.token
        at_end = token.type == "$END"
        end = len(source.text.rstrip())
        span = Span(max(end - 1, 0), end) if at_end else Span(token.start_pos or 0, token.end_pos or 0)
        found = "the end of the file" if at_end else f"'{token}'"
        expected = sorted(error.accepts or error.expected)
        sink.error(
            Code.UNEXPECTED,
            f"expected {_spoken_list(expected)}, found {found}",
            span,
            help=_advice(str(token), expected, source, span),
        )


_OPERATORS = {
    "LT": "<", "GT": ">", "EQ": "==",
    "OR": "|", "AND": "&", "NOT": "~", "IFF": "<->", "IMPLIES": "->", "IMPLIED_BY": "<-", "LE": "<=", "GE": ">=",
    "PLUS": "+", "MINUS": "-", "TIMES": "*", "OVER": "/", "CARET": "^", "LBRACE": "{", "RBRACE": "}", "LPAR": "(",
    "RPAR": ")", "LSQB": "[", "RSQB": "]", "SEMICOLON": ";", "COMMA": ",", "EQUAL": "=",
    "COLON": ":",
}  # fmt: skip
_START_OF_EXPRESSION = {"NUMBER", "NAME", "FUNCTION", "LPAR", "LSQB", "MINUS", "NOT", "TRUE", "FALSE"}
_BINARY = {"OR", "AND", "IFF", "IMPLIES", "IMPLIED_BY", "LE", "GE", "LT", "GT", "EQ", "PLUS", "MINUS", "TIMES",
    "OVER", "CARET",
}  # fmt: skip


def _spoken_list(terminals: list[str]) -> str:
    """Terminals in words, with those that start or continue an expression folded into one word."""
    rest = set(terminals)
    if "NAME" in rest:
        rest -= {"FOR", "INDEX", "MODULE"}  # words only in places where a name can stand as well
    words = []
    if rest >= {"NUMBER", "NAME", "LPAR"}:
        words.append("an expression")
        rest -= _START_OF_EXPRESSION
    if len(rest & _BINARY) >= 3:
        words.append("an operator")
        rest -= _BINARY
    words += [_SPOKEN.get(name) or f"'{_OPERATORS.get(name, name)}'" for name in sorted(rest)]
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " or " + words[-1]


_KEYWORDS = {
    "SYSTEM", "INTERFACE", "IMPLEMENTATION", "STATE", "INPUT", "OUTPUT", "PARAMETER", "AUX", "AD", "DA", "LOGIC",
    "LINEAR", "CONTINUOUS", "AUTOMATA", "MUST", "IF", "THEN", "ELSE", "REAL", "BOOL", "TRUE", "FALSE",
}  # fmt: skip


def _advice(token: str, expected: list[str], source: Source, span: Span) -> str:
    if "NAME" in expected and (token in _KEYWORDS or token in {"sin", "cos", "exp", "log", "sqrt"}):
        return f"{token} is a word of the language and cannot be a name here"
    if token == "+" and "NUMBER" in expected:
        return "there is no unary plus"
    if span.end == len(source.text.rstrip()) and _comment_left_open(source):
        return "the last comment is not closed: */ is missing"
    if "SEMICOLON" in expected:
        return "every item ends with a semicolon"
    return ""


def _comment_left_open(source: Source) -> bool:
    if not source.comments:
        return False
    last = source.comments[-1]
    return last.end == len(source.text) and not source.text[last.start + 2 :].endswith("*/")
