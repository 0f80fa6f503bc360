"""What is left of a sweep: one record for each seed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from hysdel_py.errors import ArgumentError

__all__ = ["Seed", "Sweep", "SweepRecord"]

Seed = int | str


@dataclass(frozen=True, slots=True)
class SweepRecord:
    """The outcome of one task.

    Attributes
    ----------
    seed : int or str
        What the task was called with.
    value : object
        What it returned; None where it failed.
    error : str
        Kind and message of the exception, empty where there was none.
    trace : str
        Where the exception came from; not compared.
    seconds : float
        Duration of the task in s, where it ran; not compared.
    """

    seed: Seed
    value: Any = None
    error: str = ""
    trace: str = field(default="", compare=False, repr=False)
    seconds: float = field(default=0.0, compare=False)

    @property
    def ok(self) -> bool:
        """Whether the task returned."""
        return not self.error


@dataclass(frozen=True, slots=True, repr=False)
class Sweep:
    """The outcomes of a sweep, in the order of its seeds whatever the executor was.

    Attributes
    ----------
    records : tuple of SweepRecord
    resumed : int
        Records that were taken from the file instead of being worked out; not compared.
    """

    records: tuple[SweepRecord, ...]
    resumed: int = field(default=0, compare=False)

    def __repr__(self) -> str:
        return f"<Sweep of {len(self.records)} tasks: {len(self.values)} done, {len(self.failures)} failed>"

    def __len__(self) -> int:
        return len(self.records)

    def __getitem__(self, seed: Seed) -> SweepRecord:
        """Record of a seed.

        Raises
        ------
        ArgumentError
            The sweep had no such seed.
        """
        found = next((record for record in self.records if record.seed == seed), None)
        if found is None:
            raise ArgumentError(f"the sweep had no seed {seed!r}")
        return found

    @property
    def ok(self) -> bool:
        """Whether every task returned."""
        return not self.failures

    @property
    def values(self) -> tuple[Any, ...]:
        """What the tasks returned, without those that failed."""
        return tuple(record.value for record in self.records if record.ok)

    @property
    def failures(self) -> tuple[SweepRecord, ...]:
        """The records of the tasks that failed."""
        return tuple(record for record in self.records if not record.ok)

    def failure_text(self) -> str:
        """One line for each failed task, with its seed."""
        return "\n".join(f"seed {record.seed!r}: {record.error}" for record in self.failures)
