"""The three gear shifts of the document: start, torque at the wheels, weights, limits and lengths of both parts.

Numbers are those of equations (10.18) to (10.23) and appendix K of J.R.P. Kusters, "Modelling and coordinated control
of advanced automotive transmissions", TU/e, DCT 2005-58. Its reference trajectories are not in its text; ours are made
by :mod:`hysdel_py.demos.shifts.references`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

__all__ = ["HORIZON", "SHIFTS", "Guard", "Part", "Shift", "shift_between"]

HORIZON = 10
"""Steps of 0.01 s that each controller plans."""

Span = tuple[float | None, float | None]


@dataclass(frozen=True, slots=True)
class Part:
    """One controller of a shift.

    Attributes
    ----------
    torque, wheel, relative : float
        Weights of the drive-shaft torque, of the flywheel speed and of the relative speed.
    brake, clutch : float
        Weights of both forces.
    wf, rel : pair of float or None
        Limits of flywheel speed and relative speed [rad/s].
    seconds : float
    clutch_force : float
        Limit of the clutch force [N], before the margin.
    brake_force : float, optional
        Limit of the brake force [N] where it is not that of the shift.
    rates : float
        Weight of the rates, per Nm/s and N/s.
    """

    torque: float
    wheel: float = 0.0
    relative: float = 0.0
    brake: float = 0.0
    clutch: float = 0.0
    wf: Span = (None, None)
    rel: Span = (None, None)
    seconds: float = 0.5
    clutch_force: float = 200.0
    brake_force: float | None = None
    rates: float = 0.01


@dataclass(frozen=True, slots=True)
class Guard:
    """A least slip while the clutch opens, and when it has to be open.

    Attributes
    ----------
    slip : float
        [rad/s], reached over `build` seconds.
    build : float
    open_by : float
        Second by which the clutch force is zero.
    lead : float
        Seconds before that from which the engine may fall behind.
    """

    slip: float
    build: float
    open_by: float
    lead: float


@dataclass(frozen=True, slots=True)
class Shift:
    """A gear shift.

    Attributes
    ----------
    name, title : str
    gears : pair of int
        Old and new gear.
    torques : pair of float
        Drive-shaft torque before and after [Nm].
    speed : float
        Of the wheels at the start [rad/s].
    release, engage : Part
        Part 1 and part 2.
    force : float
        Greatest force of the brake [N].
    slip_back : float
        Slip at which the clutch torque of the model of part 1 changes its sign [rad/s].
    wheel_target : float
        Flywheel speed that part 1 leads to [rad/s].
    held_slip : float
        Slip at which the clutch is held while it opens [rad/s]; see :mod:`hysdel_py.demos.shifts.references`.
    fall : float
        Seconds over which the torque at the wheels changes.
    fading : float
        How fast the slope of the relative speed fades before lock-up [rad/s^3].
    guard : Guard, optional
        A limit that keeps the slip of the opening clutch positive, where the reference alone does not.
    rolling : bool
        Whether all shafts gain speed as the vehicle does when the shift begins; at rest only the vehicle does.
    """

    name: str
    title: str
    gears: tuple[int, int]
    torques: tuple[float, float]
    speed: float
    release: Part
    engage: Part
    force: float = 200.0
    slip_back: float = -1.0
    wheel_target: float = -50.0
    held_slip: float = 2.0
    fall: float = 0.5
    fading: float = 500.0
    guard: Guard | None = None
    rolling: bool = False


_CONSTANT = Shift(
    "upshift-23", "upshift from second to third gear at constant torque", (2, 3), (600.0, 600.0), 75.0,
    Part(50.0, wheel=3.0, brake=1.0, clutch=100.0, wf=(-300.0, -5.0), rel=(0.0, None), rates=0.05),
    Part(100.0, relative=3.0, brake=1.0, wf=(-300.0, 300.0), rel=(0.0, None), seconds=0.75, rates=0.003),
)  # fmt: skip
_DECREASING = Shift(
    "upshift-23-kickdown", "upshift from second to third gear at falling torque", (2, 3), (800.0, 600.0), 75.0,
    Part(50.0, wheel=3.0, brake=1.0, clutch=100.0, wf=(-300.0, -5.0), rel=(0.0, None), rates=0.05),
    Part(50.0, relative=5.0, brake=2.0, wf=(-300.0, 300.0), rel=(-100.0, None), seconds=1.0, rates=0.003),
)  # fmt: skip
_FIRST = Shift(
    "upshift-12", "upshift from first to second gear at falling torque", (1, 2), (1600.0, 850.0), 40.0,
    Part(50.0, brake=1.0, clutch=100.0, wf=(-1000.0, -200.0), rel=(-1000.0, 1000.0), clutch_force=250.0),
    Part(50.0, relative=1.0, brake=20.0, wf=(-500.0, 0.0), rel=(-100.0, None), seconds=1.0, rates=0.003),
    force=250.0, slip_back=-1000.0, fall=0.21, guard=Guard(6.0, 0.15, 0.47, 0.05),
)  # fmt: skip
_HELD = replace(
    _FIRST, name="upshift-12-held", title="upshift from first to second gear from the torque that can be held",
    torques=(1300.0, 850.0), fall=0.3, rolling=True,
)  # fmt: skip
_DOWN = Shift(
    "downshift-32", "downshift from third to second gear under power, the brake off", (3, 2), (400.0, 400.0), 45.0,
    Part(50.0, clutch=100.0, brake_force=0.01, rates=0.05),
    Part(50.0, relative=1.0, rel=(-400.0, None), brake_force=0.01, seconds=1.0, rates=0.003),
    slip_back=-1000.0, fading=1000.0,
)  # fmt: skip
SHIFTS: Mapping[str, Shift] = {shift.name: shift for shift in (_CONSTANT, _DECREASING, _FIRST, _HELD, _DOWN)}
"""By the name that the command takes."""


def shift_between(gears: tuple[int, int], torques: tuple[float, float], speed: float) -> Shift:
    """The shift of the document that fits, with other torques and speed; a downshift is ours.

    Parameters
    ----------
    gears : pair of int
    torques : pair of float
        Drive-shaft torque before and after [Nm].
    speed : float
        Of the wheels [rad/s].
    """
    old, new = gears
    if new < old:
        kind = _DOWN
    elif old == 1:
        kind = _FIRST
    else:
        kind = _CONSTANT if torques[0] <= torques[1] else _DECREASING
    return replace(kind, name=f"{old}-{new}", gears=gears, torques=torques, speed=speed)
