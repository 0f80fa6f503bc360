"""Checks of a controller's arguments, and the solver of its program."""

from __future__ import annotations

from collections.abc import Mapping
from operator import index
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.formulation import Formulation
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.pwa import Pwa
from hysdel_py.systems.signals import as_vector

if TYPE_CHECKING:
    from hysdel_py.optimize.milp import MilpSolver
    from hysdel_py.optimize.miqp import MiqpSettings, MiqpSolver

    Solver: TypeAlias = MilpSolver | MiqpSolver

__all__ = [
    "checked",
    "checked_callable",
    "checked_horizon",
    "checked_last_input",
    "make_solver",
    "mld_of",
    "search_settings",
]

T = TypeVar("T")

MAX_VARIABLES = 20_000
"""Largest program that is assembled; the search would not finish long before this size."""


def mld_of(model: Any) -> Mld:
    """Return the MLD form of a model, or the form itself."""
    mld = getattr(model, "mld", model)
    if not isinstance(mld, Mld):
        hint = "; hys.to_mld(pwa) makes an Mld of a piecewise affine form" if isinstance(model, Pwa) else ""
        raise ArgumentError(f"model is a {type(model).__name__}: a Model or an Mld was expected{hint}")
    return mld


def checked_horizon(horizon: int, mld: Mld) -> int:
    """Return the horizon as an int that is at least 1 and not far too large."""
    try:
        steps = 0 if isinstance(horizon, bool) else index(horizon)
    except TypeError:
        steps = 0
    if steps < 1:
        raise ArgumentError(f"horizon is {horizon!r}: a whole number of at least 1 was expected")
    size = steps * (mld.nx + mld.nu + mld.nd + mld.nz)
    if size > MAX_VARIABLES:
        raise ArgumentError(
            f"horizon is {steps}: the program would have {size} variables, at most {MAX_VARIABLES} are accepted"
        )
    return steps


def checked(value: Any, kind: type[T], what: str) -> T:
    """Return a value of the expected class."""
    if not isinstance(value, kind):
        raise ArgumentError(f"{what} is a {type(value).__name__}: a {kind.__name__} was expected")
    return value


def checked_last_input(given: Any, mld: Mld, *, needed: bool) -> NDArray[np.float64] | None:
    """Return the input applied last as a vector; None where nothing asks for it and nothing is given."""
    if given is not None:
        return as_vector(given, mld.u, "last input")
    if needed:
        names = ", ".join(v.name for v in mld.u)
        raise ArgumentError(
            f"last_input is missing: increments are weighed or limited, so the input applied last ({names}) counts"
        )
    return None


def checked_callable(value: Any, what: str) -> Any:
    """Return a callable or None."""
    if value is not None and not callable(value):
        raise ArgumentError(f"{what} is a {type(value).__name__}: a callable was expected")
    return value


def search_settings(
    backend: str, limits: Mapping[str, float | None], gap_rel: float, gap_abs: float, feasibility: float
) -> MiqpSettings:
    """Settings of the search; limits that are None keep their defaults."""
    from hysdel_py.optimize.miqp import MiqpSettings

    given: dict[str, Any] = {name: value for name, value in limits.items() if value is not None}
    return MiqpSettings(backend=backend, gap_rel=gap_rel, gap_abs=gap_abs, feasibility=feasibility, **given)


def make_solver(formulation: Formulation, settings: MiqpSettings) -> Solver:
    """Branch and bound for a cost of squares, HiGHS for one of absolute values."""
    from hysdel_py.optimize.backends.registry import get_backend
    from hysdel_py.optimize.milp import MilpSolver
    from hysdel_py.optimize.miqp import Miqp, MiqpSolver
    from hysdel_py.optimize.qp import Qp

    get_backend(settings.solver, settings.qp)
    f = formulation
    rows = f.low - f.shift.c, f.high - f.shift.c
    qp = Qp(P=f.objective.P, q=np.zeros(f.layout.n), A=f.A, l=rows[0], u=rows[1], lb=f.lb, ub=f.ub)
    miqp = Miqp(qp, f.binaries, priorities=f.stages, drivers=f.drivers)
    return MilpSolver(miqp, settings) if f.norm.is_linear else MiqpSolver(miqp, settings)
