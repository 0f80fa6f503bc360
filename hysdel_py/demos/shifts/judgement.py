"""The figures of a shift, from the fine steps of its plant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.demos.shifts.cases import Shift
from hysdel_py.demos.shifts.plant import FINE, SAMPLE_TIME, STEPS_PER_SAMPLE
from hysdel_py.demos.shifts.references import torque_reference
from hysdel_py.demos.shifts.transmission import Transmission, engine_limit
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["Judgement", "drive_torque", "judged"]

Vector = NDArray[np.float64]

STUCK = 1e-6
"""Slip below which the clutch of the plant sticks [rad/s]; time-stepping leaves rounding only."""
BRAKE_ON = 0.02
"""Brake force above which the brake is on [N]; the models say 0.01, and know the friction only so well."""
_STEP = SAMPLE_TIME / STEPS_PER_SAMPLE
_JERK_WINDOW = 0.1  # s before and after lock-up
_TOUCHED = 1e-6
_BETWEEN_SAMPLES = 0.1  # Nm above the engine curve that its fall between two samples may leave


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """What a shift was like; times in seconds, torques in Nm, speeds in rad/s.

    Attributes
    ----------
    done : bool
        The clutch of the new gear locked and stayed locked.
    shift_time : float or None
        Until lock-up; None if there was none.
    deviation_release, deviation_engage : float
        Largest deviation of the drive-shaft torque from its reference in part 1 and in part 2 with lock-up.
    relative_release : float
        The first as a share of its reference.
    clutch_at_change : float
        Clutch force at the gear change [N].
    brake_at_reversal : float
        Brake force where the flywheel changes its direction [N]; 0 where it does not.
    lockup_slope : float or None
        Slope of the relative speed at lock-up [rad/s^2].
    jerk : float or None
        Largest jerk of the vehicle around lock-up [rad/s^3], at the wheels.
    brake_energy, clutch_energy : float
        Turned into heat [J].
    broken : tuple of str
        Physical limits that the plant broke, with by how much; empty when all were kept.
    touched : tuple of str
        Limits that were reached.
    moves, fallbacks, without : int
        Moves of the controllers; those of a fallback; those without any plan.
    proven : int
    solve_mean, solve_worst : float
        [s]
    """

    done: bool
    shift_time: float | None
    deviation_release: float
    deviation_engage: float
    relative_release: float
    clutch_at_change: float
    brake_at_reversal: float
    lockup_slope: float | None
    jerk: float | None
    brake_energy: float
    clutch_energy: float
    broken: tuple[str, ...]
    touched: tuple[str, ...]
    moves: int
    proven: int
    fallbacks: int
    without: int
    solve_mean: float
    solve_worst: float

    def figures(self) -> dict[str, Any]:
        """All figures as plain data."""
        return {name: getattr(self, name) for name in self.__slots__}

    def table(self) -> list[tuple[str, str]]:
        """The figures as lines of text and value."""
        slope = _shown(self.lockup_slope, ".1f", " rad/s^2")
        jerk = _shown(self.jerk, ".1f", " rad/s^3")
        release = f"{self.deviation_release:.1f} Nm ({100 * self.relative_release:.2f} % of the reference)"
        return [
            ("clutch of the new gear locked after", _shown(self.shift_time, ".3f", " s")),
            ("largest torque deviation, part 1", release),
            ("largest torque deviation, part 2", f"{self.deviation_engage:.1f} Nm"),
            ("clutch force at the gear change", f"{self.clutch_at_change:.3f} N"),
            ("brake force where the flywheel reverses", f"{self.brake_at_reversal:.4f} N"),
            ("slope of the relative speed at lock-up", slope),
            ("largest jerk at the wheels around lock-up", jerk),
            ("heat in the brake, in the clutch", f"{self.brake_energy:.0f} J, {self.clutch_energy:.0f} J"),
            ("limits broken at the plant", ", ".join(self.broken) or "none"),
            ("limits touched", ", ".join(self.touched) or "none"),
            (
                "moves, proven optimal, by fallback, without",
                f"{self.moves}, {self.proven}, {self.fallbacks}, {self.without}",
            ),
            ("solve time: mean, worst", f"{1e3 * self.solve_mean:.1f}, {1e3 * self.solve_worst:.1f} ms"),
        ]


def _shown(value: float | None, form: str, unit: str) -> str:
    return "never" if value is None else format(value, form) + unit


def drive_torque(data: Transmission, fine: Vector) -> Vector:
    """Torque of the drive shaft at the fine steps [Nm]."""
    dphi, ws, wv = (fine[:, FINE.index(name)] for name in ("dphi", "ws", "wv"))
    torque: Vector = data.k * dphi + data.d * (data.r_d * ws - wv)
    return torque


def judged(shift: Shift, data: Transmission, parts: tuple[Trajectory, ...], fine: Vector) -> Judgement:
    """Judge a run of a shift."""
    first = parts[0].steps * STEPS_PER_SAMPLE
    t = _STEP * np.arange(1, len(fine) + 1)
    reference = torque_reference(shift.torques, t, shift.fall)
    off = np.abs(drive_torque(data, fine) - reference)
    locked = _locked_from(fine, first)
    return Judgement(
        done=locked is not None,
        shift_time=None if locked is None else round(float(t[locked]), 6),
        deviation_release=float(off[:first].max()),
        deviation_engage=float(off[first:].max()),
        relative_release=float((off / reference)[:first].max()),
        clutch_at_change=float(fine[first - 1, FINE.index("Fnc")]),
        brake_at_reversal=_brake_at_reversal(fine),
        lockup_slope=_slope(fine, locked),
        jerk=_jerk(fine, locked),
        brake_energy=_heat(fine, "Tb", "wf"),
        clutch_energy=_heat(fine, "Tc", "slip"),
        broken=_broken(shift, fine, first),
        touched=_touched(shift, fine),
        **_effort(parts[:2]),
    )


def _locked_from(fine: Vector, first: int) -> int | None:
    """First step from which the clutch of the new gear sticks to the end."""
    slips = np.flatnonzero(np.abs(fine[first:, FINE.index("slip")]) > STUCK)
    begin = first + (int(slips[-1]) + 1 if slips.size else 0)
    return begin if begin < len(fine) else None


def _brake_at_reversal(fine: Vector) -> float:
    """Largest brake force at the steps between which the flywheel changes its direction."""
    wf, brake = fine[:, FINE.index("wf")], fine[:, FINE.index("Fnb")]
    turns = np.flatnonzero(wf[:-1] * wf[1:] <= 0)
    return float(max((max(brake[i], brake[i + 1]) for i in turns), default=0.0))


def _slope(fine: Vector, locked: int | None) -> float | None:
    """Slope over the last step before lock-up in which the clutch slipped all along."""
    if locked is None or locked < 2:
        return None
    slip = fine[:, FINE.index("slip")]
    return float(slip[locked - 1] - slip[locked - 2]) / _STEP


def _jerk(fine: Vector, locked: int | None) -> float | None:
    if locked is None:
        return None
    width = round(_JERK_WINDOW / _STEP)
    speed = fine[max(0, locked - width) : locked + width, FINE.index("wv")]
    return float(np.abs(np.diff(speed, 2)).max()) / _STEP**2


def _heat(fine: Vector, torque: str, speed: str) -> float:
    power = np.abs(fine[:, FINE.index(torque)] * fine[:, FINE.index(speed)])
    return float(power.sum()) * _STEP


def _ranges(shift: Shift) -> dict[str, tuple[float, float]]:
    return {"Te": (0.0, 145.0), "Fnb": (0.0, shift.force), "Fnc": (0.0, shift.force), "we": (84.0, 700.0)}


def _broken(shift: Shift, fine: Vector, first: int) -> tuple[str, ...]:
    """Ranges, engine curve, brake rule and sign of the relative speed, at every step of the plant."""
    beside = {
        name: float(np.max(np.maximum(low - fine[:, FINE.index(name)], fine[:, FINE.index(name)] - high)))
        for name, (low, high) in _ranges(shift).items()
    }
    curve = np.array([engine_limit(speed) for speed in fine[:, FINE.index("we")]])
    beside["engine curve"] = float(np.max(fine[:, FINE.index("Te")] - curve)) - _BETWEEN_SAMPLES
    late = fine[first:]
    braked = late[:, FINE.index("Fnb")] > BRAKE_ON
    beside["brake rule"] = float(np.max(np.where(braked, late[:, FINE.index("wf")] + 5.0, -1.0)))
    if shift.gears[1] > shift.gears[0]:  # in a downshift the engine passes the new gear and is met from above
        beside["relative speed"] = float(np.max(-late[:, FINE.index("slip")])) - STUCK
    return tuple(f"{name} by {value:.3g}" for name, value in beside.items() if value > _TOUCHED)


def _touched(shift: Shift, fine: Vector) -> tuple[str, ...]:
    """Limits of the controllers that were reached within a share of 0.001."""
    found = []
    for name, (_, high) in _ranges(shift).items():
        values = fine[:, FINE.index(name)]
        if values.max() >= 0.989 * high:
            found.append(f"{name} above")
    curve = np.array([engine_limit(speed) for speed in fine[:, FINE.index("we")]])
    if np.any(fine[:, FINE.index("Te")] >= curve - 0.05):
        found.append("engine curve")
    return tuple(found)


def _effort(parts: tuple[Trajectory, ...]) -> dict[str, Any]:
    status = np.concatenate([part.info["status"] for part in parts])
    seconds = np.concatenate([part.info["seconds"] for part in parts])
    fallbacks = int(np.nansum(np.concatenate([part.info["fallback"] for part in parts])))
    without = int(np.sum((status >= 2) & (status <= 5)))
    return {
        "moves": len(status), "proven": int(np.sum(status == 0)), "fallbacks": fallbacks, "without": without,
        "solve_mean": float(seconds.mean()), "solve_worst": float(seconds.max()),
    }  # fmt: skip
