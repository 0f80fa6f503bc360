"""Names for the places in the tuples that the kernels of the search hand on; each is explained where it is made.

numba wants tuples where arrays of several kinds go together, and a constant for the place in one.
"""

from __future__ import annotations

__all__ = [
    "ACTIVES",
    "BINARIES",
    "BOUNDS",
    "BOX",
    "CARRIED",
    "COLUMNS",
    "COSTS",
    "COUNTERS",
    "COVER",
    "DECISIONS",
    "DEPTHS",
    "FEASIBILITY",
    "GAPS",
    "GROUPS",
    "HERE",
    "INCUMBENT",
    "INTEGRALITY",
    "KNOWN",
    "LOWER",
    "MULTIPLIERS",
    "NARROWING",
    "NEAR",
    "NUMBERS",
    "ORDER",
    "PRIORITIES",
    "PROBE_FROM",
    "PROBLEM",
    "PROPAGATION",
    "RELAXED",
    "ROOT",
    "ROOT_ACTIVE",
    "ROUNDING",
    "SOLVER",
    "SPARE",
    "SPLITS",
    "TOP",
    "TO_TRY",
    "TRIED",
    "UPPER",
    "USED",
    "WAYS",
    "WIDE",
]  # fmt: skip

PROBLEM, GROUPS, COLUMNS, WIDE, DECISIONS, BINARIES, PRIORITIES, KNOWN, SPARE = range(9)
"""Of `data`, see :func:`hysdel_py.optimize.kernels.search.run`."""
INCUMBENT, NUMBERS, COUNTERS, BOX, RELAXED, TRIED, ROOT, ROOT_ACTIVE, TO_TRY, COSTS = range(10)
HERE, MULTIPLIERS, COVER, TOP, CARRIED = range(10, 15)
"""Of `state`, see there."""
GAPS, SOLVER, PROPAGATION, FEASIBILITY, INTEGRALITY, ROUNDING, PROBE_FROM, NARROWING = range(8)
"""Of `settings`, see there."""
LOWER, UPPER, BOUNDS, SPLITS, DEPTHS, ACTIVES, USED, ORDER, NEAR, WAYS = range(10)
"""Of `tree`, see :mod:`hysdel_py.optimize.kernels.tree`."""
