"""The plant's side of a closed loop: how a plant makes a step, and the run as it grows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.ranges import onto_range
from hysdel_py.errors import ArgumentError, SimulationError
from hysdel_py.systems.signals import Kind, Type, Variable
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["RECORDED", "PlantStep", "Run", "as_plant"]

Matrix = NDArray[np.float64]
PlantStep = Callable[[Matrix, Matrix], tuple[Matrix, Matrix, Matrix, Matrix]]
Variables = dict[str, tuple[Variable, ...]]

RECORDED = ("cost", "bound", "gap", "nodes", "qps", "seconds", "status", "fallback")
"""What is recorded of every move, as columns of ``Trajectory.info``; the status as its code, the fallback as 0 or 1."""


def as_plant(plant: Any, controller: Any, tolerance: float) -> tuple[PlantStep, Variables]:
    """Return the step of a plant and the variables of its vectors, as far as plant or controller names them.

    A plan may lead a state onto the end of its range, and the solver's residual a little beyond it, where the model
    has no step: states of a modelled plant that leave their range by no more than `tolerance` are moved onto its end.

    Raises
    ------
    ArgumentError
        If the plant has no step and is not callable.
    """
    form = _with_step(plant)
    names = _variables(form) or _variables(_known_form(controller))
    if hasattr(form, "step"):
        return _kept_in_range(_four(form.step), names.get("x", ()), tolerance), names
    if not callable(form):
        raise ArgumentError(
            f"plant is a {type(plant).__name__}: a Model, Dha, Mld, an object with step(x, u), or a callable expected"
        )
    return _four(form), {key: names[key] for key in ("x", "u") if key in names}


def _known_form(controller: Any) -> Any:
    """What names the vectors of a controller, if anything does."""
    return next((getattr(controller, name) for name in ("mld", "lti", "signals") if hasattr(controller, name)), None)


def _with_step(plant: Any) -> Any:
    """The form of a compiled model that simulates it; any other plant as it is."""
    if hasattr(plant, "step"):
        return plant
    for form in ("dha", "mld"):
        if hasattr(getattr(plant, form, None), "step"):
            return getattr(plant, form)
    return plant


def _kept_in_range(step: PlantStep, variables: tuple[Variable, ...], tolerance: float) -> PlantStep:
    def kept(x: Matrix, u: Matrix) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        x1, y, d, z = step(x, u)
        return (onto_range(x1, variables, tolerance)[0] if len(variables) == len(x1) else x1), y, d, z

    return kept


def _variables(form: Any) -> Variables:
    groups = {key: getattr(form, key, None) for key in ("x", "u", "y", "d", "z")}
    return {
        key: group
        for key, group in groups.items()
        if isinstance(group, tuple) and all(isinstance(v, Variable) for v in group)
    }


def _four(step: Callable[[Matrix, Matrix], Any]) -> PlantStep:
    """Accept x1 alone as well as (x1, y, d, z)."""

    def complete(x: Matrix, u: Matrix) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        answer = step(x, u)
        if isinstance(answer, tuple) and len(answer) == 4:
            x1, y, d, z = (_vector(part) for part in answer)
        else:
            x1, y, d, z = _vector(answer), np.zeros(0), np.zeros(0), np.zeros(0)
        if x1.shape != x.shape or not np.isfinite(x1).all():
            raise ArgumentError(f"the plant returned the state {x1}: {len(x)} finite numbers were expected")
        return x1, y, d, z

    return complete


def _vector(part: ArrayLike) -> Matrix:
    try:
        return np.atleast_1d(np.array(part, dtype=float))
    except (TypeError, ValueError):
        raise ArgumentError(f"the plant returned {part!r}: x1 or (x1, y, d, z) was expected") from None


@dataclass(slots=True)
class Run:
    """A run as it grows; the one mutable thing of a closed loop."""

    first: Matrix
    x: list[Matrix] = field(default_factory=list)
    u: list[Matrix] = field(default_factory=list)
    rest: list[tuple[Matrix, Matrix, Matrix]] = field(default_factory=list)
    records: list[tuple[float, ...]] = field(default_factory=list)
    messages: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.x.append(self.first)

    def advance(self, k: int, step: PlantStep, u: Matrix, record: tuple[float, ...]) -> bool:
        """Make one step of the plant; False, with a message, when the plant has none."""
        try:
            x1, y, d, z = step(self.x[-1], u)
        except SimulationError as error:
            self.messages.append(f"step {k}: stopped, the plant has no step here: {error}")
            return False
        self.x.append(x1)
        self.u.append(u)
        self.rest.append((y, d, z))
        self.records.append(record)
        return True

    def interrupt(self) -> None:
        """Keep the steps that are whole, and say that there might have been more."""
        whole = min(len(self.x) - 1, len(self.u), len(self.rest), len(self.records))
        for rows, count in ((self.x, whole + 1), (self.u, whole), (self.rest, whole), (self.records, whole)):
            del rows[count:]
        self.messages.append(f"step {whole}: interrupted")

    def trajectory(self, names: Variables, sample_time: float = 1.0) -> Trajectory:
        """Return the steps so far."""
        y, d, z = ([entry[i] for entry in self.rest] for i in range(3))
        rows = {"x": self.x, "u": self.u, "y": y, "d": d, "z": z}
        tables = {key: _table(entries, len(names.get(key, ()))) for key, entries in rows.items()}
        variables = {key: _named(names.get(key, ()), key, table.shape[1]) for key, table in tables.items()}
        info = dict(zip(RECORDED, _table(self.records, len(RECORDED)).T, strict=True))
        t = np.arange(len(self.x), dtype=np.float64) * float(sample_time)
        return Trajectory(t, **tables, variables=variables, messages=tuple(self.messages), info=info)


def _table(rows: list[Any], columns: int) -> Matrix:
    return np.array(rows, dtype=float) if rows else np.zeros((0, columns))


def _named(variables: tuple[Variable, ...], key: str, size: int) -> tuple[Variable, ...]:
    """The variables of a vector; numbered ones where nothing names them."""
    if len(variables) == size:
        return variables
    return tuple(Variable(f"{key}{i + 1}", Type.REAL, Kind(key)) for i in range(size))
