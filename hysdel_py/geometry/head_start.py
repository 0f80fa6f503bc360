"""Which kernels solve small linear programs: plain Python has a head start, for compiled code takes long to load.

Loading numba and what it needs to run the first kernel takes as long as plain Python takes for some hundred small
programs, and the commands that read one small model ask for fewer. Both give the same numbers.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np

from hysdel_py.compiled import kernels_are_compiled, kernels_wait

__all__ = ["HeadStart", "loops_are_fast", "programs"]

_ENTRIES = 10_000
"""Plain Python takes 2 to 60 microseconds for each, most with 20 variables: at most the time to load numba is lost."""


class HeadStart:
    """What plain Python may still do before compiled code is loaded.

    Parameters
    ----------
    entries : int
        Of matrices, summed over the programs; it is over once a program asks for more, or once numba is loaded.
    """

    def __init__(self, entries: int) -> None:
        self._left = entries

    def lasts(self, entries: int = 0) -> bool:
        """Whether it goes on with programs of so many entries, which are then counted."""
        self._left = -1 if "numba" in sys.modules else max(-1, self._left - entries)
        return self._left >= 0


def programs(entries: int) -> Any:
    """The kernels for linear programs with so many entries in all."""
    return _plain() if _head_start().lasts(entries) else _compiled()


def loops_are_fast() -> bool:
    """Whether the next program meets compiled loops, or so few have been asked that plain ones do."""
    return _head_start().lasts() or kernels_are_compiled()


@cache
def _head_start() -> HeadStart:
    return HeadStart(_ENTRIES if kernels_wait() else -1)


@cache
def _plain() -> Any:
    return _quiet(import_module("hysdel_py.geometry.interpreted.programs"))


@cache
def _compiled() -> Any:
    from hysdel_py.geometry.kernels import programs as kernels

    return kernels if kernels_are_compiled() else _quiet(kernels)


def _quiet(module: ModuleType) -> SimpleNamespace:
    """Plain kernels that say no more than compiled ones do of what overflows."""
    kernels = {name: _quietly(getattr(module, name)) for name in ("maximised", "screened")}
    return SimpleNamespace(**kernels, OPTIMAL=module.OPTIMAL, INFEASIBLE=module.INFEASIBLE)


def _quietly(kernel: Callable[..., Any]) -> Callable[..., Any]:
    def call(*arguments: Any) -> Any:
        with np.errstate(all="ignore"):  # one for each call: before numpy 2 it is not to be shared among threads
            return kernel(*arguments)

    return call
