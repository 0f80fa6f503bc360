"""A simulated or predicted run of a sampled system."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Variable
from hysdel_py.systems.summary import counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame
    from xarray import Dataset

__all__ = ["Trajectory"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory:
    """N steps of a system: N+1 states and N inputs, outputs and auxiliaries.

    Attributes
    ----------
    t : array of shape (N+1,)
        Times in units of the sample time, or in seconds where one was given.
    x : array of shape (N+1, nx)
    u, y, d, z : arrays of shape (N, n)
        ``y[k]``, ``d[k]`` and ``z[k]`` belong to ``x[k]`` and ``u[k]``.
    variables : mapping of "x", "u", "y", "d", "z" to tuples of Variable
    modes : tuple of str
        One word of zeros and ones per step: the values of d.
    messages : tuple of str
        What a reader should know about the run, empty when there is nothing to say.
    info : mapping
        Signals that the controller or the simulator added, each an array of length N.
    """

    t: Matrix
    x: Matrix
    u: Matrix
    y: Matrix
    d: Matrix
    z: Matrix
    variables: Mapping[str, tuple[Variable, ...]]
    messages: tuple[str, ...] = ()
    info: Mapping[str, Matrix] = field(default_factory=dict)

    def __repr__(self) -> str:
        signals = "; ".join(", ".join(self.names[key]) for key in ("x", "u", "y") if self.names.get(key))
        return f"<Trajectory of {counted(self.steps, 'step')} to t={self.t[-1]:g}: {signals}>"

    def _repr_html_(self) -> str:
        from hysdel_py.markup.cards import trajectory_card

        return trajectory_card(self)

    @property
    def steps(self) -> int:
        """Number N of steps."""
        return len(self.u)

    @property
    def names(self) -> dict[str, tuple[str, ...]]:
        """Names of the columns of each array."""
        return {key: tuple(v.name for v in group) for key, group in self.variables.items()}

    @property
    def modes(self) -> tuple[str, ...]:
        """The binary word of each step."""
        return tuple("".join("1" if bit > 0.5 else "0" for bit in row) for row in self.d)

    def __getitem__(self, name: str) -> Matrix:
        """Column of one variable by name.

        A name that stands for a state and an output gives the state, which has one sample more; the letter of a vector
        in front, as in ``y.level``, tells them apart.

        Raises
        ------
        ArgumentError
            There is no such signal; the message lists those that there are.
        """
        vector, dot, own = name.partition(".")
        for key, group in self.variables.items():
            for column, variable in enumerate(group):
                if variable.name == name or (dot and key == vector and variable.name == own):
                    values: Matrix = getattr(self, key)[:, column]
                    return values
        added = name.removeprefix("info.")
        if added in self.info:
            return self.info[added]
        raise ArgumentError(f"the trajectory has no signal {name}: it has {', '.join(self._all_names())}")

    def _all_names(self) -> Iterator[str]:
        for group in self.variables.values():
            yield from (variable.name for variable in group)
        yield from self.info

    def columns(self) -> dict[str, Matrix]:
        """All signals by name, cut to the N steps.

        A name used twice gets the letter of its vector, as in ``x.level``, and what the controller added gets ``info``.
        """
        groups = [
            (key, v.name, getattr(self, key)[: self.steps, i])
            for key, group in self.variables.items()
            for i, v in enumerate(group)
        ]
        names = [name for _, name, _ in groups]
        table = {"t": self.t[: self.steps]}
        for key, name, values in groups:
            table[name if names.count(name) == 1 and name != "t" else f"{key}.{name}"] = values
        return table | {name if name not in table else f"info.{name}": values for name, values in self.info.items()}

    def to_dict(self) -> dict[str, Any]:
        """Plain lists, ready for JSON."""
        return {
            "names": {key: list(value) for key, value in self.names.items()},
            **{key: getattr(self, key).tolist() for key in ("t", "x", "u", "y", "d", "z")},
            "info": {key: np.asarray(value).tolist() for key, value in self.info.items()},
            "messages": list(self.messages),
        }

    def to_csv(self) -> str:
        """Table with one line per step and the names in the first line."""
        columns = self.columns()
        lines = [",".join(columns)]
        lines += [",".join(f"{value:.12g}" for value in row) for row in zip(*columns.values(), strict=True)]
        return "\n".join(lines) + "\n"

    def to_pandas(self) -> DataFrame:
        """Table with one row per step as a pandas DataFrame (pandas has to be installed).

        The index is the time, the columns are those of :meth:`columns`; ``attrs["units"]`` has the known units by
        column.
        """
        from hysdel_py.systems.tables import to_pandas

        return to_pandas(self)

    def to_xarray(self) -> Dataset:
        """One row per step as an xarray Dataset over the time (xarray has to be installed).

        Each signal has the attributes ``kind`` (letter of its vector, or ``info``), ``units`` and ``description``, as
        far as they are known.
        """
        from hysdel_py.systems.tables import to_xarray

        return to_xarray(self)

    def plot(self, *names: str, time_unit: str = "") -> Figure:
        """Draw the named signals, all states, inputs and outputs by default (matplotlib has to be installed).

        Parameters
        ----------
        *names : str
            Signals to draw, named as in :meth:`columns`.
        time_unit : str
            Unit of the times; without one the axis counts steps where the times are whole steps, and seconds elsewhere.
        """
        from hysdel_py.plotting.trajectory import plot_trajectory

        return plot_trajectory(self, names, time_unit)
