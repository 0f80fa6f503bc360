"""Simulation from event to event, over any way of integrating between two of them.

A flow integrates one mode. It gives pieces: intervals over which the state can be evaluated at any time. Indicators are
positive as long as the mode lasts: the slip of a sliding contact times its sign, and the distances of the torque of a
sticking one from its two limits. An indicator that begins at zero counts only once it has been positive.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from hysdel_py.drivetrain.decomposition import ContactSolver
from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.kernels.arrays import Plant
from hysdel_py.drivetrain.kernels.time_stepping import NEGATIVE, POSITIVE, STICK
from hysdel_py.drivetrain.schemes.mode_selection import select_modes
from hysdel_py.drivetrain.schemes.segments import Segment, segments
from hysdel_py.drivetrain.trajectory import ContactMode, Event

__all__ = ["Flow", "Log", "Piece", "run_events"]

Matrix = NDArray[np.float64]
Modes = NDArray[np.int64]

INSIDE = 1e-9
"""Modes are chosen with the inputs this share of an interval behind its beginning."""

ARMED = 1e-12
"""An indicator above this share of its scale has been positive."""

HALVINGS = 30
"""Places between two looks at which a slip that begins and ends there is searched for."""

MOST_EVENTS_AT_ONCE = 200
AT_ONCE = 1e-10


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """A part of a solution: its ends, the state at any time between, and where to look for changes of sign."""

    start: float
    end: float
    state: Callable[[float], Matrix]
    looks: int


class Flow(Protocol):
    """Integrates one mode; `problem` says why the pieces end early, if they do."""

    problem: str

    def pieces(self, segment: Segment, modes: Modes, t: float, z: Matrix) -> Iterator[Piece]:
        """Pieces from t to the end of the segment."""
        ...

    def torques(self, segment: Segment, modes: Modes, t: float, z: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        """Torques lambda and their lower and upper limits."""
        ...


@dataclass(slots=True)
class Log:
    """What a run writes down: samples (time, state, torques, limits, modes) and events."""

    times: list[float] = field(default_factory=list)
    states: list[Matrix] = field(default_factory=list)
    contacts: list[tuple[Matrix, Matrix, Matrix, Modes]] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    steps: int = 0
    message: str = ""


@dataclass(slots=True)
class _Run:
    """The state of a run."""

    equations: Equations
    plant: Plant
    flow: Flow
    solver: ContactSolver
    samples: Matrix | None
    t: float
    z: Matrix
    modes: Modes
    log: Log = field(default_factory=Log)


def run_events(
    equations: Equations,
    plant: Plant,
    flow: Flow,
    solver: ContactSolver,
    u: Matrix,
    e: Matrix,
    until: float,
    samples: Matrix | None,
) -> Log:
    """Run from t = 0; the state is (u, e, works)."""
    modes = np.full(len(equations.laws), NEGATIVE, dtype=np.int64)
    run = _Run(equations, plant, flow, solver, samples, 0.0, np.concatenate([u, e, np.zeros(3)]), modes)
    first = True
    for segment in segments(equations, until):
        _select(run, segment, {}, quiet=first)
        first = False
        _pass(run, segment)
        if run.log.message:
            break
    return run.log


def _pass(run: _Run, segment: Segment) -> None:
    """Go through one segment, event by event."""
    _sample(run, segment, run.t, run.z)
    recent: list[float] = []
    while run.t < segment.end:
        broken = _until_event(run, segment)
        if broken is None:
            return
        recent = [time for time in recent if run.t - time < AT_ONCE] + [run.t]
        if len(recent) > MOST_EVENTS_AT_ONCE:
            run.log.message = f"events accumulate at t = {run.t:.9g} s: the run ends there"
            return
        _select(run, segment, broken, quiet=False)
        _sample(run, segment, run.t, run.z)


def _select(run: _Run, segment: Segment, broken: dict[int, int], *, quiet: bool) -> None:
    """Choose modes at the present time and note what changed."""
    n = len(run.plant.M)
    m = len(run.plant.k)
    just_behind = min(run.t + INSIDE * (segment.end - segment.start), segment.end)
    inputs = segment.at(run.t)._replace(pressure=segment.at(just_behind).pressure)
    u, modes = select_modes(
        run.plant, inputs, run.z[:n], run.z[n : n + m], run.modes, segment.open, broken, run.solver
    )  # fmt: skip
    names = run.equations.names.contacts
    for i in np.flatnonzero((modes != run.modes) & (not quiet)):
        before, after = ContactMode(int(run.modes[i])), ContactMode(int(modes[i]))
        run.log.events.append(Event(float(run.t), names[i], before, after))
    run.modes = modes
    run.z = np.concatenate([u, run.z[n:]])


def _until_event(run: _Run, segment: Segment) -> dict[int, int] | None:
    """Advance to the next event; sticking contacts that let go there, or None at the end of the segment."""
    owners, indicators, scales = _indicators(run, segment)
    armed = indicators(run.t, run.z) > ARMED * scales
    for piece in run.flow.pieces(segment, run.modes, run.t, run.z):
        before = piece.start
        run.log.steps += 1
        for look in range(1, piece.looks + 1):
            now = piece.start + (piece.end - piece.start) * look / piece.looks
            values = indicators(now, piece.state(now))
            crossed = np.flatnonzero((values < 0) & (armed | (values < -1e3 * ARMED * scales)))
            if len(crossed):
                when, first = _earliest(indicators, piece, before, now, crossed, armed)
                _move(run, segment, piece, when)
                return {owners[i][0]: owners[i][1] for i in first if owners[i][1]}
            armed |= values > ARMED * scales
            before = now
        _move(run, segment, piece, piece.end)
    if run.t < segment.end:
        run.log.message = f"the integration stopped at t = {run.t:.9g} s: {run.flow.problem}"
    return None


def _indicators(run: _Run, segment: Segment) -> tuple[list[tuple[int, int]], Callable[[float, Matrix], Matrix], Matrix]:
    """Contact of each indicator and the mode that its crossing means (zero: slip ended); their values; their scales."""
    n, modes = len(run.plant.M), run.modes
    sliding = [(int(i), int(modes[i])) for i in np.flatnonzero((modes == POSITIVE) | (modes == NEGATIVE))]
    sticking = [int(i) for i in np.flatnonzero(modes == STICK)]
    owners = [(i, 0) for i, _ in sliding]
    owners += [(i, mode) for i in sticking for mode in (POSITIVE, NEGATIVE)]
    sign = np.array([float(s) for _, s in sliding])
    W = run.plant.W[:, [i for i, _ in sliding]]
    columns = [i for i, _ in sliding]

    def values(t: float, z: Matrix) -> Matrix:
        slip = sign * (z[:n] @ W + segment.at(t).slip[columns])
        if not sticking:
            return slip
        torque, lo, hi = run.flow.torques(segment, modes, t, z)
        room = np.stack([torque - lo, hi - torque], axis=-1)[sticking].ravel()
        return np.concatenate([slip, room])

    lo, hi = run.flow.torques(segment, modes, 0.5 * (run.t + segment.end), run.z)[1:]
    room = np.repeat(np.maximum((hi - lo)[sticking], 1e-9), 2)
    speeds = np.maximum(1.0, np.abs(run.z[:n]) @ np.abs(W)) if sliding else np.zeros(0)
    return owners, values, np.concatenate([speeds, room])


def _earliest(
    indicators: Callable[[float, Matrix], Matrix],
    piece: Piece,
    before: float,
    now: float,
    crossed: NDArray[np.int64],
    armed: NDArray[np.bool_],
) -> tuple[float, list[int]]:
    """Time of the first root in an interval, and the indicators that are zero there."""
    roots = {}
    for i in crossed:

        def value(t: float, i: int = i) -> float:
            return float(indicators(t, piece.state(t))[i])

        left = before if armed[i] and value(before) > 0 else _rise(value, before, now)
        roots[int(i)] = before if left is None else brentq(value, left, now, xtol=1e-15, rtol=8.9e-16)
    when = min(roots.values())
    return when, [i for i, root in roots.items() if root - when <= AT_ONCE * 1e-3]


def _rise(value: Callable[[float], float], before: float, now: float) -> float | None:
    """A time at which an indicator that begins at zero and ends below it is positive, found towards the beginning.

    A slip may grow after an event and end before the next look.
    """
    times = (before + (now - before) * 0.5**k for k in range(1, HALVINGS))
    return next((t for t in times if value(t) > 0), None)


def _move(run: _Run, segment: Segment, piece: Piece, when: float) -> None:
    """Advance to a time inside a piece and write the samples on the way."""
    if run.samples is None:
        if piece.end == when:
            _sample(run, segment, when, piece.state(when))
    else:
        inside = run.samples[(run.samples > piece.start) & (run.samples <= when)]
        for t in inside:
            _sample(run, segment, float(t), piece.state(float(t)))
    run.t, run.z = when, np.array(piece.state(when))


def _sample(run: _Run, segment: Segment, t: float, z: Matrix) -> None:
    """Write down a state, unless samples are wanted at other times only."""
    if run.samples is not None:
        near = run.samples[np.argmin(np.abs(run.samples - t))]
        if near != t:
            return
    log = run.log
    if log.times and log.times[-1] == t:
        for column in (log.times, log.states, log.contacts):
            column.pop()
    log.times.append(t)
    log.states.append(z)
    log.contacts.append((*run.flow.torques(segment, run.modes, t, z), run.modes.copy()))
