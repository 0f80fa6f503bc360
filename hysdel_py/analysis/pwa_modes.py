"""The modes of a Dha within a limit of number and time, for their verification."""

from __future__ import annotations

from dataclasses import replace

from hysdel_py.analysis.clock import Clock
from hysdel_py.analysis.verify_pwa import MOST_MODES
from hysdel_py.systems.dha import Dha
from hysdel_py.systems.pwa import Pwa

__all__ = ["modes_within"]


class _OutOfTimeError(Exception):
    """Ends a search for modes; never leaves this module."""


def modes_within(dha: Dha, clock: Clock) -> Pwa:
    """The modes of a Dha; not complete where there are more than are verified, or the time is over."""
    from hysdel_py.lowering.modes import dha_to_pwa

    def watch(modes: int, waiting: int, programs: int) -> None:  # noqa: ARG001
        if not clock.allowance():
            raise _OutOfTimeError

    try:
        return dha_to_pwa(dha, max_modes=MOST_MODES, progress=watch)
    except _OutOfTimeError:
        return replace(dha_to_pwa(dha, max_modes=0), is_complete=False)
