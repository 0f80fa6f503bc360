"""What a search did, node by node."""

from __future__ import annotations

from dataclasses import astuple, dataclass, field, fields
from pathlib import Path

from hysdel_py.optimize.mixed_integer import SearchInfo

__all__ = ["NodeLog"]


@dataclass(slots=True)
class NodeLog:
    """A progress callback that keeps what it is told.

    Attributes
    ----------
    entries : list of SearchInfo
        One per node, over all searches since the log was made; the count of nodes starts again with each search.

    Examples
    --------
    >>> log = NodeLog()
    >>> log(SearchInfo(1, 1, 2, 5.0, 3.5, 0.25))
    >>> print(log.text(), end="")
    nodes,qps,open,objective,bound,seconds
    1,1,2,5.0,3.5,0.25
    """

    entries: list[SearchInfo] = field(default_factory=list)

    def __call__(self, info: SearchInfo) -> None:
        """Keep one entry; the search goes on."""
        self.entries.append(info)

    def text(self) -> str:
        """The entries as comma-separated lines under a line of names."""
        names = ",".join(entry.name for entry in fields(SearchInfo))
        return "".join(f"{line}\n" for line in (names, *(",".join(map(repr, astuple(e))) for e in self.entries)))

    def write(self, path: str | Path) -> None:
        """Write :meth:`text` to a file."""
        Path(path).write_text(self.text(), encoding="utf-8")
