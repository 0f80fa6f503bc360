"""What becomes of constant terms in updates and outputs."""

from __future__ import annotations

from enum import Enum

__all__ = ["Constants"]


class Constants(Enum):
    """Treatment of constant terms in CONTINUOUS, AUTOMATA and OUTPUT.

    ``AFFINE`` puts them into B5 and D5 (option ``-5`` of the original compiler), ``AUX`` into a real auxiliary that is
    fixed by two rows (``-a``), ``FORBID`` makes them errors (no option).
    """

    AFFINE = "affine"
    AUX = "aux"
    FORBID = "forbid"
