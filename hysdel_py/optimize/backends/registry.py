"""Back ends by name; each package is imported when its back end is first asked for."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.backends.protocol import QpBackend
from hysdel_py.optimize.qp import QpSettings

__all__ = ["BACKENDS", "get_backend"]

BACKENDS = ("piqp", "osqp")


def get_backend(name: str, settings: QpSettings | None = None) -> QpBackend:
    """Look a back end up.

    Parameters
    ----------
    name : {"piqp", "osqp"}
    settings : QpSettings, optional

    Raises
    ------
    ArgumentError
        Unknown name, or the package of the back end is not installed.
    """
    if name not in BACKENDS:
        raise ArgumentError(f"there is no QP back end {name!r}: known are {', '.join(BACKENDS)}")
    try:
        import_module(name)
    except ImportError as error:
        raise ArgumentError(f"the QP back end {name} needs its package: pip install {name} ({error})") from None
    module = import_module(f"hysdel_py.optimize.backends.{name}")
    make: Callable[[QpSettings], QpBackend] = module.backend
    return make(settings or QpSettings())
