"""Runs the few kinds of statements that the MATLAB writer uses, to read its files without MATLAB."""

from __future__ import annotations

import math
import re
from types import SimpleNamespace
from typing import Any

import numpy as np

_PATH = re.compile(r"\.(\w+)|\{(\d+)\}|\((\d+)\)")


def read_matlab(text: str, parameters: dict[str, float] | None = None) -> dict[str, Any]:
    """The struct S: matrices as arrays, cells as dictionaries from the 1-based index, texts and numbers."""
    names = {"params": SimpleNamespace(**(parameters or {})), "inf": math.inf, "NaN": math.nan, "nan": math.nan}
    names |= {name: getattr(math, name) for name in ("sin", "cos", "exp", "log", "sqrt")} | {"min": min, "max": max}
    names["maple"] = lambda function, *args: {"min": min, "max": max}[function](*args)
    data: dict[str, Any] = {}
    statements = re.findall(r"^S(\S+) = (\[\n.*?\]|[^\n]*);$", text, re.MULTILINE | re.DOTALL)
    for place, value in statements:
        _assign(data, [a or int(b or c) for a, b, c in _PATH.findall(place)], _value(value, names, data))
    return data


def _assign(data: Any, keys: list[Any], value: Any) -> None:
    for key in keys[:-1]:
        data = data.setdefault(key, {}) if isinstance(data, dict) else data[key - 1]
    if isinstance(data, np.ndarray):
        data[keys[-1] - 1, 0] = value
    else:
        data[keys[-1]] = value


def _value(text: str, names: dict[str, Any], data: dict[str, Any]) -> Any:
    if match := re.fullmatch(r"zeros\((\d+), (\d+)\)", text):
        return np.zeros((int(match[1]), int(match[2])))
    if match := re.fullmatch(r"([+-]inf) \* ones\(S\.(\w+), 1\)", text):
        return np.full((int(data[match[2]]), 1), float(match[1]))
    if text.startswith("{"):
        return dict(enumerate(re.findall(r"'((?:[^']|'')*)'", text), start=1))
    if text.startswith("'"):
        return text[1:-1].replace("''", "'")
    if text.startswith("[\n"):
        return np.array([[_number(e, names) for e in _entries(line)] for line in text[2:-2].splitlines()])
    if text.startswith("["):
        return _joined(text, data)
    return _number(text, names)


def _entries(line: str) -> list[str]:
    """Entries of a row: blanks part them outside parentheses."""
    entries, depth = [""], 0
    for sign in line.removesuffix(" ;"):
        depth += (sign == "(") - (sign == ")")
        if sign == " " and not depth:
            entries.append("")
        else:
            entries[-1] += sign
    return entries


def _number(text: str, names: dict[str, Any]) -> float:
    return float(eval(text.replace("^", "**"), {"__builtins__": {}}, names))


def _joined(text: str, data: dict[str, Any]) -> Any:
    if text == "[]":
        return np.zeros((0, 0))
    rows = [[data[name] for name in re.findall(r"S\.(\w+)", row)] for row in text[1:-1].split(";")]
    return np.vstack([np.hstack(row) for row in rows])
