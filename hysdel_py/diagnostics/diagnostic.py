"""One thing to say about a source text."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from hysdel_py.diagnostics.codes import Code
from hysdel_py.syntax.source import Span

__all__ = ["Diagnostic", "Fix", "Label", "Severity"]


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


class Fix(NamedTuple):
    """A replacement that would repair the source: the text of `span` becomes `replacement`.

    An empty span inserts, an empty replacement deletes.
    """

    span: Span
    replacement: str


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
    fixes : tuple of Fix
        Replacements that belong together and would repair it; empty if none is certain enough.
    """

    code: Code
    severity: Severity
    message: str
    span: Span | None = None
    help: str = ""
    labels: tuple[Label, ...] = ()
    fixes: tuple[Fix, ...] = ()
