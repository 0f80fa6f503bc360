"""The page of each diagnostic."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from hysdel_py.diagnostics.codes import Code
from hysdel_py.errors import ArgumentError

__all__ = ["explain", "folder", "title"]


def folder() -> Path:
    """Where the pages are: inside an installed package, in the documents of a checkout."""
    installed = Path(str(resources.files("hysdel_py"))) / "explanations"
    return installed if installed.is_dir() else Path(__file__).parents[2] / "docs" / "errors"


def explain(code: str) -> str:
    """Text of the page of a code.

    Raises
    ------
    ArgumentError
        There is no such code; the message names those that resemble it.
    """
    from difflib import get_close_matches

    wanted = code.strip().upper()
    wanted = f"HYS{wanted}" if wanted.isdigit() else wanted
    known = [member.value for member in Code]
    if wanted not in known:
        near = get_close_matches(wanted, known, n=4, cutoff=0.6)
        hint = f"did you mean {', '.join(sorted(near))}?" if near else f"codes look like {known[0]}"
        raise ArgumentError(f"there is no diagnostic '{code[:40]}': {hint}")
    return (folder() / f"{wanted}.md").read_text(encoding="utf-8")


def title(code: Code) -> str:
    """What a code is about, in a few words: the headline of its page."""
    return explain(code.value).partition("\n")[0].partition(": ")[2]
