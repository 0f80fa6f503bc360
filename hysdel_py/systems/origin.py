"""Where an item of a model comes from in its source."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Origin", "RowOrigin"]


@dataclass(frozen=True, slots=True)
class RowOrigin:
    """Where a row of the MLD form comes from.

    Attributes
    ----------
    item : str
        Kind of item: ``AD``, ``DA``, ``Linear``, ``Logic``, ``Cont_must``, ``Logic_must``, ``Continuous``,
        ``Automata``, ``Cont_output`` or ``Logic_output``, or ``""`` for a variable that nothing defines.
    section : str
        Section of the source item that caused the row.
    defines : str
        Name of the variable that the row helps to define, empty for a requirement.
    depends : tuple of str
        Names of the variables that appear in the source item.
    group, subgroup, subindex : int
        Number of the item in the file; 1 for the item itself and 2, 3, ... for what it generated; number within.
    line : int
        Line of the item's first token.
    text : str
        The item on one line.
    """

    item: str
    section: str
    defines: str
    depends: tuple[str, ...]
    group: int
    subgroup: int
    subindex: int
    line: int
    text: str

    def __str__(self) -> str:
        return f"line {self.line}: {self.text}" if self.line else self.text or self.item


@dataclass(frozen=True, slots=True)
class Origin:
    """The source item behind an item of a Dha.

    `subgroup` is 1 for the item itself, 2 and more for what it generated; `start` and `end` are offsets in the source.
    """

    section: str = ""
    group: int = 0
    subgroup: int = 1
    line: int = 0
    depends: tuple[str, ...] = ()
    text: str = ""
    start: int = 0
    end: int = 0

    def row(self, item: str, defines: str, subindex: int) -> RowOrigin:
        """Origin of the `subindex`-th row that this item becomes."""
        return RowOrigin(
            item, self.section, defines, self.depends, self.group, self.subgroup, subindex, self.line, self.text
        )

    def __str__(self) -> str:
        return f"line {self.line}: {self.text}" if self.line else self.text
