"""Which gear, which torque at the wheels, and which shift: from the pedal, the speed and the traction map.

The levels above a shift in section 8.1 of the document: the strategy is a pedal that asks for a share of the greatest
traction at the speed; the supervisor turns it into gear and torque and refuses what cannot be done, with a reason; the
coordination is the pair of controllers of the shift that it picks.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from hysdel_py.demos.shifts.cases import Shift, shift_between
from hysdel_py.demos.shifts.traction import bridged, sustained, traction
from hysdel_py.demos.shifts.transmission import Transmission, engine_limit
from hysdel_py.errors import ArgumentError

__all__ = ["Decision", "Supervisor"]


@dataclass(frozen=True, slots=True)
class Decision:
    """What the supervisor wants.

    Attributes
    ----------
    gear : int
        The gear to be in.
    torque : float
        Drive-shaft torque [Nm].
    shift : Shift or None
        The shift to run now.
    reason : str
        Why this shift, or why none although another gear would be better; empty where there is nothing to say.
    """

    gear: int
    torque: float
    shift: Shift | None = None
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Supervisor:
    """Thresholds of the engine speed grow with the pedal, apart from each other by more than a shift changes the speed.

    Attributes
    ----------
    data : Transmission
    up : pair of float
        Engine speed above which the next gear is wanted, at pedal 0 and at pedal 1 [rad/s].
    down : pair of float
        Engine speed below which the gear before is wanted.
    kick : float
        Pedal from which the gear before is wanted whenever it gives more torque.
    reserve : float
        Share of the traction that is used.
    least : float
        Smallest drive-shaft torque of a shift [Nm]: with less the engine takes too long to its new speed.
    rest : float
        Seconds between two shifts.
    """

    data: Transmission = field(default_factory=Transmission)
    up: tuple[float, float] = (250.0, 520.0)
    down: tuple[float, float] = (110.0, 170.0)
    kick: float = 0.95
    reserve: float = 0.95
    least: float = 150.0
    rest: float = 1.0

    def decide(self, gear: int, wheels: float, pedal: float, torque: float, since: float) -> Decision:
        """Decide for one moment.

        Parameters
        ----------
        gear : int
            In place.
        wheels : float
            Speed of the wheels [rad/s].
        pedal : float
            0 to 1.
        torque : float
            Drive-shaft torque now [Nm].
        since : float
            Seconds since the last shift.

        Raises
        ------
        ArgumentError
            No such gear, or a pedal outside 0 to 1.
        """
        if not 0.0 <= pedal <= 1.0:
            raise ArgumentError(f"pedal is {pedal!r}: a number from 0 to 1 was expected")
        self.data.overall(gear)
        asked = pedal * max(traction(self.data, g, wheels) for g in self.data.gears)
        here = min(asked, self.reserve * sustained(self.data, gear, wheels))
        wanted, why = self._wanted_gear(gear, wheels, pedal, asked)
        if wanted == gear:
            return Decision(gear, here)
        if since < self.rest:
            return Decision(gear, here, None, f"{gear}-{wanted} wanted ({why}), {self.rest:g} s after a shift at most")
        after = min(asked, self.reserve * sustained(self.data, wanted, wheels))
        if wanted < gear:  # the engine alone carries it with the clutch open; the rest comes when the shift is done
            after = min(after, self._bridged(gear, wanted, wheels))
        refused = self._refusal(gear, wanted, wheels, after, torque)
        if refused:
            return Decision(gear, here, None, f"{gear}-{wanted} refused: {refused}")
        return Decision(wanted, after, shift_between((gear, wanted), (torque, after), wheels), why)

    def _wanted_gear(self, gear: int, wheels: float, pedal: float, asked: float) -> tuple[int, str]:
        engine = self.data.engine_speed(gear, wheels)
        up, down = (low + pedal * (high - low) for low, high in (self.up, self.down))
        if gear + 1 in self.data.gears and engine > up:
            return gear + 1, f"engine above {up:.0f} rad/s"
        if gear - 1 not in self.data.gears:
            return gear, ""
        if engine < down:
            return gear - 1, f"engine below {down:.0f} rad/s"
        before = self.data.engine_speed(gear - 1, wheels)
        if pedal >= self.kick and before < 0.95 * up and asked > traction(self.data, gear, wheels):
            return gear - 1, "kick-down"
        return gear, ""

    def _refusal(self, gear: int, wanted: int, wheels: float, after: float, torque: float) -> str:
        """Why a shift cannot be done, empty if it can."""
        engine = self.data.engine_speed(wanted, wheels)
        if traction(self.data, wanted, wheels) == 0.0:
            return f"the engine would turn at {engine:.0f} rad/s, outside its range"
        if min(after, torque) < self.least:
            return f"{min(after, torque):.0f} Nm at the wheels, {self.least:g} Nm are needed to move the engine"
        most = self._bridged(gear, wanted, wheels)
        if after > most:
            return f"{after:.0f} Nm after the shift, {most:.0f} Nm at most with the clutch open"
        return ""

    def _bridged(self, gear: int, wanted: int, wheels: float) -> float:
        """Torque that engine and brake, in a downshift the engine alone, carry with the clutch open [Nm]."""
        now = engine_limit(self.data.engine_speed(gear, wheels))
        brake = 0.0 if wanted < gear else self.data.mu * 0.9 * 200.0
        return bridged(self.data, 0.95 * now, brake)
