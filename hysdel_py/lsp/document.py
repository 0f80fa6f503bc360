"""A text with all that is known about it; the functions beside this module answer questions about it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from hysdel_py import compiler
from hysdel_py.diagnostics.diagnostic import Diagnostic
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.elaboration.elaborate import Instance, elaborate
from hysdel_py.errors import CompileError
from hysdel_py.lowering.big_m import BigM
from hysdel_py.lowering.constants import Constants
from hysdel_py.lsp.outline import Outline, outline_of
from hysdel_py.lsp.positions import Positions
from hysdel_py.semantics.declarations import declare
from hysdel_py.semantics.parameters import missing_parameters
from hysdel_py.semantics.symbols import Symbol
from hysdel_py.semantics.typed_model import TypedModel
from hysdel_py.syntax.keywords import keywords_of
from hysdel_py.syntax.parser import parse
from hysdel_py.syntax.source import Source
from hysdel_py.syntax.tokens import Token, TokenKind, tokenize
from hysdel_py.systems.mld import Mld

__all__ = ["LONGEST_LOWERED", "Document"]

LONGEST_LOWERED = 100_000
"""Longer texts are checked without lowering, which would take too long while somebody types."""


@dataclass(frozen=True, slots=True)
class _Analysis:
    """How far the compiler came."""

    diagnostics: tuple[Diagnostic, ...]
    model: TypedModel | None
    values: Mapping[str, float]
    mld: Mld | None


@dataclass(frozen=True)
class Document:
    """An open text; everything is found out when first asked for.

    Attributes
    ----------
    text : str
    name : str
        Name of the file.
    folder : Path or None
        Where it lies, and so the files of its modules; None for a text that is no file.
    """

    text: str
    name: str = "model.hys"
    folder: Path | None = None

    @cached_property
    def source(self) -> Source:
        """The text as the compiler knows it."""
        return Source(self.name, self.text)

    @cached_property
    def positions(self) -> Positions:
        """Positions as editors count them."""
        return Positions(self.text)

    @cached_property
    def keywords(self) -> frozenset[str]:
        """Words that cannot be names here."""
        return keywords_of(self.text)

    @cached_property
    def tokens(self) -> tuple[Token, ...]:
        """Tokens without comments."""
        return tuple(token for token in tokenize(self.text, self.keywords) if not token.is_comment)

    @cached_property
    def outline(self) -> Outline:
        """Sections and declarations."""
        return outline_of(self.tokens, len(self.text))

    @cached_property
    def _analysis(self) -> _Analysis:
        try:
            # A line end makes sure that this is taken for a text and not for the name of a file.
            folders = () if self.folder is None else (self.folder,)
            model, values, found = compiler.analyse(self.text + "\n", {}, folders)
        except CompileError as error:
            return _Analysis(self._here(error.diagnostics, error.source), None, {}, None)
        found = self._here(found, model.source)
        if missing_parameters(model, values) or len(self.text) > LONGEST_LOWERED:
            return _Analysis(found, model, values, None)
        try:
            dha, more = compiler.lower_to_dha(model, values, Constants.AFFINE)
            mld, most = compiler.lower_to_mld(model, dha, BigM.INTERVAL)
        except CompileError as error:
            return _Analysis((*found, *self._here(error.diagnostics, model.source)), model, values, None)
        return _Analysis((*found, *self._here((*more, *most), model.source)), model, values, mld)

    def _here(self, found: Sequence[Diagnostic], source: Source) -> tuple[Diagnostic, ...]:
        """Diagnostics with places in this text; one about the file of a module has none and names the file."""
        return tuple(self._placed(diagnostic, source) for diagnostic in found)

    def _placed(self, found: Diagnostic, source: Source) -> Diagnostic:
        labels = tuple(label for label in found.labels if label.span.start <= len(self.text))
        if found.span is None or found.span.start <= len(self.text):
            return replace(found, labels=labels)
        home, span = source.home(found.span)
        return replace(found, span=None, labels=labels, message=f"{home.name}:{home.line_of(span)}: {found.message}")

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """All that the compiler has to say, once each."""
        return tuple(dict.fromkeys(self._analysis.diagnostics))

    @property
    def model(self) -> TypedModel | None:
        """The typed model, None for a wrong text."""
        return self._analysis.model

    @property
    def values(self) -> Mapping[str, float]:
        """Values of the parameters as far as they are known."""
        return self._analysis.values

    @property
    def mld(self) -> Mld | None:
        """The MLD form, None where a mistake or a missing value is in the way."""
        return self._analysis.mld

    @cached_property
    def symbols(self) -> Mapping[str, Symbol]:
        """Declared names, also of a text with wrong items; none of a text that cannot be parsed."""
        if self.model is not None:
            return {symbol.name: symbol for symbol in self.model.symbols}
        sink = Sink()
        system = parse(self.source, sink)
        if system is None:
            return {}
        scalar, _ = elaborate((Instance("", system),), {}, sink)
        return declare(scalar, self.source, sink)

    def name_at(self, offset: int) -> Token | None:
        """The name that an offset is in or directly behind."""
        return next((t for t in self.tokens if t.start <= offset <= t.end and t.kind is TokenKind.NAME), None)
