"""Values as MATLAB and Octave write them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from hysdel_py.export.identifiers import element_of
from hysdel_py.export.matrices import nonzeros, row_text
from hysdel_py.systems.symbolic import Symbolic, postorder

__all__ = ["NumberStyle", "Value", "matrix", "parameter_is_missing", "quoted", "value_text"]

Value = str | float | tuple[str, ...]
"""What a field may hold: text, a number, or a cell array of texts."""

_KEYWORDS = frozenset({
    "break", "case", "catch", "classdef", "continue", "do", "else", "elseif", "end", "for", "function", "global", "if",
    "otherwise", "parfor", "persistent", "return", "spmd", "switch", "try", "until", "while",
})  # fmt: skip
_SUM, _PRODUCT, _SIGN, _POWER, _ATOM = range(1, 6)
_LEVEL = {"+": _SUM, "-": _SUM, "*": _PRODUCT, "/": _PRODUCT, "neg": _SIGN, "^": _POWER}
# Least level of the left and the right operand that needs no parentheses; the order of operations stays as it is.
_OPERANDS = {"+": (_SUM, _PRODUCT), "-": (_SUM, _PRODUCT), "*": (_PRODUCT, _POWER), "/": (_PRODUCT, _POWER),
             "^": (_ATOM, _ATOM), "neg": (_POWER, _POWER)}  # fmt: skip


@dataclass(frozen=True, slots=True)
class NumberStyle:
    """How numbers that wait for parameters are written.

    Attributes
    ----------
    maple : bool
        Write ``maple('min', a, b)`` for ``min(a, b)``, as the Symbolic Math Toolbox of old wanted it.
    """

    maple: bool = False

    def number(self, value: float) -> str:
        """Text of a number; 15 digits, as the original prints them."""
        if isinstance(value, Symbolic):
            return self._expression(value)
        if math.isinf(value):
            return "inf" if value > 0 else "-inf"
        return "NaN" if math.isnan(value) else f"{value + 0.0:.15g}"

    def entry(self, value: float) -> str:
        """Text of an entry of a matrix, where blanks part the columns."""
        return f"({self.number(value)})" if isinstance(value, Symbolic) else self.number(value)

    def _expression(self, number: Symbolic) -> str:
        texts: dict[int, tuple[str, int]] = {}
        for node in postorder(number):
            texts[id(node)] = self._node(node, [self._operand(arg, texts) for arg in node.args])
        return texts[id(number)][0]

    def _operand(self, arg: float, texts: dict[int, tuple[str, int]]) -> tuple[str, int]:
        if isinstance(arg, Symbolic):
            return texts[id(arg)]
        return self.number(arg), _SIGN if arg < 0 else _ATOM

    def _node(self, node: Symbolic, args: list[tuple[str, int]]) -> tuple[str, int]:
        if node.op == "name":
            return parameter_text(node.name), _ATOM
        if node.op not in _LEVEL:
            return self._call(node.op, ", ".join(text for text, _ in args)), _ATOM
        shown = [
            text if level >= wanted else f"({text})"
            for (text, level), wanted in zip(args, _OPERANDS[node.op], strict=False)
        ]
        text = f"-{shown[0]}" if node.op == "neg" else f"{shown[0]} {node.op} {shown[1]}"
        return text, _LEVEL[node.op]

    def _call(self, function: str, args: str) -> str:
        if self.maple and function in ("min", "max"):
            return f"maple('{function}', {args})"
        return f"{function}({args})"


def parameter_text(name: str) -> str:
    """Field of ``params`` that holds a parameter; that of a matrix holds its elements, that of a module a struct."""
    base, indices = element_of(name)
    fields = "".join(f".('{part}')" if part in _KEYWORDS else f".{part}" for part in base.split("."))
    return f"params{fields}" + (f"({', '.join(map(str, indices))})" if indices else "")


def parameter_is_missing(name: str) -> str:
    """Condition that ``params`` does not hold a parameter."""
    base, indices = element_of(name)
    parts = base.split(".")
    tests = [
        f"~isfield({parameter_text('.'.join(parts[:k])) if k else 'params'}, '{part}')" for k, part in enumerate(parts)
    ]
    field = parameter_text(base)
    if len(indices) == 1:
        tests.append(f"numel({field}) < {indices[0]}")
    tests += [f"size({field}, {axis}) < {index}" for axis, index in enumerate(indices, start=1) if len(indices) > 1]
    return " || ".join(tests)


def quoted(text: str) -> str:
    """A text in single quotes on one line."""
    return "'" + " ".join(text.split()).replace("'", "''") + "'"


def value_text(value: Value, style: NumberStyle) -> str:
    """Text of a field."""
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, tuple):
        return "{" + ", ".join(map(quoted, value)) + "}"
    return style.number(value)


def matrix(name: str, entries: Any, style: NumberStyle) -> str:
    """Assignment of a dense or sparse matrix, line by line; an empty one keeps its shape."""
    rows, columns = entries.shape
    if not rows or not columns:
        return f"{name} = zeros({rows}, {columns});"
    lines = [row_text(row, columns, "0 ", lambda value: f"{style.entry(value)} ") + ";" for row in nonzeros(entries)]
    return "\n".join([f"{name} = [", *lines, "];"])
