"""The closed list of what can be said about a source text."""

from __future__ import annotations

from enum import Enum

__all__ = ["Code"]


class Code(Enum):
    """Code of a diagnostic; the value is printed and can be looked up by ``hysdel explain``."""

    # reading and parsing
    UNREADABLE = "HYS001"
    NOT_TEXT = "HYS002"
    NOT_UTF8 = "HYS003"
    TOO_LONG = "HYS004"
    EMPTY = "HYS005"
    DIALECT = "HYS006"
    BAD_CHARACTER = "HYS101"
    UNEXPECTED = "HYS102"
    TOO_MANY_ERRORS = "HYS103"
    MISSING_SEMICOLON = "HYS104"
    UNCLOSED = "HYS105"
    MISSPELT_KEYWORD = "HYS106"
    # names
    UNDECLARED = "HYS201"
    DECLARED_TWICE = "HYS202"
    NOT_CONSTANT = "HYS203"
    PARAMETER_CYCLE = "HYS204"
    PARAMETER_MISSING = "HYS205"
    PARAMETER_UNKNOWN = "HYS206"
    PARAMETER_VALUE = "HYS207"
    # types and items
    WRONG_TYPE = "HYS301"
    NOT_AFFINE = "HYS302"
    WRONG_LEFT_SIDE = "HYS303"
    DEFINED_TWICE = "HYS304"
    DEFINED_BY_ITSELF = "HYS305"
    OUTPUT_USED = "HYS306"
    NOT_A_COMPARISON = "HYS307"
    TRIPLE_NEEDS_ZERO = "HYS308"
    BAD_ARITHMETIC = "HYS309"
    NOT_SUPPORTED = "HYS310"
    QUERY = "HYS311"
    # lowering
    NO_BOUNDS = "HYS401"
    CIRCULAR_BOUNDS = "HYS402"
    CONSTANT_TERM = "HYS403"
    EPSILON_NOT_PARAMETER = "HYS404"
    TOO_MANY_CLAUSES = "HYS405"
    TOO_LARGE = "HYS406"
    # warnings
    UNUSED = "HYS501"
    NEVER_DEFINED = "HYS502"
    SWAPPED_BOUNDS = "HYS503"
    LOOSE_TRIPLE = "HYS504"
    ALGEBRAIC_LOOP = "HYS505"
    CONSTANT_COMPARISON = "HYS520"
    NEVER_SWITCHES = "HYS521"
    CONSTANT_CONDITION = "HYS522"
    MUST_NEVER_HOLDS = "HYS523"
    MUST_ALWAYS_HOLDS = "HYS524"
    UNUSED_PARAMETER = "HYS525"
    LARGE_BIG_M = "HYS526"
    SMALL_EPSILON = "HYS527"
    MISSING_BOUNDS = "HYS528"
    LOOSE_BOUNDS = "HYS529"
    NOT_A_NUMBER = "HYS530"
    ASSUMED_BOUNDS = "HYS531"
    DEAD_BRANCH = "HYS540"
    # what only a search over all states and inputs shows (check --deep)
    STEP_FORBIDDEN = "HYS541"
    NOT_UNIQUE = "HYS542"
    EVENT_CONSTANT = "HYS543"
    BRANCH_UNREACHABLE = "HYS544"
    NOTHING_ALLOWED = "HYS545"
    MUST_IMPLIED = "HYS546"
    LEAVES_RANGE = "HYS547"
    # what HYSDEL 2.0.5 would refuse or get wrong
    EXTENSION = "HYS901"
    # vectors, loops and modules
    SIZE_MISMATCH = "HYS601"
    INDEX = "HYS602"
    SIZE = "HYS603"
    MODULE = "HYS604"
    # style (a warning)
    MIXED_LOGIC = "HYS506"
