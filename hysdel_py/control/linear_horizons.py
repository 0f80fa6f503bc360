"""How far a linear controller plans, decides and looks after its limits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from operator import index
from typing import Any

from hysdel_py.errors import ArgumentError

__all__ = ["Horizons", "choose_horizons"]


@dataclass(frozen=True, slots=True)
class Horizons:
    """Horizons of a linear controller.

    Attributes
    ----------
    steps : int
        N: stages in the cost.
    moves : int
        Nu: free moves.
    outputs, inputs : int
        Ncy, Ncu: last times at which outputs and inputs are limited.
    first_output : int
        0 or 1: first time at which outputs are limited.
    """

    steps: int
    moves: int
    outputs: int
    inputs: int
    first_output: int

    @property
    def output_times(self) -> range:
        """Times at which outputs and states are limited."""
        return range(self.first_output, self.outputs + 1)

    @property
    def input_times(self) -> range:
        """Times at which inputs and their increments are limited."""
        return range(self.inputs + 1)

    def until_the_end(self, *, increments: bool) -> Horizons:
        """Horizons with limits of inputs until an invariant set takes over, lest the next step have no plan.

        Parameters
        ----------
        increments : bool
            Whether the step from the last input to the first one of the gain is limited too.
        """
        return replace(self, inputs=self.steps - (0 if increments else 1))


def choose_horizons(horizon: Any, control: Any, outputs: Any, inputs: Any, *, constrain_now: bool) -> Horizons:
    """Check the horizons of a controller and put in the usual ones for those that are None.

    Raises
    ------
    ArgumentError
        Not whole numbers, or out of range.
    """
    steps = _whole(horizon, "horizon", 1, None)
    moves = steps if control is None else _whole(control, "control_horizon", 1, steps)
    last_output = steps - 1 if outputs is None else _whole(outputs, "output_constraint_horizon", 0, steps)
    last_input = moves - 1 if inputs is None else _whole(inputs, "input_constraint_horizon", 0, steps)
    return Horizons(steps, moves, last_output, last_input, 0 if constrain_now else 1)


def _whole(value: Any, what: str, least: int, most: int | None) -> int:
    try:
        number = None if isinstance(value, bool) else index(value)
    except TypeError:
        number = None
    if number is None or number < least or (most is not None and number > most):
        end = f"at least {least}" if most is None else f"{least} to {most} (the horizon)"
        raise ArgumentError(f"{what} is {value!r}: a whole number, {end}, was expected")
    return number
