"""Collects diagnostics, so that one run reports all that is wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic, Fix, Label, Severity
from hysdel_py.diagnostics.render import as_data, render
from hysdel_py.errors import CompileError
from hysdel_py.syntax.source import Source, Span

__all__ = ["Sink"]


class Sink:
    """Where every stage of the compiler reports; nothing is printed and nothing is thrown until asked for."""

    def __init__(self) -> None:
        self._found: dict[Diagnostic, None] = {}

    def error(
        self,
        code: Code,
        message: str,
        span: Span | None = None,
        *,
        help: str = "",
        labels: tuple[Label, ...] = (),
        fixes: tuple[tuple[Span, str], ...] = (),
    ) -> None:
        """Report a mistake that makes the source unusable."""
        self._add(Diagnostic(code, Severity.ERROR, message, span, help, labels, _fixes(fixes)))

    def warning(
        self,
        code: Code,
        message: str,
        span: Span | None = None,
        *,
        help: str = "",
        labels: tuple[Label, ...] = (),
        fixes: tuple[tuple[Span, str], ...] = (),
    ) -> None:
        """Report something that is probably not meant."""
        self._add(Diagnostic(code, Severity.WARNING, message, span, help, labels, _fixes(fixes)))

    def note(
        self,
        code: Code,
        message: str,
        span: Span | None = None,
        *,
        help: str = "",
        labels: tuple[Label, ...] = (),
    ) -> None:
        """Report something that is worth knowing and harmless."""
        self._add(Diagnostic(code, Severity.NOTE, message, span, help, labels))

    def _add(self, diagnostic: Diagnostic) -> None:
        self._found[diagnostic] = None

    def include(self, found: Iterable[Diagnostic]) -> None:
        """Take over what was reported elsewhere."""
        for diagnostic in found:
            self._add(diagnostic)

    def forget(self, unwanted: Callable[[Diagnostic], bool]) -> None:
        """Drop what an earlier mistake alone has caused."""
        self._found = {found: None for found in self._found if not unwanted(found)}

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """All that was reported, once each, in the order of the source."""
        return tuple(sorted(self._found, key=lambda d: d.span.start if d.span else -1))

    @property
    def error_count(self) -> int:
        """Number of errors so far."""
        return sum(d.severity is Severity.ERROR for d in self._found)

    @property
    def failed(self) -> bool:
        """Whether there is an error."""
        return self.error_count > 0

    def raise_errors(self, source: Source) -> None:
        """Raise everything so far as one CompileError if there is an error among it."""
        if self.failed:
            shown = tuple(d for d in self.diagnostics if d.severity is not Severity.NOTE)
            rendered = "\n".join(render(d, source) for d in shown)
            raise CompileError(shown, rendered, tuple(as_data(d, source) for d in shown), source)


def _fixes(pairs: tuple[tuple[Span, str], ...]) -> tuple[Fix, ...]:
    return tuple(Fix(*pair) for pair in pairs)
