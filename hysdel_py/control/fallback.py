"""What a controller does when it has no plan: softened limits, the rest of the last plan, or what the caller says."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.formulation import Formulation
from hysdel_py.control.move import Move, MoveStatus
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Variable, as_vector, range_violations

__all__ = [
    "Fallback", "Reserve", "broken_input_limits", "check_fallback", "from_callable", "from_reserve", "from_softened",
]  # fmt: skip

Matrix = NDArray[np.float64]
Fallback: TypeAlias = Literal["soft", "last_plan"] | Callable[[Matrix, Move], ArrayLike] | None


@dataclass(frozen=True, slots=True, eq=False)
class Reserve:
    """The inputs of the last plan and how many of them are used up."""

    u: Matrix
    used: int = 1


def check_fallback(fallback: Any, limits: Any) -> Fallback:
    """Return a fallback that can be done with the limits of a hybrid or of a linear controller.

    Raises
    ------
    ArgumentError
        Something else, or ``"soft"`` without a limit that could be softened.
    """
    if not (fallback is None or callable(fallback) or fallback in ("soft", "last_plan")):
        raise ArgumentError(f'fallback is {fallback!r}: "soft", "last_plan", a callable or None was expected')
    if fallback == "soft" and not (limits.x or limits.y or not isinstance(limits.terminal, dict) or limits.terminal):
        raise ArgumentError('fallback is "soft", but no limit of a state or output is given that could be softened')
    checked: Fallback = fallback
    return checked


def from_softened(failed: Move, softened: Move) -> Move:
    """Take the move of the controller with softened limits."""
    if not softened.ok:
        return _none(failed, f"the fallback with softened limits found none either ({softened.message})")
    broken = ", ".join(f"{name} by {value:.4g}" for name, value in softened.slack.items() if value > 0)
    detail = f"softened limits, exceeded: {broken or 'none'}"
    return replace(
        softened, status=MoveStatus.FALLBACK, fallback="soft", cause=failed.status,
        message=_words("soft", detail, failed), nodes=failed.nodes + softened.nodes, qps=failed.qps + softened.qps,
    )  # fmt: skip


def from_reserve(failed: Move, reserve: Reserve | None, broken_limits: Callable[[Matrix], list[str]]) -> Move:
    """Take the next input of the last plan, if there is one that keeps the limits of the inputs.

    Parameters
    ----------
    failed : Move
    reserve : Reserve or None
    broken_limits : callable
        The limits of inputs and increments that an input breaks now, in words.
    """
    if reserve is None or reserve.used >= len(reserve.u):
        return _none(failed, "the fallback has no input of an earlier plan left")
    u = reserve.u[reserve.used].copy()
    broken = broken_limits(u)
    if broken:
        return _none(failed, f"the input of the last plan breaks the limits now: {', '.join(broken)}")
    return _with_input(failed, u, "last_plan", f"input {reserve.used} of the last plan")


def from_callable(
    failed: Move, choose: Callable[[Matrix, Move], ArrayLike], x: Matrix, variables: Sequence[Variable]
) -> Move:
    """Take the input that a function of the measured state and the failed move returns.

    Raises
    ------
    ArgumentError
        If it is not an input of the model within its declared ranges.
    """
    u = as_vector(choose(x, failed), variables, "input of the fallback")
    outside = range_violations(u, variables, "input of the fallback", 0.0)
    if outside:
        raise ArgumentError("; ".join(outside))
    return _with_input(failed, u, "callable", "the input that the given function chose")


def broken_input_limits(formulation: Formulation, last_input: Matrix | None, tolerance: float, u: Matrix) -> list[str]:
    """Limits of inputs and increments of a hybrid controller that an input breaks now."""
    start = formulation.layout.start("u", 0)
    names = [v.name for v in formulation.layout.mld.u]
    low, high = (end[start : start + len(u)] for end in (formulation.lb, formulation.ub))
    broken = [name for name, value, a, b in zip(names, u, low, high, strict=True) if not a <= value <= b]
    for band in formulation.limits.bands:
        if band.group == "du" and last_input is not None:
            step = u[band.column] - last_input[band.column]
            least, most = band.at(0)
            if not least - tolerance <= step <= most + tolerance:
                broken.append(f"increment of {band.name}")
    return broken


def _with_input(failed: Move, u: Matrix, name: str, detail: str) -> Move:
    return replace(
        failed, status=MoveStatus.FALLBACK, u=u, cost=inf, gap=inf, fallback=name, cause=failed.status,
        message=_words(name, detail, failed),
    )  # fmt: skip


def _words(name: str, detail: str, failed: Move) -> str:
    return f"fallback {name}: {detail}; there was no plan: {failed.message}"


def _none(failed: Move, reason: str) -> Move:
    return replace(failed, message=f"{failed.message}; {reason}")
