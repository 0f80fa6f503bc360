"""How free a plan is: blocks of equal inputs, and how far ahead switches are decided exactly."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from operator import index
from typing import Any

from hysdel_py.errors import ArgumentError

__all__ = ["Shape", "choose_shape"]


@dataclass(frozen=True, slots=True)
class Shape:
    """Freedom of a plan.

    Attributes
    ----------
    starts : tuple of int
        For each stage the first stage of its block, in which the inputs are equal.
    exact : int
        Binaries of stages before this one are 0 or 1, later ones anything between.
    """

    starts: tuple[int, ...]
    exact: int

    @classmethod
    def free(cls, horizon: int) -> Shape:
        """Every input and every binary is decided."""
        return cls(tuple(range(horizon)), horizon)

    @property
    def horizon(self) -> int:
        """Number of stages."""
        return len(self.starts)

    @property
    def is_exact(self) -> bool:
        """Whether all binaries of the plan are 0 or 1."""
        return self.exact >= self.horizon

    def is_held(self, k: int) -> bool:
        """Whether the inputs of a stage are those of the stage before."""
        return self.starts[k] < k


def choose_shape(
    horizon: int, blocking: Sequence[int] | None, control_horizon: int | None, binary_horizon: int | None
) -> Shape:
    """Check the options of a controller and return the shape of its plans.

    Parameters
    ----------
    horizon : int
    blocking : sequence of int, optional
        Lengths of the blocks of equal inputs, with the sum `horizon`.
    control_horizon : int, optional
        Number of inputs that are decided; the last one is held.
    binary_horizon : int, optional
        Number of stages whose binaries are exact.

    Raises
    ------
    ArgumentError
        Numbers out of range, blocks that do not add up, or blocks and a control horizon at once.
    """
    if blocking is not None and control_horizon is not None:
        raise ArgumentError("blocking and control_horizon are both given: one of them was expected")
    exact = horizon if binary_horizon is None else _within(binary_horizon, horizon, "binary_horizon")
    lengths: tuple[int, ...] = (1,) * horizon
    if control_horizon is not None:
        inputs = _within(control_horizon, horizon, "control_horizon")
        lengths = (1,) * (inputs - 1) + (horizon - inputs + 1,)
    elif blocking is not None:
        lengths = _lengths(blocking, horizon)
    starts = [start for start, length in zip(_sums(lengths), lengths, strict=True) for _ in range(length)]
    return Shape(tuple(starts), exact)


def _sums(lengths: tuple[int, ...]) -> list[int]:
    """Where each block starts."""
    return [sum(lengths[:i]) for i in range(len(lengths))]


def _within(value: Any, horizon: int, what: str) -> int:
    number = _whole(value)
    if number is None or not 1 <= number <= horizon:
        raise ArgumentError(f"{what} is {value!r}: a whole number from 1 to the horizon, {horizon}, was expected")
    return number


def _lengths(blocking: Any, horizon: int) -> tuple[int, ...]:
    entries = tuple(_whole(entry) for entry in blocking) if isinstance(blocking, Iterable) else (None,)
    lengths = tuple(entry for entry in entries if entry is not None and entry >= 1)
    if len(lengths) < len(entries) or sum(lengths) != horizon:
        raise ArgumentError(
            f"blocking is {blocking!r}: lengths of blocks, whole numbers with the sum {horizon} (the horizon), expected"
        )
    return lengths


def _whole(value: Any) -> int | None:
    try:
        return None if isinstance(value, bool) else index(value)
    except TypeError:
        return None
