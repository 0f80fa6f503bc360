"""One thing to say about a source text."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from hysdel_py.diagnostics.codes import Code
from hysdel_py.syntax.source import Span

__all__ = ["Diagnostic", "Label", "Severity"]


class Severity(Enum):
    """How bad it is; only an error stops the compilation."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class Label:
    """A second place that explains the first, such as the earlier declaration."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """What is wrong, where, and what to do about it.

    Attributes
    ----------
    code : Code
    severity : Severity
    message : str
        One sentence: what was expected and what was found.
    span : Span or None
        Where; None if it is about the file as a whole.
    help : str
        What to do, empty if there is no advice.
    labels : tuple of Label
    """

    code: Code
    severity: Severity
    message: str
    span: Span | None = None
    help: str = ""
    labels: tuple[Label, ...] = ()
