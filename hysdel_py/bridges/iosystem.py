"""Our systems and controllers as input-output systems of python-control."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError, HysdelError, SimulationError
from hysdel_py.export.identifiers import identifiers
from hysdel_py.systems.lti import Lti
from hysdel_py.systems.signals import Variable

__all__ = ["to_iosystem"]

Vector = NDArray[np.float64]
_EXPECTED = "a Model, Dha, Mld, Pwa, Lti, controller or explicit law was expected"


def to_iosystem(
    system: Any,
    *,
    name: str | None = None,
    sample_time: float | None = None,
    ref: Mapping[str, float] | None = None,
    references: Sequence[str] = (),
) -> Any:
    """A system or controller as a discrete system of python-control (which has to be installed).

    Parameters
    ----------
    system : Model, Dha, Mld, Pwa, Lti, HybridMpc, LinearMpc, ExplicitLaw or HybridLaw
        A system has its own inputs, states and outputs; its states are the outputs where it has none. A controller has
        the states as inputs and the inputs of the plant as outputs; where it weighs or limits increments its own states
        are the inputs applied last.
    name : str, optional
        Of the system; that of the model by default.
    sample_time : float, optional
        That of the system by default.
    ref : mapping of name to number, optional
        Constant references of a controller.
    references : sequence of str
        Signals whose references become further inputs, called ``r_NAME``.

    Returns
    -------
    control.NonlinearIOSystem, or control.StateSpace for a linear system without constant terms
        Names that python-control would misread, such as ``t1.level`` and ``W(2,1)``, get underscores.

    Raises
    ------
    ArgumentError
        Something else.
    HysdelError
        python-control is not installed.

    Notes
    -----
    Booleans are numbers there: what is above one half counts as 1. Ranges and MUST are not checked. A controller
    without a plan, and a model without a step, raise SimulationError.
    """
    control = _control()
    if hasattr(system, "solve"):
        answer = _answer(system, ref, tuple(references))
        return _controller(control, system, answer, name=name or "controller", sample_time=sample_time)
    if ref is not None or references:
        raise ArgumentError("ref and references belong to a controller: leave them out")
    if isinstance(system, Lti) and system.is_homogeneous:
        return _linear(control, system, name, sample_time)
    return _plant(control, system, name, sample_time)


def _control() -> Any:
    control: Any = None
    with suppress(ModuleNotFoundError):
        control = import_module("control")
    if not hasattr(control, "NonlinearIOSystem"):  # a mere folder of that name can be imported, too
        raise HysdelError("python-control is not installed: pip install control")
    return control


def _names(*groups: Sequence[Variable]) -> tuple[list[str], ...]:
    """Labels that python-control takes; a name in two groups has the same one."""
    written = identifiers(dict.fromkeys(v.name for group in groups for v in group))
    return tuple([written[v.name] for v in group] for group in groups)


def _linear(control: Any, lti: Lti, name: str | None, sample_time: float | None) -> Any:
    x, u, y = _names(lti.x, lti.u, lti.y)
    dt = _dt(lti, lti.ts if sample_time is None else sample_time)
    label = _identifier(name or lti.name or "lti")
    return control.ss(lti.A, lti.B, lti.C, lti.D, dt, states=x, inputs=u, outputs=y, name=label)


def _plant(control: Any, system: Any, name: str | None, sample_time: float | None) -> Any:
    form = getattr(system, "dha", system)
    if not all(hasattr(form, part) for part in ("step", "x", "u", "y")):
        raise ArgumentError(f"system is a {type(system).__name__}: {_EXPECTED}")
    x, u, y = _names(form.x, form.u, form.y or form.x)

    def step(state: Vector, control_input: Vector) -> tuple[Any, ...]:
        answer: tuple[Any, ...] = form.step(_rounded(state, form.x), _rounded(control_input, form.u), check=False)
        return answer

    return control.NonlinearIOSystem(
        lambda _t, state, u, _params: step(state, u)[0],
        lambda _t, state, u, _params: step(state, u)[1] if form.y else state,
        inputs=u, outputs=y, states=x, dt=_dt(system, sample_time), name=_identifier(name or form.name or "plant"),
    )  # fmt: skip


def _rounded(values: Vector, variables: Sequence[Variable]) -> Vector:
    """Booleans as 0 or 1, whatever arithmetic has made of them."""
    bits = np.array([v.is_bool for v in variables], dtype=bool)
    plain = np.atleast_1d(np.asarray(values, dtype=float))[: len(bits)]
    return np.where(bits, plain > 0.5, plain).astype(float)


def _dt(system: Any, sample_time: float | None) -> float:
    own: Any = getattr(system, "sample_time", 1.0) if sample_time is None else sample_time
    is_number = isinstance(own, Real)
    if not (is_number and 0.0 < own < float("inf")):
        raise ArgumentError(f"sample_time is {own!r}: a positive number was expected")
    return float(own)


def _identifier(name: str) -> str:
    return identifiers([name])[name]


@dataclass(frozen=True, slots=True)
class _Answer:
    """The input of the plant for the inputs of a controller: states, then references."""

    controller: Any
    signals: Any
    ref: Mapping[str, float]
    references: tuple[str, ...]
    previous: bool

    def __call__(self, last: Vector, given: Vector) -> Vector:
        values, count = np.atleast_1d(np.asarray(given, dtype=float)), len(self.signals.x)
        wanted = {**self.ref, **dict(zip(self.references, values[count:].tolist(), strict=True))}
        more = {"last_input": _rounded(last, self.signals.u)} if self.previous else {}
        move = self.controller.solve(_rounded(values[:count], self.signals.x), wanted or None, **more)
        if move.u is None:
            raise SimulationError((f"the controller has no input: {move.message}",))
        return np.asarray(move.u, dtype=float)


def _answer(controller: Any, ref: Mapping[str, float] | None, references: tuple[str, ...]) -> _Answer:
    previous = bool(getattr(controller, "uses_last_input", False))
    return _Answer(controller, _signals(controller), dict(ref or {}), references, previous)


def _controller(control: Any, controller: Any, answer: _Answer, *, name: str, sample_time: float | None) -> Any:
    x, u = _names(answer.signals.x, answer.signals.u)

    def given(_t: float, last: Vector, values: Vector, _params: Any) -> Vector:
        return answer(last, values)

    return control.NonlinearIOSystem(
        given if answer.previous else None, given,
        inputs=[*x, *(_identifier(f"r_{signal}") for signal in answer.references)], outputs=u,
        states=[f"{label}_last" for label in u] if answer.previous else 0, dt=_dt(controller, sample_time),
        name=_identifier(name),
    )  # fmt: skip


def _signals(controller: Any) -> Any:
    """What names the states and inputs of a controller."""
    places = [controller, *(getattr(controller, part, None) for part in ("mld", "lti", "signals"))]
    found = next((one for one in places if isinstance(getattr(one, "x", None), tuple)), None)
    if found is None:
        raise ArgumentError(f"the {type(controller).__name__} does not name its states and inputs: {_EXPECTED}")
    return found
