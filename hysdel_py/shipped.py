"""The models that come with the package."""

from __future__ import annotations

import os
from importlib import resources
from pathlib import Path

from hysdel_py.syntax.reader import is_text

__all__ = ["locate", "shipped_models"]


def _folder() -> Path:
    installed = Path(str(resources.files("hysdel_py"))) / "models"
    return installed if installed.is_dir() else Path(__file__).parents[1] / "models"


def shipped_models() -> dict[str, Path]:
    """Paths of the shipped models by name, in alphabetical order."""
    return {path.stem: path for path in sorted(_folder().glob("*.hys"))}


def locate(path_or_text: str | os.PathLike[str]) -> str | os.PathLike[str]:
    """The argument itself, or the path of a shipped model that it names and no file hides."""
    if is_text(path_or_text) or not isinstance(path_or_text, str) or not path_or_text:
        return path_or_text
    known = shipped_models()
    name = path_or_text.removesuffix(".hys")
    try:
        hidden = Path(path_or_text).is_file()
    except (OSError, ValueError):
        return path_or_text
    return known[name] if name in known and not hidden else path_or_text
