"""A simulated run of a drivetrain, the same from every scheme."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.equations import Names
from hysdel_py.errors import ArgumentError

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

__all__ = ["ContactMode", "DrivetrainTrajectory", "Event"]

Matrix = NDArray[np.float64]


class ContactMode(IntEnum):
    """What a contact does: slides with negative or positive slip, sticks, is open, or waits after break-away."""

    NEGATIVE = -1
    STICK = 0
    POSITIVE = 1
    OPEN = 2
    WAIT_POSITIVE = 3
    WAIT_NEGATIVE = -3

    @property
    def letter(self) -> str:
        """One sign for tables: ``s`` sticks, ``+`` and ``-`` slip, ``o`` is open, ``w`` waits."""
        return {-1: "-", 0: "s", 1: "+", 2: "o"}.get(int(self), "w")


@dataclass(frozen=True, slots=True)
class Event:
    """A change of the mode of one contact.

    Attributes
    ----------
    time : float
        [s]; schemes with fixed steps know it up to one step.
    contact : str
    before, after : ContactMode
    """

    time: float
    contact: str
    before: ContactMode
    after: ContactMode

    def __str__(self) -> str:
        return f"{self.time:.9f} s: {self.contact} {self.before.name.lower()} -> {self.after.name.lower()}"


@dataclass(frozen=True, eq=False)
class DrivetrainTrajectory:
    """N + 1 samples of a run.

    Attributes
    ----------
    t : array of shape (N+1,)
        [s]
    speeds : array of shape (N+1, shafts)
        Speeds of all shafts [rad/s].
    twists : array of shape (N+1, springs)
        [rad]
    torques : array of shape (N+1, contacts)
        Torque from the first shaft to the second [Nm]; for time-stepping schemes the mean of the step before.
    slips : array of shape (N+1, contacts)
        Speed of the first shaft less that of the second [rad/s].
    mode_codes : int array of shape (N+1, contacts)
        Values of :class:`ContactMode`.
    residuals : array of shape (N+1,)
        How far slip and torque are from the friction law [rad/s]; see :func:`law_residuals`.
    works : array of shape (N+1, 3)
        Work of sources, losses and friction since the start [J].
    energy : array of shape (N+1,)
        Kinetic and elastic energy [J].
    inputs : array of shape (N+1, signals)
    undetermined : bool array of shape (N+1, contacts)
        Torques that are one choice of many: contacts that stick together share them in a way that no law decides. The
        speeds are unique all the same.
    events : tuple of Event
    names : Names
    signal_names : tuple of str
    messages : tuple of str
        What a reader should know about the run, empty when there is nothing to say.
    info : mapping
        Effort: ``scheme``, ``steps``, ``solves`` (contact problems or iterations), ``failures``, ``evaluations``.
    """

    t: Matrix
    speeds: Matrix
    twists: Matrix
    torques: Matrix
    slips: Matrix
    mode_codes: NDArray[np.int64]
    residuals: Matrix
    works: Matrix
    energy: Matrix
    inputs: Matrix
    undetermined: NDArray[np.bool_]
    events: tuple[Event, ...]
    names: Names
    signal_names: tuple[str, ...]
    messages: tuple[str, ...] = ()
    info: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in (
            "t",
            "speeds",
            "twists",
            "torques",
            "slips",
            "mode_codes",
            "residuals",
            "works",
            "energy",
            "inputs",
            "undetermined",
        ):
            array = getattr(self, name).view()
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def modes(self) -> tuple[str, ...]:
        """One word per sample with a sign for each contact; see :attr:`ContactMode.letter`."""
        return tuple("".join(ContactMode(int(code)).letter for code in row) for row in self.mode_codes)

    @property
    def imbalance(self) -> Matrix:
        """Energy that no work accounts for, at each sample [J]."""
        surplus: Matrix = self.energy - self.energy[0] - self.works.sum(axis=1)
        return surplus

    def columns(self) -> dict[str, Matrix]:
        """All signals by name: shafts, springs, ``contact.slip``, ``contact.torque``, ``contact.mode``, inputs."""
        table = {"t": self.t}
        table |= dict(zip(self.names.shafts, self.speeds.T, strict=True))
        table |= dict(zip(self.names.springs, self.twists.T, strict=True))
        for i, name in enumerate(self.names.contacts):
            table[f"{name}.slip"] = self.slips[:, i]
            table[f"{name}.torque"] = self.torques[:, i]
            table[f"{name}.mode"] = self.mode_codes[:, i].astype(float)
        table |= {f"{name}.input": column for name, column in zip(self.signal_names, self.inputs.T, strict=True)}
        return table | {"energy": self.energy, "residual": self.residuals}

    def __getitem__(self, name: str) -> Matrix:
        """One signal by its name in :meth:`columns`.

        Raises
        ------
        ArgumentError
            There is no such signal; the message lists those that there are.
        """
        table = self.columns()
        if name not in table:
            raise ArgumentError(f"the trajectory has no signal {name}: it has {', '.join(table)}")
        return table[name]

    def to_dict(self) -> dict[str, Any]:
        """Plain lists, ready for JSON."""
        return {
            "columns": {name: values.tolist() for name, values in self.columns().items()},
            "events": [
                {"time": e.time, "contact": e.contact, "before": e.before.name, "after": e.after.name}
                for e in self.events
            ],
            "messages": list(self.messages),
            "info": dict(self.info),
        }

    def to_csv(self) -> str:
        """Table with one line per sample and the names in the first line."""
        columns = self.columns()
        return "\n".join([",".join(columns), *self._lines(columns)]) + "\n"

    @staticmethod
    def _lines(columns: Mapping[str, Matrix]) -> Iterator[str]:
        for row in zip(*columns.values(), strict=True):
            yield ",".join(f"{value:.12g}" for value in row)

    def to_pandas(self) -> DataFrame:
        """Table with one row per sample as a pandas DataFrame (pandas has to be installed)."""
        import pandas as pd  # type: ignore[import-untyped,unused-ignore]

        return pd.DataFrame(self.columns()).set_index("t")

    def plot(self) -> Figure:
        """Draw speeds, torques and modes (matplotlib has to be installed)."""
        from hysdel_py.plotting.drivetrain import plot_drivetrain

        return plot_drivetrain(self)
