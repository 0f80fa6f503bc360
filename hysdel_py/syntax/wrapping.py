"""Breaks one item into lines.

A line is filled as far as the width allows and broken at the place of lowest level in it, that is at the outermost
operator of lowest precedence. Each token is looked at a bounded number of times and nothing recurses, so length and
nesting do not matter.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from hysdel_py.syntax.dialect import Dialect
from hysdel_py.syntax.spacing import LAST_RESORT, Atom, atoms_of
from hysdel_py.syntax.tokens import TYPES, Token, TokenKind

__all__ = ["CHOICE_WIDTH", "WIDTH", "Piece", "wrap"]

WIDTH = 100
"""Columns of code; comments may go beyond."""

CHOICE_WIDTH = 80
"""Columns up to which IF, THEN and ELSE stay on one line."""

_FACTORS = frozenset("*/")
_STEP = 4
_NESTING_STEP, _MAX_NESTING = 2, 4
_MAX_BASE = 40  # continuation lines start no further right than this
_MAX_CLAUSE = 60  # nor do the branches of choices in choices


@dataclass(frozen=True, slots=True)
class Piece:
    """One line of code: where it starts, its text, and the comments behind it."""

    column: int
    text: str
    comments: tuple[Token, ...] = ()


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where lines continue inside one pair of choice braces, or in the item as a whole."""

    base: int
    base_depth: int
    clause: int
    depth: int

    def continued(self, column: int, depth: int) -> _Frame:
        """The frame with lines continuing at a column."""
        return replace(self, base=column, base_depth=depth)


def wrap(tokens: Sequence[Token], indent: int, dialect: Dialect = Dialect.HYSDEL_2) -> list[Piece]:
    """Lay out the tokens of one item whose first token stands at column `indent`."""
    return list(_Wrapper(_with_clauses_broken(atoms_of(tokens, dialect), indent), indent).pieces())


def _with_clauses_broken(atoms: list[Atom], indent: int) -> list[Atom]:
    """Force THEN and ELSE onto lines of their own in a choice that is long, broken anyway, or holds another one."""
    choices = sum(atom.token.text == "IF" for atom in atoms)
    code = atoms[: _code_end(atoms, 0, len(atoms))]
    on_one_line = not any(atom.forced for atom in code) and indent + sum(atom.width for atom in code) <= CHOICE_WIDTH
    if choices == 0 or (choices == 1 and on_one_line):
        return atoms
    return [replace(atom, forced=True) if atom.token.text in ("THEN", "ELSE") else atom for atom in atoms]


def _code_end(atoms: Sequence[Atom], start: int, end: int) -> int:
    """Index behind the last atom that is no comment."""
    while end > start and atoms[end - 1].token.is_comment:
        end -= 1
    return end


class _Wrapper:
    """Walks over the atoms once; knows the column where the present line starts."""

    def __init__(self, atoms: list[Atom], indent: int) -> None:
        self._atoms = atoms
        self._column = indent
        self._frames = [_Frame(indent + _STEP, 0, indent, 0)]

    def pieces(self) -> Iterator[Piece]:
        """The lines in order."""
        atoms = self._atoms
        breaks = [i for i, atom in enumerate(atoms) if atom.forced and i] + [len(atoms)]
        start = 0
        for stop in breaks:
            while start < stop:
                self._column = self._start_column(start)
                end = self._line_end(start, stop)
                yield self._piece(start, end)
                start = end

    def _start_column(self, start: int) -> int:
        if start == 0:
            return self._column
        frame, atom = self._frames[-1], self._atoms[start]
        if atom.token.text in ("THEN", "ELSE") and atom.forced:
            return frame.clause
        nesting = min(max(atom.depth - frame.base_depth, 0), _MAX_NESTING)
        inner = atom.token.text in _FACTORS  # a product goes on further right than the sum that holds it
        return frame.base + _NESTING_STEP * (nesting + inner)

    def _line_end(self, start: int, stop: int) -> int:
        """Index behind the line that begins at `start`; it ends at `stop` at the latest."""
        atoms = self._atoms
        code_end = _code_end(atoms, start, stop)
        room = WIDTH - self._column + atoms[start].space
        best: int | None = None
        best_level = LAST_RESORT + 1
        for index in range(start, code_end):
            level = atoms[index].level if index > start else None
            if level is not None and (level <= best_level or best is None):
                best, best_level = index, level
            room -= atoms[index].width
            if room < 0 and best is not None:
                return best
        return stop

    def _piece(self, start: int, end: int) -> Piece:
        """Text of a line; notes where the lines after it continue."""
        code_end = _code_end(self._atoms, start, end)
        parts: list[str] = []
        column = self._column
        for index in range(start, code_end):
            atom = self._atoms[index]
            if atom.space and index > start:
                parts.append(" ")
                column += 1
            parts.append(atom.token.text)
            self._note(index, column)
            column += len(atom.token.text)
        comments = tuple(atom.token for atom in self._atoms[code_end:end])
        return Piece(self._column, "".join(parts), comments)

    def _note(self, index: int, column: int) -> None:
        """Remember columns that later lines are aligned with."""
        atom, frames = self._atoms[index], self._frames
        text, behind = atom.token.text, column + len(atom.token.text) + 1
        if (index == 0 and text in TYPES) or (text == "=" and len(frames) == 1):
            frames[-1] = frames[-1].continued(_within(behind, frames[-1].clause), atom.depth)
        elif text == "IF":
            frames.append(_Frame(behind, atom.depth, min(column, _MAX_CLAUSE), atom.depth))
        elif text in ("THEN", "ELSE"):
            frames[-1] = frames[-1].continued(behind, atom.depth)
        elif atom.token.kind is TokenKind.CLOSE:
            while len(frames) > 1 and atom.depth < frames[-1].depth:
                frames.pop()


def _within(column: int, indent: int) -> int:
    return column if column <= max(_MAX_BASE, indent) else indent + _STEP
