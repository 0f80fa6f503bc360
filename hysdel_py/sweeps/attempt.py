"""One task, run where a worker runs it: what it raises becomes a record there, and never has to be sent as it is."""

from __future__ import annotations

import json
import traceback
from collections.abc import Callable
from time import perf_counter
from typing import Any

from hysdel_py.errors import ArgumentError
from hysdel_py.sweeps.record import Seed, SweepRecord

__all__ = ["attempt", "failed", "plain"]


def attempt(task: Callable[[Any], Any], seed: Seed, is_kept: bool) -> SweepRecord:
    """Call a task; `is_kept` makes plain data of what it returns, as a file would."""
    started = perf_counter()
    try:
        value = task(seed)
        if is_kept:
            value = plain(value)
    except (Exception, SystemExit) as error:  # a task that exits ends itself, not the sweep
        return failed(seed, error, perf_counter() - started)
    return SweepRecord(seed, value, seconds=perf_counter() - started)


def failed(seed: Seed, error: BaseException, seconds: float = 0.0) -> SweepRecord:
    """The record of an exception."""
    trace = "".join(traceback.format_exception(error))
    return SweepRecord(seed, None, f"{type(error).__name__}: {error}", trace, seconds)


def plain(value: Any) -> Any:
    """Numbers, texts, lists and mappings as they come back from JSON; arrays become lists.

    Raises
    ------
    ArgumentError
        Something else is among them, or two keys of a mapping have the same text.
    """
    try:
        return json.loads(json.dumps(value, default=_of_array), object_pairs_hook=_mapping)
    except ArgumentError:
        raise
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"the result of the task cannot be kept in a file: {error}") from None


def _mapping(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Keys become texts in a file; 1 and "1" would be one."""
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ArgumentError(f"the task returned a mapping with two keys of the same text, among {', '.join(found)}")
    return found


def _of_array(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return value.tolist()
    raise ArgumentError(
        f"a task whose results are kept in a file returned a {type(value).__name__}; "
        "return numbers, texts, arrays, lists or mappings of these"
    )
