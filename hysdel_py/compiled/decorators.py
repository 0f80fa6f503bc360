"""Numerical kernels: compiled by numba where it is installed (extra `fast`), plain Python where it is not.

A kernel is a function over arrays and numbers whose text is valid both ways. Compiled code is cached beside the source,
or where ``NUMBA_CACHE_DIR`` says; without a writable place it is compiled anew in each process.
``NUMBA_DISABLE_JIT=1`` runs the plain functions although numba is there. Modules of kernels that are loaded once more,
through a package called ``interpreted``, stay plain.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

from hysdel_py.compiled.caching import cached

__all__ = ["compiled", "either", "kernels_are_compiled", "kernels_wait", "leaf", "reordered"]

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """The function, compiled at its first call where numba is installed."""
    return _compile(function, _nrt=True)  # said, for otherwise it is inherited from a leaf that calls


def leaf(function: F) -> F:
    """The same for a kernel that makes no arrays and is handed none by those that it calls: it need not count users."""
    return _compile(function, _nrt=False)


def reordered(function: F) -> F:
    """A leaf with sums whose terms may be added in any order, which lets several be added at once."""
    return _compile(function, _nrt=False, fastmath={"reassoc", "contract"})


def _compile(function: F, **options: Any) -> F:
    if _stays_plain(function):
        return function
    numba = _numba()
    if numba is None:
        return function
    _forget_stale_code(Path(function.__code__.co_filename).parent)
    # Division by zero gives infinity, as it does for numpy's numbers in plain Python; checks for it cost time.
    options["error_model"] = "numpy"
    if numba.config.DISABLE_JIT:
        return function
    return _kernel()(function, **options)  # type: ignore[no-any-return]


@cache
def _kernel() -> Callable[..., Any]:
    """How a kernel is made: for calls from kernels and from Python apart, or by numba alone where that fails."""
    try:
        from hysdel_py.compiled.deferred import Kernel
    except ImportError:
        return cached
    return Kernel


def either(loops: F, arrays: F, kernel: Callable[[F], F] = compiled) -> F:
    """The compiled loops, or where nothing is compiled the same step as whole-array operations.

    For the innermost steps only: loops over elements are what a compiler likes and what plain Python is slow at.
    """
    return kernel(loops) if _stays_plain(loops) or kernels_are_compiled() else arrays


def _stays_plain(function: Callable[..., Any]) -> bool:
    """Whether the module of a kernel is the plain one of two that are made of the same file."""
    return "interpreted" in function.__module__.split(".")


def kernels_are_compiled() -> bool:
    """Whether kernels run as compiled code in this process."""
    numba = _numba()
    return numba is not None and not numba.config.DISABLE_JIT


def kernels_wait() -> bool:
    """Whether kernels would run as compiled code of which nothing has been loaded; told without loading it."""
    is_wanted = os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0")
    return is_wanted and "numba" not in sys.modules and find_spec("numba") is not None


@cache
def _numba() -> Any:
    try:
        import numba
    except ImportError:
        return None
    return numba


@cache
def _forget_stale_code(folder: Path) -> None:
    """Remove cached code that is older than any source beside it: the cache looks at a function's own file only."""
    sources = [Path(__file__), Path(__file__).with_name("deferred.py"), *folder.glob("*.py")]
    newest = max(source.stat().st_mtime for source in sources)
    for index in (folder / "__pycache__").glob("*.nbi"):
        with suppress(OSError):
            if index.stat().st_mtime < newest:
                index.unlink()
