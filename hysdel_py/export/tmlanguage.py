"""A TextMate grammar of the language, made from the grammar of the parser.

Editors such as VS Code, Sublime Text and TextMate colour by it, and so do web sites. It is written by
``python -m hysdel_py.export.tmlanguage editors/vscode/syntaxes/hysdel.tmLanguage.json``.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hysdel_py.syntax.extension import QUERY_CLAUSES, QUERY_KINDS, QUERY_WORDS
from hysdel_py.syntax.parser import grammar_text
from hysdel_py.syntax.tokens import KEYWORDS, SECTIONS, TYPES

__all__ = ["SCOPE", "grammar_json", "tmlanguage"]

SCOPE = "source.hysdel"
_CONTROL = frozenset({"IF", "THEN", "ELSE", "FOR"}) | QUERY_KINDS | QUERY_CLAUSES
_TRUTHS = frozenset({"TRUE", "FALSE"})
_PREDEFINED = ("pi", "MLD_epsilon", "MLD_bigMbound")
_LATER_OPERATORS = ("==", "<", ">", ":", ".", "=")


def tmlanguage(grammar: str) -> dict[str, Any]:
    """The TextMate grammar.

    Parameters
    ----------
    grammar : str
        Text of the grammar of the parser; keywords, functions, numbers, names and operators are read from it.
    """
    words = KEYWORDS | QUERY_WORDS | set(re.findall(r'"([A-Z]+)"', grammar))
    rest = words - SECTIONS - TYPES - _CONTROL - _TRUTHS
    return {
        "name": "HYSDEL",
        "scopeName": SCOPE,
        "fileTypes": ["hys"],
        "patterns": [
            _block_comment(),
            {"name": "comment.line.double-slash.hysdel", "match": "//.*$"},
            _words("keyword.control.hysdel", words & _CONTROL),
            _words("storage.type.hysdel", words & TYPES),
            {"name": "storage.type.hysdel", "match": rf"\b{_terminal(grammar, 'INDEX')}"},
            _words("keyword.other.section.hysdel", words & SECTIONS | rest),
            _words("constant.language.hysdel", words & _TRUTHS),
            {"name": "support.function.hysdel", "match": rf"\b{_terminal(grammar, 'FUNCTION')}"},
            _words("variable.language.hysdel", _PREDEFINED),
            {"name": "constant.numeric.hysdel", "match": rf"(?<![A-Za-z0-9_]){_terminal(grammar, 'NUMBER')}"},
            {"name": "variable.other.hysdel", "match": _terminal(grammar, "NAME")},
            {"name": "keyword.operator.hysdel", "match": _alternatives(_operators(grammar))},
            {"name": "punctuation.separator.hysdel", "match": "[,;]"},
        ],
    }


def _block_comment() -> dict[str, Any]:
    unit = {"match": r"(?<=/\*)\s*(\[[^\]]*\])", "captures": {"1": {"name": "constant.other.unit.hysdel"}}}
    return {"name": "comment.block.hysdel", "begin": r"/\*", "end": r"\*/", "patterns": [unit]}


def _words(scope: str, words: Iterable[str]) -> dict[str, str]:
    return {"name": scope, "match": rf"\b(?:{'|'.join(sorted(words))})\b"}


def _terminal(grammar: str, name: str) -> str:
    """Pattern of a terminal that the grammar defines by a regular expression; groups do not capture."""
    match = re.search(rf"^{name}(?:\.\d+)?: /(.*)/$", grammar, re.MULTILINE)
    assert match is not None, name  # the grammar comes with the package
    return re.sub(r"(?<!\\)\((?!\?)", "(?:", match[1])


def _operators(grammar: str) -> set[str]:
    """All literals of terminals that are neither words nor brackets."""
    lines = re.findall(r'^[A-Z_]+: (".*)$', grammar, re.MULTILINE)
    return {literal for line in lines for literal in re.findall(r'"([^"]+)"', line)} | set(_LATER_OPERATORS)


def _alternatives(literals: set[str]) -> str:
    """Pattern for literals, the longest first."""
    return "|".join(re.escape(literal) for literal in sorted(literals, key=lambda text: (-len(text), text)))


def grammar_json() -> str:
    """Text of the file that editors read."""
    return json.dumps(tmlanguage(grammar_text()), indent=2) + "\n"


def _main(path: str) -> None:
    Path(path).write_text(grammar_json(), encoding="utf-8")


if __name__ == "__main__":
    import sys

    _main(sys.argv[1])
