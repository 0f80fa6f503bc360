"""Limits of memory and tolerances of the numerical recursion."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Real

from hysdel_py.control.dynamic_programming.checks import positive, whole
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
        positive(self.least_weight, "least_weight")
        object.__setattr__(self, "chunk", whole(self.chunk, "chunk"))
        if self.least_weight > 1:
            raise ArgumentError(f"least_weight is {self.least_weight}: a share, at most 1, was expected")
        for name in ("memory", "keep"):
            value = getattr(self, name)
            if not (isinstance(value, Real) and float(value) >= 0):
                raise ArgumentError(f"{name} is {value!r}: a number of bytes was expected")
