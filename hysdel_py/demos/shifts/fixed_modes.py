"""A controller without binaries: what a linear predictive controller does with a plant that switches.

Its model has the clutch slipping forwards and the flywheel turning backwards all along. The brake rule is handed to it
as limits: where its own last plan, one sample later, has the flywheel near its reversal or beyond, the brake may not be
on. The sequence of modes is thus fixed before each plan, by the plan before, instead of being chosen with it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.limits import Limits
from hysdel_py.control.move import Move
from hysdel_py.demos.shifts.cases import HORIZON, Shift
from hysdel_py.demos.shifts.controllers import BRAKE_RULE, GAP, part_of, shift_cost, shift_limits
from hysdel_py.demos.shifts.transmission import Transmission
from hysdel_py.model import Model, load

__all__ = ["FixedModes", "linear_controller", "linear_model"]

Vector = NDArray[np.float64]


def linear_model(shift: Shift, part: int, data: Transmission) -> Model:
    """The shipped model without switches, in the gear of part 1 or 2."""
    old, new = (data.gears[gear] for gear in shift.gears)
    return load("bist_linear", r_gear=old if part == 1 else new, r_new=new, F_max=shift.force)


def linear_controller(shift: Shift, part: int, data: Transmission) -> HybridMpc:
    """The controller of part 1 or 2 with weights, limits and horizon of the hybrid one; each plan is one QP."""
    model, own = linear_model(shift, part, data), part_of(shift, part)
    limits = shift_limits(shift, part, data)
    return HybridMpc(model, HORIZON, shift_cost(own, part), limits, gap_rel=GAP, fallback="soft")


@dataclass(eq=False)
class FixedModes:
    """Where the brake may be on, as the last plan has it.

    Parameters
    ----------
    brake : float
        Greatest force of the brake [N].
    """

    brake: float
    _wheel: Vector | None = field(init=False, default=None)

    def limits(self) -> Limits:
        """Limits of the brake over the next plan, for the sequence that the last one gives."""
        most = np.full(HORIZON + 1, self.brake)
        if self._wheel is not None:
            most[np.append(self._wheel[1:], self._wheel[-1:].repeat(2)) > BRAKE_RULE] = 0.0
        return Limits(x={"Fnb": (0.0, most)})

    def remember(self, move: Move) -> None:
        """Keep the flywheel speeds of a plan."""
        self._wheel = None if move.predicted is None else np.asarray(move.predicted["wf"], dtype=float)
