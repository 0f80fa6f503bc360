"""The operators of the language, shared by the syntax tree and the typed expressions."""

from __future__ import annotations

from enum import Enum

__all__ = ["ARITHMETIC", "ARROWS", "COMPARISONS", "CONNECTIVES", "FUNCTIONS", "Op"]


class Op(Enum):
    """An operator or function; the value is its preferred spelling."""

    NEGATE = "-x"
    ADD = "+"
    SUBTRACT = "-"
    MULTIPLY = "*"
    DIVIDE = "/"
    POWER = "^"
    SIN = "sin"
    COS = "cos"
    EXP = "exp"
    LOG = "log"
    SQRT = "sqrt"
    CAST = "(REAL)"
    TRANSPOSE = "'"
    LE = "<="
    GE = ">="
    LT = "<"
    GT = ">"
    EQ = "=="
    IF = "if"
    NOT = "~"
    AND = "&"
    OR = "|"
    IMPLIES = "->"
    IMPLIED_BY = "<-"
    IFF = "<->"


FUNCTIONS = frozenset({Op.SIN, Op.COS, Op.EXP, Op.LOG, Op.SQRT})
ARITHMETIC = frozenset({Op.NEGATE, Op.ADD, Op.SUBTRACT, Op.MULTIPLY, Op.DIVIDE, Op.POWER}) | FUNCTIONS
COMPARISONS = frozenset({Op.LE, Op.GE, Op.LT, Op.GT, Op.EQ})
ARROWS = frozenset({Op.IMPLIES, Op.IMPLIED_BY, Op.IFF})
CONNECTIVES = frozenset({Op.NOT, Op.AND, Op.OR}) | ARROWS
