"""What a search did, node by node."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from hysdel_py.optimize.mixed_integer import SearchInfo

__all__ = ["NodeLog"]

_OF_SEARCH = ("nodes", "qps", "open", "objective", "bound", "seconds")
_OF_NODE = ("number", "parent", "variable", "value", "bound")
_COLUMNS = (*_OF_SEARCH, *_OF_NODE[:-1], "node_bound", "fate")


@dataclass(slots=True)
class NodeLog:
    """A progress callback that keeps what it is told.

    Attributes
    ----------
    entries : list of SearchInfo
        One per node, over all searches since the log was made; the count of nodes starts again with each search.
        As text the figures of the search come first and those of the node follow, empty where they were not told.

    Examples
    --------
    >>> log = NodeLog()
    >>> log(SearchInfo(1, 1, 2, 5.0, 3.5, 0.25))
    >>> print(log.text(), end="")
    nodes,qps,open,objective,bound,seconds,number,parent,variable,value,node_bound,fate
    1,1,2,5.0,3.5,0.25,,,,,,
    """

    entries: list[SearchInfo] = field(default_factory=list)

    def __call__(self, info: SearchInfo) -> None:
        """Keep one entry; the search goes on."""
        self.entries.append(info)

    @property
    def searches(self) -> tuple[tuple[SearchInfo, ...], ...]:
        """The entries of each search by itself; a search without a node left none."""
        first = [i for i, entry in enumerate(self.entries) if i == 0 or entry.nodes <= self.entries[i - 1].nodes]
        return tuple(tuple(self.entries[i:j]) for i, j in pairwise([*first, len(self.entries)]))

    def text(self) -> str:
        """The entries as comma-separated lines under a line of names."""
        return "".join(f"{line}\n" for line in (",".join(_COLUMNS), *map(_line, self.entries)))

    def write(self, path: str | Path) -> None:
        """Write :meth:`text` to a file."""
        Path(path).write_text(self.text(), encoding="utf-8")


def _line(entry: SearchInfo) -> str:
    node = entry.node
    told = (
        [""] * (len(_OF_NODE) + 1) if node is None else [*(repr(getattr(node, n)) for n in _OF_NODE), node.fate.value]
    )
    return ",".join([*(repr(getattr(entry, name)) for name in _OF_SEARCH), *told])
