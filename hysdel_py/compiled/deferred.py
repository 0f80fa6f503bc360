"""Kernels that Python calls get machine code; kernels that other kernels call become a part of theirs.

By itself numba optimises every function and makes machine code of it, a wrapper for Python and one for C, together with
all that it calls. In a search whose calls are ten deep the innermost steps would be optimised ten times, nine of them
for code that nobody calls. Here a kernel that a kernel calls is typed and lowered and then waits; what Python calls is
optimised with all that waits below it, once, and is what the cache on disk keeps.

Rests on numba's passes and code libraries, which are documented for those who extend it but not fixed;
:mod:`hysdel_py.compiled.decorators` does without this module where they are missing.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, _LowerResult
from numba.core.compiler_machinery import register_pass
from numba.core.environment import lookup_environment
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import NativeLowering
from numba.core.types import unliteral

from hysdel_py.compiled.caching import cached
from hysdel_py.compiled.listening import compiling

__all__ = ["Kernel"]

SELDOM = (100_000, 50, 100)
"""Thresholds of the garbage collection while something is compiled."""


class _Waiting(JITCodeLibrary):
    """Code of a kernel and of what it calls, neither optimised as a whole nor made into machine code."""

    def _optimize_final_module(self) -> None:
        """Whoever links this optimises it."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class _LowerInside(NativeLowering):
    """Lower a kernel to code that waits for its callers."""

    _name = "lower_inside"

    def run_pass(self, state: Any) -> bool:
        """Lower; the code is known by a key, where else it is by the function that Python would call."""
        flags = state.flags
        flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
        state.library = _Waiting(state.targetctx.codegen(), state.func_id.func_qualname)
        super().run_pass(state)
        lowered, key = state["cr"], object()
        state.targetctx.insert_user_function(key, lowered.fndesc, [state.library])
        state["cr"] = _LowerResult(lowered.fndesc, lowered.call_helper, cfunc=key, env=lowered.env)
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class _LowerEntry(NativeLowering):
    """Lower a kernel that Python calls."""

    _name = "lower_entry"

    def run_pass(self, state: Any) -> bool:
        """Lower as usual, and set the environments of the kernels inside, which nobody has set yet."""
        state.flags.no_cfunc_wrapper = True
        super().run_pass(state)
        library = state.library
        for variable in library._final_module.global_variables:
            environment = lookup_environment(variable.name)
            if environment is not None:
                library.codegen.set_env(variable.name, environment)
        return True


class _Pipeline(Compiler):
    """The passes of numba with another lowering."""

    lowering: type = NativeLowering

    def define_pipelines(self) -> list[Any]:
        pipelines: list[Any] = super().define_pipelines()
        for pipeline in pipelines:
            pipeline.passes = [(self.lowering if p is NativeLowering else p, why) for p, why in pipeline.passes]
            pipeline.finalize()
        return pipelines


class _Inside(_Pipeline):
    lowering = _LowerInside


class _Entry(_Pipeline):
    lowering = _LowerEntry

    def compile_extra(self, func: Any) -> Any:
        """Compile this kernel and all below it."""
        compiling()
        with _seldom_collecting():
            return super().compile_extra(func)


@contextmanager
def _seldom_collecting() -> Iterator[None]:
    """Few searches for circles of garbage: numba makes millions of objects and drops few, and each search sees all."""
    before = gc.get_threshold()
    gc.set_threshold(*SELDOM)
    try:
        yield
    finally:
        gc.set_threshold(*before)


class Kernel(CPUDispatcher):
    """A kernel as other kernels see it; a call from Python goes to the machine code of :attr:`entry`.

    Parameters
    ----------
    function : callable
    **options
        Of ``numba.njit``.
    """

    def __init__(self, function: Callable[..., Any], **options: Any) -> None:
        super().__init__(function, targetoptions={"nopython": True, **options}, pipeline_class=_Inside)
        self._options = options

    def __reduce__(self) -> Any:
        """By name, as any function; one inside another function as numba does it, which is enough for its cache."""
        name = self.py_func.__qualname__
        return super().__reduce__() if "<locals>" in name else name

    def add_overload(self, cres: Any) -> None:
        """Remember code for some types of arguments; Python cannot call it."""
        self.overloads[tuple(cres.signature.args)] = cres

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Types without values: the same code serves a call with a constant and one with a variable."""
        return super().get_call_template([unliteral(arg) for arg in args], kws)

    @cached_property
    def entry(self) -> Any:
        """The kernel for calls from Python, kept on disk where there is a place."""
        return cached(self.py_func, pipeline_class=_Entry, **self._options)

    def __call__(self, *arguments: Any) -> Any:
        """Run the machine code."""
        return self.entry(*arguments)
