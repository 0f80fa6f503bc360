"""From components to equations of motion: ``M = T'J T`` and one column or entry for each component."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.checks import check_columns, check_mass
from hysdel_py.drivetrain.components import (
    GROUND,
    Brake,
    Clutch,
    Component,
    Contact,
    EngineMap,
    Inertia,
    Load,
    OneWayClutch,
    SpeedSource,
    SpringDamper,
    TorqueSource,
    VehicleLoad,
)
from hysdel_py.drivetrain.equations import Equations, Gains, Maps, Names, no_maps
from hysdel_py.drivetrain.laws import Coulomb, as_law
from hysdel_py.drivetrain.shafts import Shafts, connect, label
from hysdel_py.drivetrain.signals import Signal, as_signal
from hysdel_py.errors import ArgumentError

__all__ = ["assemble"]

Matrix = NDArray[np.float64]


def assemble(components: Sequence[Component]) -> Equations:
    """Derive the equations of motion.

    Raises
    ------
    ArgumentError
        The components do not fit together; see :func:`connect`. A shaft that moves has no inertia.
    """
    shafts = connect(components)
    _check_nonlinear(components, shafts)
    if not shafts.independent:
        raise ArgumentError("a drivetrain needs an Inertia or a VehicleLoad that can move")
    contacts = [contact for c in components if (contact := _contact(c)) is not None]
    springs = [c for c in components if isinstance(c, SpringDamper) and c.stiffness > 0]
    loads = [(c.shaft, c.quadratic) for c in components if isinstance(c, Load) and c.quadratic > 0]
    loads += [(c.name, c.drag * c.radius**3) for c in components if isinstance(c, VehicleLoad) and c.drag > 0]
    J = _inertias(components, shafts)
    M = shafts.T.T @ (J[:, None] * shafts.T)
    check_mass(M, shafts.independent)
    W = _columns([(c.driving, c.driven) for c in contacts], shafts)
    for contact, column in zip(contacts, W.T, strict=True):
        if not np.any(column):
            raise ArgumentError(f"contact {contact.name} has no slip: gears or sources fix the speeds on both sides")
    signals, names, gains = _inputs(components, contacts, springs, shafts, J)
    check_columns(shafts.names, [s.name for s in springs], [c.name for c in contacts], names)
    return Equations(
        M=M,
        D=_damping(components, shafts),
        B=_columns([(s.first, s.second) for s in springs], shafts),
        k=np.array([s.stiffness for s in springs], dtype=float),
        W=W,
        drag_directions=_columns([(name, GROUND) for name, _ in loads], shafts),
        drag=np.array([value for _, value in loads], dtype=float),
        maps=_maps([c for c in components if isinstance(c, EngineMap)], shafts),
        T=shafts.T,
        laws=tuple(c.law for c in contacts),
        side=np.array([c.side for c in contacts], dtype=float).reshape(len(contacts), 2),
        signals=signals,
        signal_names=names,
        gains=gains,
        names=Names(shafts.independent, shafts.names, tuple(s.name for s in springs), tuple(c.name for c in contacts)),
    )


def _contact(component: Component) -> Contact | None:
    match component:
        case Clutch():
            return _dry_contact(component, component.driving, component.driven)
        case Brake():
            return _dry_contact(component, component.shaft, GROUND)
        case OneWayClutch(capacity=capacity):
            pressure = as_signal(capacity, component.name)
            return Contact(component.name, component.driving, component.driven, Coulomb(), (0.0, 1.0), pressure, 1.0)
        case VehicleLoad(rolling=rolling) if rolling > 0:
            return component.rolling_contact
        case _:
            return None


def _dry_contact(component: Clutch | Brake, driving: str, driven: str) -> Contact:
    law, force = as_law(component.friction, component.name), as_signal(component.force, component.name)
    return Contact(component.name, driving, driven, law, (-1.0, 1.0), force, component.radius * component.surfaces)


def _check_nonlinear(components: Sequence[Component], shafts: Shafts) -> None:
    """Maps and drag read the speed of one shaft, which must not contain a given one."""
    for c in components:
        if (
            isinstance(c, EngineMap | Load)
            and np.any(shafts.given_row(c.shaft))
            and not (isinstance(c, Load) and c.quadratic == 0)
        ):
            raise ArgumentError(f"{label(c)} acts on a shaft whose speed a SpeedSource gives: a free one was expected")


def _inertias(components: Sequence[Component], shafts: Shafts) -> Matrix:
    own = {c.name: c.inertia for c in components if isinstance(c, Inertia | VehicleLoad)}
    return np.array([own.get(name, 0.0) for name in shafts.names])


def _columns(pairs: Sequence[tuple[str, str]], shafts: Shafts) -> Matrix:
    """One column per pair of shafts: speed of the first less that of the second."""
    found = [shafts.row(a) - shafts.row(b) for a, b in pairs]
    return np.array(found).reshape(len(pairs), shafts.T.shape[1]).T.copy()


def _given_columns(pairs: Sequence[tuple[str, str]], shafts: Shafts) -> Matrix:
    found = [shafts.given_row(a) - shafts.given_row(b) for a, b in pairs]
    return np.array(found).reshape(len(pairs), shafts.P.shape[1])


def _damping(components: Sequence[Component], shafts: Shafts) -> Matrix:
    """``D``: dampers of springs and linear loads."""
    D = np.zeros((shafts.T.shape[1],) * 2)
    for a, b, factor in _dampers(components):
        direction = shafts.row(a) - shafts.row(b)
        touched = np.flatnonzero(direction)
        D[np.ix_(touched, touched)] += factor * np.outer(direction[touched], direction[touched])
    return D


def _dampers(components: Sequence[Component]) -> list[tuple[str, str, float]]:
    found = [(c.first, c.second, c.damping) for c in components if isinstance(c, SpringDamper)]
    return found + [(c.shaft, GROUND, c.damping) for c in components if isinstance(c, Load)]


def _maps(engines: Sequence[EngineMap], shafts: Shafts) -> Maps:
    if not engines:
        return no_maps(shafts.T.shape[1])
    sizes = np.array([np.shape(e.torques) for e in engines], dtype=np.int64)
    rows, columns = sizes.max(axis=0)
    speed, throttle = np.zeros((len(engines), columns)), np.zeros((len(engines), rows))
    torque = np.zeros((len(engines), rows, columns))
    for i, (engine, (a, b)) in enumerate(zip(engines, sizes, strict=True)):
        speed[i, :b], throttle[i, :a], torque[i, :a, :b] = engine.speeds, engine.throttles, engine.torques
    return Maps(_columns([(e.shaft, GROUND) for e in engines], shafts), speed, throttle, torque, sizes)


def _inputs(
    components: Sequence[Component],
    contacts: Sequence[Contact],
    springs: Sequence[SpringDamper],
    shafts: Shafts,
    J: Matrix,
) -> tuple[tuple[Signal, ...], tuple[str, ...], Gains]:
    """Signals in the order torques, slopes of the road, throttles, normal forces, given speeds; and their gains."""
    torques: list[tuple[str, str, Any]] = [
        (c.name, c.shaft, c.torque) for c in components if isinstance(c, TorqueSource)
    ]
    torques += [
        (c.name, c.name, as_signal(-c.downhill_torque, c.name)) for c in components if isinstance(c, VehicleLoad)
    ]
    throttles = [(c.name, c.throttle) for c in components if isinstance(c, EngineMap)]
    speeds = [(c.name, c.speed) for c in components if isinstance(c, SpeedSource)]
    entries: list[tuple[str, Any]] = [(name, signal) for name, _, signal in torques]
    entries += [*throttles, *((c.name, c.pressure) for c in contacts), *speeds]
    n, ns = shafts.T.shape[1], len(entries)
    first_map, first_contact, first_speed = np.cumsum([len(torques), len(throttles), len(contacts)])
    force = np.zeros((n, ns))
    for i, (_, shaft, _) in enumerate(torques):
        force[:, i] = shafts.row(shaft)
    force[:, first_speed:] -= _from_given_speeds(components, shafts)
    place = _placed(ns, first_speed)
    gains = Gains(
        force=force,
        force_rate=place(-shafts.T.T @ (J[:, None] * shafts.P)),
        pressure=np.eye(len(contacts), ns, first_contact) * np.array([c.arm for c in contacts]).reshape(-1, 1),
        twist=place(_given_columns([(s.first, s.second) for s in springs], shafts)),
        slip=place(_given_columns([(c.driving, c.driven) for c in contacts], shafts)),
        throttle=np.eye(len(throttles), ns, first_map),
        shaft=place(shafts.P),
    )
    return tuple(signal for _, signal in entries), tuple(name for name, _ in entries), gains


def _placed(columns: int, first: int) -> Callable[[Matrix], Matrix]:
    """A function that puts a matrix into the columns of the prescribed speeds."""

    def place(block: Matrix) -> Matrix:
        whole = np.zeros((block.shape[0], columns))
        whole[:, first:] = block
        return whole

    return place


def _from_given_speeds(components: Sequence[Component], shafts: Shafts) -> Matrix:
    """Torque of the dampers per prescribed speed."""
    total = np.zeros((shafts.T.shape[1], shafts.P.shape[1]))
    if not total.size:
        return total
    for a, b, factor in _dampers(components):
        total += factor * np.outer(shafts.row(a) - shafts.row(b), shafts.given_row(a) - shafts.given_row(b))
    return total
