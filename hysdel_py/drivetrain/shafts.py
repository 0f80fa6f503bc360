"""The shafts of a drivetrain, and which of their speeds are independent once gears tie them together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.components import (
    GROUND,
    Brake,
    Clutch,
    Component,
    EngineMap,
    Gear,
    Inertia,
    Load,
    OneWayClutch,
    PlanetaryGear,
    SpeedSource,
    SpringDamper,
    TorqueSource,
    VehicleLoad,
)
from hysdel_py.errors import ArgumentError

__all__ = ["Shafts", "connect", "label"]

Matrix = NDArray[np.float64]

_ZERO = 1e-12
"""A coefficient of a constraint below this share of its greatest one is a rounding error."""


@dataclass(frozen=True, eq=False, slots=True)
class Shafts:
    """All shafts and the kinematics of the gears.

    Attributes
    ----------
    names : tuple of str
    independent : tuple of str
        Shafts whose speeds are the coordinates u.
    prescribed : tuple of str
    T, P : arrays of shape (N, n) and (N, number of prescribed)
        Speeds of all shafts: ``T u + P s``.
    """

    names: tuple[str, ...]
    independent: tuple[str, ...]
    prescribed: tuple[str, ...]
    T: Matrix
    P: Matrix

    def row(self, name: str) -> Matrix:
        """Direction of a shaft in the coordinates; zero for the ground."""
        return np.zeros(self.T.shape[1]) if name == GROUND else self.T[self.names.index(name)]

    def given_row(self, name: str) -> Matrix:
        """The same in the prescribed speeds."""
        return np.zeros(self.P.shape[1]) if name == GROUND else self.P[self.names.index(name)]


def label(component: Component) -> str:
    """Kind and name of a component, for messages."""
    return f"{type(component).__name__} {component.name}"


def connect(components: Sequence[Component]) -> Shafts:
    """Find the shafts and eliminate what the gears determine.

    Raises
    ------
    ArgumentError
        A name is used twice or is unknown, a shaft leads nowhere, or gears contradict or repeat each other.
    """
    _check_names(components)
    shafts = _declared(components)
    for component in components:
        _check_shafts(component, shafts)
    _check_loose_ends(components, shafts)
    T = _eliminate(components, shafts)
    given = [c.name for c in components if isinstance(c, SpeedSource)]
    free = [name for i, name in enumerate(shafts) if name not in given and np.any(T[:, i])]
    columns = [shafts.index(name) for name in free]
    return Shafts(tuple(shafts), tuple(free), tuple(given), T[:, columns], T[:, [shafts.index(g) for g in given]])


def _check_names(components: Sequence[Component]) -> None:
    for component in components:
        if not isinstance(component, Component):
            hint = ": write Drivetrain(*components)" if isinstance(component, list | tuple) else ""
            raise ArgumentError(f"{component!r} is no component of a drivetrain{hint}")
        if not (isinstance(component.name, str) and component.name) or component.name == GROUND:
            raise ArgumentError(f"{label(component)}: a name was expected that is not empty and not {GROUND}")
    twice = [name for name, count in Counter(c.name for c in components).items() if count > 1]
    if twice:
        both = " and ".join(type(c).__name__ for c in components if c.name == twice[0])
        raise ArgumentError(f"the name {twice[0]} is used twice ({both}): each component needs its own")


def _declared(components: Iterable[Component]) -> list[str]:
    """Shafts of inertias and prescribed speeds first to last, then those that only gears mention."""
    components = list(components)
    own = [c.name for c in components if isinstance(c, Inertia | VehicleLoad | SpeedSource)]
    geared = [name for c in components if isinstance(c, Gear | PlanetaryGear) for name in _shafts_of(c)]
    return list(dict.fromkeys(name for name in (*own, *geared) if name != GROUND))


def _shafts_of(component: Component) -> tuple[str, ...]:
    match component:
        case Gear(input=a, output=b) | SpringDamper(first=a, second=b):
            return (a, b)
        case PlanetaryGear():
            return (component.sun, component.carrier, component.ring)
        case Clutch() | OneWayClutch():
            return (component.driving, component.driven)
        case Brake() | TorqueSource() | Load() | EngineMap():
            return (component.shaft,)
        case Inertia() | VehicleLoad() | SpeedSource():
            return (component.name,)


def _check_shafts(component: Component, shafts: list[str]) -> None:
    named = _shafts_of(component)
    for name in named:
        if not isinstance(name, str):
            raise ArgumentError(f"{label(component)}: {name!r} is no shaft: the name of one was expected")
        if name != GROUND and name not in shafts:
            close = get_close_matches(name, shafts, 1)
            hint = f"did you mean {close[0]}?" if close else f"shafts are {', '.join(shafts) or 'none'}"
            raise ArgumentError(f"{label(component)}: there is no shaft {name}: {hint}")
    if len(set(named)) < len(named):
        raise ArgumentError(f"{label(component)} connects {named[0]} with itself: different shafts were expected")
    if set(named) == {GROUND}:
        raise ArgumentError(f"{label(component)} acts on the ground alone: a shaft was expected")


def _check_loose_ends(components: Sequence[Component], shafts: list[str]) -> None:
    """A shaft that one gear alone mentions turns freely: as a rule its name is misspelled."""
    uses = Counter(name for c in components for name in _shafts_of(c))
    for component in components:
        for name in _shafts_of(component):
            if isinstance(component, Gear | PlanetaryGear) and name != GROUND and uses[name] == 1:
                others = ", ".join(s for s in shafts if s != name)
                raise ArgumentError(
                    f"{label(component)}: shaft {name} has no inertia and leads nowhere else (other shafts: {others})"
                )


def _constraint(component: Component) -> dict[str, float]:
    """Coefficients of the speeds whose weighted sum is zero; empty if the component is no gear."""
    match component:
        case Gear():
            return {component.input: 1.0, component.output: -component.ratio}
        case PlanetaryGear(ratio=z):
            return {component.sun: 1.0, component.ring: z, component.carrier: -(1.0 + z)}
        case _:
            return {}


def _eliminate(components: Sequence[Component], shafts: list[str]) -> Matrix:
    """Speeds of all shafts in those that remain: columns of eliminated shafts are zero.

    Shafts without inertia go first, then those declared last.
    """
    heavy = [c.name for c in components if isinstance(c, Inertia | VehicleLoad)]
    given = {c.name for c in components if isinstance(c, SpeedSource)}
    order = [s for s in shafts if s not in heavy and s not in given] + heavy[::-1]
    T = np.eye(len(shafts))
    for component in components:
        row = np.zeros(len(shafts))
        for name, factor in _constraint(component).items():
            if name != GROUND:
                row[shafts.index(name)] = factor
        if np.any(row):
            T = _without(T, row @ T, [shafts.index(s) for s in order], np.abs(row).max(), component)
    return T


def _without(T: Matrix, row: Matrix, order: list[int], scale: float, component: Component) -> Matrix:
    """Eliminate one speed by the constraint ``row x = 0``."""
    row = np.where(np.abs(row) > _ZERO * scale, row, 0.0)
    pivot = next((j for j in order if row[j] != 0.0), None)
    if pivot is None:
        reason = "contradicts prescribed speeds" if np.any(row) else "repeats what other gears say already"
        raise ArgumentError(f"{label(component)} {reason}: leave it out or open the loop with a spring or a clutch")
    if np.count_nonzero(row) == 1:
        raise ArgumentError(
            f"{label(component)} leaves no motion to the shafts that it connects: gears hold them still"
        )
    reduced = T - np.outer(T[:, pivot], row / row[pivot])
    reduced[:, pivot] = 0.0
    return reduced
