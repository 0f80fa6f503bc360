"""Equations of motion of a drivetrain: matrices, friction laws and inputs.

    M u' = f(t) - D u - B k e - drag + maps + W lambda
    e'   = B'u + e0(t)
    gamma = W'u + gamma0(t),   -lambda in [lower, upper] R F_N mu(gamma), at an end of it while gamma != 0

with the speeds u of independent shafts, twists e of the springs, and slips gamma of the contacts. ``-lambda`` is the
torque that a contact transmits from its first shaft to its second. The speeds of all shafts are ``T u + P s(t)``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.drivetrain.checks import check_columns, check_directions, check_mass
from hysdel_py.drivetrain.kernels.arrays import Inputs, Plant
from hysdel_py.drivetrain.kernels.rows import rows_of
from hysdel_py.drivetrain.laws import Coulomb, FrictionLaw, as_law
from hysdel_py.drivetrain.signals import Function, PiecewiseLinear, Signal, SignalLike, as_signal, sample
from hysdel_py.drivetrain.structure import Multiplier, delassus_of, inverse_of, multiplier
from hysdel_py.errors import ArgumentError

__all__ = ["Equations", "Gains", "Maps", "Names", "equations_from_matrices", "no_maps"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Names:
    """Names of the columns of a run, each a tuple of str: independent shafts, all shafts, springs, contacts."""

    coordinates: tuple[str, ...]
    shafts: tuple[str, ...]
    springs: tuple[str, ...]
    contacts: tuple[str, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Gains:
    """How the values s and slopes s' of the signals enter, one column for each signal.

    Attributes
    ----------
    force : array of shape (n, ns)
        Generalised force per value.
    force_rate : array of shape (n, ns)
        Generalised force per slope: prescribed speeds accelerate what is geared to them.
    pressure : array of shape (nc, ns)
        Capacity of each contact per value and unit of friction coefficient.
    twist, slip : arrays of shape (m, ns), (nc, ns)
    throttle : array of shape (nm, ns)
    shaft : array of shape (N, ns)
        P, the part of prescribed speeds in the speeds of all shafts.
    """

    force: Matrix
    force_rate: Matrix
    pressure: Matrix
    twist: Matrix
    slip: Matrix
    throttle: Matrix
    shaft: Matrix


@dataclass(frozen=True, eq=False, slots=True)
class Maps:
    """Engine maps, padded to one size: ``torque[i, a, b]`` at ``throttle[i, a]`` and ``speed[i, b]``."""

    directions: Matrix
    speed: Matrix
    throttle: Matrix
    torque: NDArray[np.float64]
    sizes: NDArray[np.int64]


def no_maps(n: int) -> Maps:
    """No engine map."""
    return Maps(np.zeros((n, 0)), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros((0, 2, 2)), np.zeros((0, 2), np.int64))


@dataclass(frozen=True, eq=False)
class Equations:
    """Equations of motion; see the module for their form.

    Attributes
    ----------
    M, D : arrays of shape (n, n)
        Mass matrix and damping.
    B : array of shape (n, m)
        Directions of the springs.
    k : array of shape (m,)
        Stiffness.
    W : array of shape (n, nc)
        Directions of the contacts.
    drag_directions : array of shape (n, nq)
    drag : array of shape (nq,)
        A shaft of speed v takes the torque ``-drag v |v|``.
    maps : Maps
    T : array of shape (N, n)
        Speeds of all shafts per independent speed.
    laws : tuple of FrictionLaw
    side : array of shape (nc, 2)
        Lower and upper limit of the transmitted torque as a share of the capacity.
    signals : tuple of Signal
    signal_names : tuple of str
    gains : Gains
    names : Names
    """

    M: Matrix
    D: Matrix
    B: Matrix
    k: Matrix
    W: Matrix
    drag_directions: Matrix
    drag: Matrix
    maps: Maps
    T: Matrix
    laws: tuple[FrictionLaw, ...]
    side: Matrix
    signals: tuple[Signal, ...]
    signal_names: tuple[str, ...]
    gains: Gains
    names: Names

    def __post_init__(self) -> None:
        for name in ("M", "D", "B", "k", "W", "drag_directions", "drag", "T", "side"):
            getattr(self, name).setflags(write=False)

    @property
    def G(self) -> Matrix:
        """``W' M^-1 W``: slip acceleration per contact torque."""
        G = self.plant.G.view()
        G.setflags(write=False)
        return G

    @property
    def mobility(self) -> Matrix:
        """Diagonal of G, shape (nc,): what a unit of torque does to the slip of its own contact."""
        return np.diag(self.plant.G)

    @property
    def linear(self) -> bool:
        """Whether the equations between two events are linear with constant coefficients."""
        return self.drag.size == 0 and len(self.maps.sizes) == 0 and not any(law.parameters[2] for law in self.laws)

    @cached_property
    def plant(self) -> Plant:
        """The constant arrays, as the kernels take them; they are read only by agreement."""
        laws = np.array([law.parameters for law in self.laws], dtype=float).reshape(len(self.laws), 4)
        Minv = inverse_of(self.M)
        across = multiplier(self.W)
        G = across(across(Minv).T)
        side = np.ascontiguousarray(np.column_stack([-self.side[:, 1], -self.side[:, 0]]))  # of lambda, not -lambda
        arrays = (
            self.M, Minv, self.D, self.B, self.k, self.W, 0.5 * (G + G.T), laws, side, self.drag_directions,
            self.drag, self.maps.directions, self.maps.speed, self.maps.throttle, self.maps.torque,
        )  # fmt: skip
        constant = [
            np.array(a, dtype=float, order="C") for a in arrays
        ]  # copies: kernels are compiled for writable ones
        return Plant(  # type: ignore[call-arg]
            *constant,  # type: ignore[arg-type]
            np.array(self.maps.sizes),
            rows_of(self.D),
            rows_of(self.B.T),
            delassus_of(self.M, self.W),
        )

    def inputs(self, t: Matrix) -> Inputs:
        """What the signals contribute at given times, arrays of shape ``t.shape + (size,)``."""
        values = sample(self.signals, t)
        slopes = np.zeros_like(values)
        for i in np.flatnonzero(self._needs_slope):
            slopes[..., i] = np.vectorize(self.signals[i].slope, otypes=[float])(t)  # type: ignore[union-attr]
        return self.inputs_of(values, slopes)

    def inputs_of(self, values: Matrix, slopes: Matrix) -> Inputs:
        """The same from values and slopes of the signals."""
        g = self._gain
        return Inputs(*(np.ascontiguousarray(part) for part in (
            g["force"](values) + g["force_rate"](slopes),
            np.maximum(g["pressure"](values), 0.0),
            g["twist"](values),
            g["slip"](values),
            g["slip"](slopes),
            g["throttle"](values),
        )))  # fmt: skip

    @cached_property
    def _gain(self) -> dict[str, Multiplier]:
        return {name: multiplier(getattr(self.gains, name).T) for name in Gains.__slots__}

    @cached_property
    def has_functions(self) -> bool:
        """Whether an input is a function of time."""
        return any(isinstance(signal, Function) for signal in self.signals)

    @cached_property
    def _needs_slope(self) -> NDArray[np.bool_]:
        used: NDArray[np.bool_] = np.any(self.gains.shaft != 0, axis=0)
        return used

    @property
    def has_function_pressure(self) -> NDArray[np.bool_]:
        """Contacts whose normal force is a function of time."""
        functions = np.array([isinstance(signal, Function) for signal in self.signals], dtype=bool)
        found: NDArray[np.bool_] = np.any(self.gains.pressure[:, functions] != 0, axis=1)
        return found

    def shaft_speeds(self, t: Matrix, u: Matrix) -> Matrix:
        """Speeds of all shafts, one row per time."""
        return multiplier(self.T.T)(u) + self._gain["shaft"](sample(self.signals, t))

    def piecewise_linear(self) -> tuple[PiecewiseLinear, ...]:
        """The signals, all of them piecewise linear.

        Raises
        ------
        ArgumentError
            One of them is a function.
        """
        found = []
        for name, signal in zip(self.signal_names, self.signals, strict=True):
            if isinstance(signal, Function):
                raise ArgumentError(f"{name} is a function of time: a constant or piecewise linear signal is needed")
            found.append(signal)
        return tuple(found)


def equations_from_matrices(
    M: ArrayLike,
    W: ArrayLike,
    capacity: Sequence[SignalLike],
    *,
    force: Sequence[SignalLike] | None = None,
    D: ArrayLike | None = None,
    B: ArrayLike | None = None,
    k: ArrayLike | None = None,
    friction: Sequence[FrictionLaw | float] | None = None,
    coordinates: Sequence[str] | None = None,
    contacts: Sequence[str] | None = None,
    springs: Sequence[str] | None = None,
) -> Equations:
    """Equations of motion from a plain set of matrices; see :meth:`Drivetrain.from_matrices`."""
    M = _matrix(M, "M")
    n = len(M)
    W = _matrix(W, "W", (n, None))
    D = np.zeros((n, n)) if D is None else _matrix(D, "D", (n, n))
    B = np.zeros((n, 0)) if B is None else _matrix(B, "B", (n, None))
    stiffness = np.zeros(0) if k is None else _numbers(k, "k")
    if stiffness.shape != (B.shape[1],) or not np.all((stiffness >= 0) & np.isfinite(stiffness)):
        raise ArgumentError(f"k has shape {stiffness.shape}: {B.shape[1]} numbers of zero or more were expected")
    count = W.shape[1]
    given_laws = [Coulomb()] * count if friction is None else np.atleast_1d(np.array(friction, dtype=object))
    laws = tuple(as_law(law, f"friction {i}") for i, law in enumerate(given_laws))
    forces = [0.0] * n if force is None else list(force)
    for given, size, what in ((capacity, count, "capacity"), (forces, n, "force"), (laws, count, "friction")):
        if not isinstance(given, Sequence | np.ndarray) or len(given) != size:
            has = f"has {len(given)} entries" if hasattr(given, "__len__") else f"is {given!r}"
            raise ArgumentError(f"{what} {has}: a sequence of {size} was expected")
    names = Names(
        _names(coordinates, n, "w"), _names(coordinates, n, "w"), _names(springs, B.shape[1], "twist"),
        _names(contacts, count, "contact"),
    )  # fmt: skip
    signals = [as_signal(s, f"force on {name}") for s, name in zip(forces, names.coordinates, strict=True)]
    signals += [as_signal(s, f"capacity of {name}") for s, name in zip(capacity, names.contacts, strict=True)]
    ns, m = n + count, B.shape[1]
    gains = Gains(
        np.eye(n, ns), np.zeros((n, ns)), np.eye(count, ns, n), np.zeros((m, ns)), np.zeros((count, ns)),
        np.zeros((0, ns)), np.zeros((n, ns)),
    )  # fmt: skip
    side = np.tile([-1.0, 1.0], (count, 1))
    signal_names = tuple(f"force on {c}" for c in names.coordinates) + tuple(f"force of {c}" for c in names.contacts)
    check_mass(M, names.coordinates)
    check_columns(names.shafts, names.springs, names.contacts, signal_names)
    check_directions(W, names.contacts)
    return Equations(
        M, D, B, stiffness, W, np.zeros((n, 0)), np.zeros(0), no_maps(n), np.eye(n), laws, side, tuple(signals),
        signal_names, gains, names,
    )  # fmt: skip


def _matrix(given: ArrayLike, what: str, shape: tuple[int, int | None] | None = None) -> Matrix:
    matrix = _numbers(given, what)
    rows, columns = shape or (len(matrix), len(matrix))
    if matrix.ndim != 2 or matrix.shape[0] != rows or (columns is not None and matrix.shape[1] != columns):
        wanted = f"({rows}, {'any' if columns is None else columns})"
        raise ArgumentError(f"{what} has shape {matrix.shape}: {wanted} was expected")
    if not np.all(np.isfinite(matrix)):
        raise ArgumentError(f"{what} has entries that are not finite")
    return matrix


def _numbers(given: ArrayLike, what: str) -> Matrix:
    try:
        return np.array(given, dtype=float, ndmin=1)
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {given!r}: numbers were expected") from None


def _names(given: Sequence[str] | None, size: int, stem: str) -> tuple[str, ...]:
    names = tuple(f"{stem}{i + 1}" for i in range(size)) if given is None else tuple(given)
    if len(names) != size or len(set(names)) < size:
        raise ArgumentError(f"names {names}: {size} different ones were expected")
    return names
