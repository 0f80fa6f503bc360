"""Collects diagnostics, so that one run reports all that is wrong."""

from __future__ import annotations

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic, Label, Severity
from hysdel_py.diagnostics.render import as_data, render
from hysdel_py.errors import CompileError
from hysdel_py.syntax.source import Source, Span

__all__ = ["Sink"]


class Sink:
    """Where every stage of the compiler reports; nothing is printed and nothing is thrown until asked for."""

    def __init__(self) -> None:
        self._found: dict[Diagnostic, None] = {}

    def error(
        self, code: Code, message: str, span: Span | None = None, *, help: str = "", labels: tuple[Label, ...] = ()
    ) -> None:
        """Report a mistake that makes the source unusable."""
        self._found[Diagnostic(code, Severity.ERROR, message, span, help, labels)] = None

    def warning(
        self, code: Code, message: str, span: Span | None = None, *, help: str = "", labels: tuple[Label, ...] = ()
    ) -> None:
        """Report something that is probably not meant."""
        self._found[Diagnostic(code, Severity.WARNING, message, span, help, labels)] = None

    def note(self, code: Code, message: str, span: Span | None = None) -> None:
        """Report something that is worth knowing and harmless."""
        self._found[Diagnostic(code, Severity.NOTE, message, span)] = None

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """All that was reported, once each, in the order of the source."""
        return tuple(sorted(self._found, key=lambda d: d.span.start if d.span else -1))

    @property
    def failed(self) -> bool:
        """Whether there is an error."""
        return any(d.severity is Severity.ERROR for d in self._found)

    def raise_errors(self, source: Source) -> None:
        """Raise everything so far as one CompileError if there is an error among it."""
        if self.failed:
            shown = tuple(d for d in self.diagnostics if d.severity is not Severity.NOTE)
            rendered = "\n".join(render(d, source) for d in shown)
            raise CompileError(shown, rendered, tuple(as_data(d, source) for d in shown))
