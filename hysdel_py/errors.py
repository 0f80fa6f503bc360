"""Every exception that this package raises on purpose.

Mistakes in a model are diagnostics and arrive together in one :class:`CompileError`; wrong arguments are
:class:`ArgumentError`; a step that the model does not define is a :class:`SimulationError`. Trouble inside a solver
is never an exception: it is a status of the result.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hysdel_py.diagnostics.diagnostic import Diagnostic
    from hysdel_py.syntax.source import Source
    from hysdel_py.systems.trajectory import Trajectory

__all__ = ["ArgumentError", "CompileError", "HysdelError", "Interrupted", "SimulationError"]


class HysdelError(Exception):
    """Base of all errors raised by this package."""


class ArgumentError(HysdelError, ValueError):
    """An argument has the wrong shape, name or value; the message says which and what was expected."""


class SimulationError(HysdelError):
    """A model has no step, or no unique step, at the given state and input.

    Attributes
    ----------
    problems : tuple of str
        One line for each thing that went wrong, in the words of the source file.
    """

    def __init__(self, problems: tuple[str, ...]) -> None:
        super().__init__("\n".join(problems))
        self.problems = problems


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run; carries what was computed by then.

    It is no HysdelError, so that a script ends on Ctrl-C as any other does.

    Attributes
    ----------
    partial : Trajectory
        The steps that were made; its last message says that the run was interrupted.
    """

    def __init__(self, partial: Trajectory) -> None:
        super().__init__(f"interrupted after {partial.steps} steps")
        self.partial = partial


class CompileError(HysdelError):
    """A source text is not a model; carries every diagnostic that was found.

    Attributes
    ----------
    diagnostics : tuple of Diagnostic
        Errors first to last in the order of the source, with any warnings among them.
    data : tuple of dict
        The same as plain data, with file, line and column.
    source : Source
        The text that the diagnostics are about, that of its modules included.
    """

    def __init__(
        self, diagnostics: tuple[Diagnostic, ...], rendered: str, data: tuple[dict[str, Any], ...], source: Source
    ) -> None:
        super().__init__(rendered)
        self.diagnostics = diagnostics
        self.data = data
        self.source = source
