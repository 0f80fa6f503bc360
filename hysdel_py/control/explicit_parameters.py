"""The parameters of an explicit hybrid law: measured state, input applied last, references."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.hybrid_mpc import HybridMpc
from hysdel_py.control.law_signals import check_distinct
from hysdel_py.control.ranges import onto_range
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Variable

__all__ = ["LAST", "REFERENCE", "Parameter", "Parameters", "choose_parameters"]

Vector = NDArray[np.float64]

STATE, LAST, REFERENCE = "x", "last", "ref"


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter.

    Attributes
    ----------
    name : str
        That of a state as it is, ``NAME(-1)`` for an input applied last, ``r(NAME)`` for a reference.
    group : str
        ``"x"``, ``"last"`` or ``"ref"``.
    signal : str
    low, high : float
        Its box; both ends are its value if it is fixed.
    is_bool : bool
    is_fixed : bool
    """

    name: str
    group: str
    signal: str
    low: float
    high: float
    is_bool: bool
    is_fixed: bool

    @property
    def value(self) -> float:
        """Its value if it is fixed."""
        return self.low


@dataclass(frozen=True, slots=True)
class Parameters:
    """All parameters of a controller, in the order states, last inputs, references.

    Attributes
    ----------
    every : tuple of Parameter
    """

    every: tuple[Parameter, ...]

    @property
    def free(self) -> tuple[Parameter, ...]:
        """Those that are not fixed: the entries of zeta."""
        return tuple(parameter for parameter in self.every if not parameter.is_fixed)

    @property
    def real(self) -> tuple[Parameter, ...]:
        """The free ones that are real: the parameters of the regions."""
        return tuple(parameter for parameter in self.free if not parameter.is_bool)

    @property
    def boolean(self) -> tuple[Parameter, ...]:
        """The free ones that are Boolean: their values select among the sequences."""
        return tuple(parameter for parameter in self.free if parameter.is_bool)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the entries of zeta."""
        return tuple(parameter.name for parameter in self.free)

    def group(self, group: str) -> tuple[Parameter, ...]:
        """Parameters of one kind."""
        return tuple(parameter for parameter in self.every if parameter.group == group)

    def point(self, zeta: ArrayLike | Mapping[str, float]) -> Vector:
        """Check a value of zeta, given in order or by name.

        Raises
        ------
        ArgumentError
            A missing or unknown name, a wrong number of entries, an entry that is not finite.
        """
        names = self.names
        if isinstance(zeta, Mapping):
            given = {_resolved(name, self.every): value for name, value in zeta.items()}
            strange = [name for name in given if name not in names]
            missing = [name for name in names if name not in given]
            if strange or missing:
                what = f"{', '.join(strange)} is fixed" if strange else f"{', '.join(missing)} is missing"
                raise ArgumentError(f"zeta: {what}; {', '.join(names)} were expected")
            zeta = [given[name] for name in names]
        try:
            point = np.asarray(zeta, dtype=float)
        except (TypeError, ValueError):
            raise ArgumentError(f"zeta is {zeta!r}: {len(names)} numbers were expected, {', '.join(names)}") from None
        if point.shape != (len(names),):
            raise ArgumentError(f"zeta has shape {point.shape}: {(len(names),)} was expected, {', '.join(names)}")
        if not np.isfinite(point).all():
            raise ArgumentError(f"{names[int(np.argmin(np.isfinite(point)))]} is not a finite number")
        return point

    def gathered(self, x: Vector, last: Vector | None, references: Mapping[str, float], tolerance: float) -> Vector:
        """Zeta of a measured state, the input applied last and the references; values near an end are moved onto it.

        Raises
        ------
        ArgumentError
            A fixed parameter is given another value.
        """
        columns = {STATE: iter(x), LAST: iter(() if last is None else last)}
        entries = [
            references.get(parameter.signal, 0.0) if parameter.group == REFERENCE else next(columns[parameter.group])
            for parameter in self.every
        ]
        ends = tuple(_as_variable(parameter) for parameter in self.every)
        values, _ = onto_range(np.array(entries, dtype=float), ends, tolerance)
        for parameter, value in zip(self.every, values.tolist(), strict=True):
            if parameter.is_fixed and value != parameter.value:
                raise ArgumentError(
                    f"{parameter.name} is {value:g}: the law was made for the fixed value {parameter.value:g}"
                )
        return np.array([v for v, parameter in zip(values, self.every, strict=True) if not parameter.is_fixed])


def choose_parameters(mpc: HybridMpc, box: Mapping[str, Any] | None, fixed: Mapping[str, float] | None) -> Parameters:
    """The parameters of a controller with their box.

    Parameters
    ----------
    mpc : HybridMpc
    box : mapping of name to (low, high)
        States and last inputs without a box have their declared range, and a box is cut to it. A reference needs one
        unless it is fixed; a reference that the controller does not demand is 0 without either.
    fixed : mapping of name to number

    Raises
    ------
    ArgumentError
        An unknown or doubtful name, a parameter without a bounded box, values that a variable cannot have.
    """
    candidates = tuple(_candidates(mpc))
    check_distinct(tuple(candidate.name for candidate in candidates))
    boxes = _by_name(box, candidates, "box")
    values = _by_name(fixed, candidates, "fixed")
    twice = [name for name in boxes if name in values]
    if twice:
        raise ArgumentError(f"{', '.join(twice)} has a box and is fixed: one of them was expected")
    chosen = [_chosen(candidate, boxes, values, mpc.references.required) for candidate in candidates]
    parameters = Parameters(tuple(chosen))
    if not parameters.real:
        raise ArgumentError("every real parameter is fixed: ask the controller itself, or leave one a box")
    return parameters


def _candidates(mpc: HybridMpc) -> Iterable[Parameter]:
    for v in mpc.mld.x:
        yield _of_variable(v, STATE, v.name)
    if mpc.uses_last_input:
        for v in mpc.mld.u:
            yield _of_variable(v, LAST, f"{v.name}(-1)")
    for name in mpc.references.names:
        yield Parameter(f"r({name})", REFERENCE, name, -inf, inf, False, False)


def _of_variable(v: Variable, group: str, name: str) -> Parameter:
    low, high = (max(0.0, v.low), min(1.0, v.high)) if v.is_bool else (v.low, v.high)
    return Parameter(name, group, v.name, float(low), float(high), v.is_bool, False)


def _by_name(given: Mapping[str, Any] | None, candidates: tuple[Parameter, ...], what: str) -> dict[str, Any]:
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise ArgumentError(f"{what} is {given!r}: a mapping of names of parameters was expected")
    found: dict[str, Any] = {}
    for name, value in given.items():
        full = _resolved(name, candidates)
        if full in found:
            raise ArgumentError(f"{what}: {full} is given twice")
        found[full] = value
    return found


def _resolved(name: str, candidates: tuple[Parameter, ...]) -> str:
    """Full name of a parameter; the name of a signal will do where only one parameter has it."""
    names = [candidate.name for candidate in candidates]
    if name in names:
        return name
    alike = [candidate.name for candidate in candidates if candidate.signal == name]
    if len(alike) == 1:
        return alike[0]
    if alike:
        raise ArgumentError(f"{name} may be {' or '.join(alike)}: the full name was expected")
    raise ArgumentError(f"{name} is no parameter of the controller: {', '.join(names)} were expected")


def _chosen(candidate: Parameter, boxes: dict[str, Any], values: dict[str, Any], required: bool) -> Parameter:
    name = candidate.name
    if name in values:
        return _fixed(candidate, _number(values[name], f"fixed {name}"))
    if name in boxes:
        return _boxed(candidate, boxes[name])
    if candidate.group == REFERENCE and not required:
        return _fixed(candidate, 0.0)
    if not np.isfinite([candidate.low, candidate.high]).all():
        raise ArgumentError(f"{name} has no bounded range: give it a box, as in box={{{name!r}: (0, 1)}}, or fix it")
    return _fixed(candidate, candidate.low) if candidate.low == candidate.high else candidate


def _fixed(candidate: Parameter, value: float) -> Parameter:
    if not candidate.low <= value <= candidate.high or (candidate.is_bool and value not in (0.0, 1.0)):
        raise ArgumentError(f"fixed {candidate.name} is {value:g}: {_allowed(candidate)} was expected")
    return _with(candidate, value, value, fixed=True)


def _boxed(candidate: Parameter, ends: Any) -> Parameter:
    what = f"box of {candidate.name}"
    try:
        low, high = ends
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {ends!r}: a pair (low, high) was expected") from None
    low, high = max(_number(low, what), candidate.low), min(_number(high, what), candidate.high)
    if low > high:
        raise ArgumentError(f"{what} is {ends!r}: low <= high and {_allowed(candidate)} were expected")
    if not np.isfinite([low, high]).all():
        raise ArgumentError(f"{what} is {ends!r}: two finite ends were expected")
    if low == high:
        return _fixed(candidate, low)
    if candidate.is_bool and (low, high) != (0.0, 1.0):
        raise ArgumentError(f"{what} is {ends!r}: a Boolean has both values, or is fixed to one of them")
    return _with(candidate, low, high, fixed=False)


def _with(candidate: Parameter, low: float, high: float, *, fixed: bool) -> Parameter:
    return Parameter(
        candidate.name, candidate.group, candidate.signal, float(low), float(high), candidate.is_bool, fixed
    )  # fmt: skip


def _allowed(candidate: Parameter) -> str:
    return "0 or 1" if candidate.is_bool else f"a number in [{candidate.low:g}, {candidate.high:g}]"


def _number(value: Any, what: str) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ArgumentError(f"{what} is {value!r}: a number was expected") from None
    if np.isnan(number):
        raise ArgumentError(f"{what} is NaN: a number was expected")
    return number


def _as_variable(parameter: Parameter) -> Variable:
    from hysdel_py.systems.signals import Kind, Type

    kind = Type.BOOL if parameter.is_bool else Type.REAL
    return Variable(parameter.name, kind, Kind.STATE, parameter.low, parameter.high)
