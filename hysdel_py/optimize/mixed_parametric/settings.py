"""Tolerances and limits of the enumeration in one frozen object."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.parametric.settings import MpQpSettings
from hysdel_py.optimize.propagation import PropagationSettings

__all__ = ["MpMiqpSettings"]


@dataclass(frozen=True, slots=True)
class MpMiqpSettings:
    """How sequences are tried, and when to stop.

    Attributes
    ----------
    meet : float
        Sides of parallel rows that are closer than this are one side; here and in `zero` and `outwards` variables are
        scaled to [-1, 1] and rows to a greatest coefficient of 1.
    pivot : float
        The variable that an equality defines has at least this share of its greatest coefficient.
    zero : float
        A coefficient that substitution left smaller is zero.
    outwards : float
        A sequence is given up when its rows have no common point after they were moved outwards by this much.
    sequences : int
        Stop after so many sequences with regions.
    seconds : float
        Stop after so many seconds.
    chunk : int
        Sequences that are looked at before the progress is told and the limits are checked; also how many an executor
        is given at a time.
    mpqp : MpQpSettings
        For the program of each sequence.
    propagation : PropagationSettings
    """

    meet: float = 1e-10
    pivot: float = 1e-3
    zero: float = 1e-10
    outwards: float = 1e-10
    sequences: int = 1_000_000
    seconds: float = inf
    chunk: int = 16
    mpqp: MpQpSettings = field(default_factory=MpQpSettings)
    propagation: PropagationSettings = field(default_factory=PropagationSettings)

    def __post_init__(self) -> None:
        for name in ("meet", "pivot", "zero", "outwards", "sequences", "seconds", "chunk"):
            if not getattr(self, name) > 0:
                raise ArgumentError(f"{name} is {getattr(self, name)}: a positive number was expected")
