"""Linear systems from other toolboxes and from models without logic.

Objects of scipy.signal and of python-control are recognised by their attributes, so that neither needs to be installed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.lti import Lti
from hysdel_py.systems.lti_checks import checked_sample_time
from hysdel_py.systems.lti_of_dha import lti_of_dha

__all__ = ["lti_of"]

_EXPECTED = "an Lti, a Model without logic, or a linear system of scipy.signal or python-control was expected"


def lti_of(system: Any, ts: float | None) -> Lti:
    """Take a system over from elsewhere; see :meth:`Lti.of`."""
    if isinstance(system, Lti):
        _agreed(system.ts, ts)
        return system
    dha = getattr(system, "dha", system)
    if isinstance(dha, Dha):
        return lti_of_dha(dha, _of_model(system, ts))
    return _of_toolbox(system, ts)


def _of_model(system: Any, ts: float | None) -> float:
    """The sample time of a model; a Dha alone does not know it."""
    own = getattr(system, "sample_time", None)
    if own is None:
        return 1.0 if ts is None else checked_sample_time(ts)
    return _agreed(own, ts)


def _of_toolbox(system: Any, ts: float | None) -> Lti:
    form = _proper(system)
    A, B, C, D = (np.asarray(getattr(form, key), dtype=float) for key in "ABCD")
    names: dict[str, Any] = {key: tuple(getattr(system, f"{word}_labels", ())) for key, word in _LABELS.items()}
    dt = _time_base(system)
    if dt is None:
        if ts is None:
            raise ArgumentError("ts is missing: the system is continuous, a sample time was expected")
        return Lti.sampled(A, B, C, D, ts=ts, **names)
    return Lti(A, B, C, D, ts=1.0 if dt is True and ts is None else _agreed(ts if dt is True else dt, ts), **names)


_LABELS = {"x": "state", "u": "input", "y": "output"}


def _proper(system: Any) -> Any:
    try:
        return _state_space(system)
    except ValueError as error:
        raise ArgumentError(
            f"the system has no state-space form ({error}): a numerator of no higher degree than the denominator was "
            "expected; add a fast pole"
        ) from None


def _state_space(system: Any) -> Any:
    """The system itself or its realisation, whatever has A, B, C and D."""
    if all(hasattr(system, key) for key in "ABCD"):
        return system
    if hasattr(system, "to_ss"):
        return system.to_ss()
    if hasattr(system, "num") and hasattr(system, "den"):
        return _realised(system)
    raise ArgumentError(f"system is a {type(system).__name__}: {_EXPECTED}")


def _realised(system: Any) -> Any:
    """State space of a transfer function whose polynomials lie in lists by output and input."""
    from scipy.signal import StateSpace, tf2ss

    if (getattr(system, "noutputs", 0), getattr(system, "ninputs", 0)) != (1, 1):
        raise ArgumentError(
            "system is a transfer function of several inputs or outputs, which has no unique state: give a state-space "
            "form of it (control.ss(system))"
        )
    return StateSpace(*tf2ss(np.atleast_1d(system.num[0][0]), np.atleast_1d(system.den[0][0])))


def _time_base(system: Any) -> Any:
    """None for a continuous system, True for a discrete one that does not say its sample time, else that time."""
    dt = getattr(system, "dt", None)
    if dt is None and hasattr(system, "state_labels"):
        raise ArgumentError("the system does not say whether it is continuous: dt=0 or its sample time was expected")
    if dt is None or dt is True:
        return dt
    return None if dt == 0 else float(dt)


def _agreed(own: float | None, ts: float | None) -> float:
    """The sample time of a discrete system."""
    if ts is not None and own is not None and not np.isclose(own, checked_sample_time(ts)):
        raise ArgumentError(f"ts is {ts:g}, but the system is sampled with {own:g}: leave ts out")
    return checked_sample_time(ts if own is None else own)
