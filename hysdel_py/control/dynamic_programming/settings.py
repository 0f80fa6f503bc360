"""Limits of memory and tolerances of the numerical recursion."""

from __future__ import annotations

from dataclasses import dataclass

from hysdel_py.errors import ArgumentError

__all__ = ["DpSettings"]


@dataclass(frozen=True, slots=True)
class DpSettings:
    """Memory and tolerances.

    Attributes
    ----------
    memory : float
        Bytes that a run may need; more is refused before it starts.
    keep : float
        Bytes up to which the transitions of a plant that does not depend on time are computed once and kept.
    chunk : int
        Transitions that are worked on at a time.
    least_weight : float
        A point has a value if its feasible corners carry at least this share of the interpolation.
    """

    memory: float = 4e9
    keep: float = 1e9
    chunk: int = 200_000
    least_weight: float = 1e-9

    def __post_init__(self) -> None:
        for name in self.__slots__:
            if not getattr(self, name) > 0 and name != "keep":
                raise ArgumentError(f"{name} is {getattr(self, name)}: a positive number was expected")
