"""Versions of the package and of all it may use, for a report of a fault."""

from __future__ import annotations

import platform
import shutil
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version

from hysdel_py.version import __version__

__all__ = ["all_versions"]

_TOOLS = ("cc", "gcc", "clang", "cmake")


def all_versions() -> str:
    """One line each: the package, Python, the system, the packages of all extras, and C compilers on the path."""
    lines = [f"hysdel_py {__version__}", f"Python {platform.python_version()} ({sys.implementation.name})",
             f"{platform.system()} {platform.release()} {platform.machine()}"]  # fmt: skip
    lines += [f"{name} {_version(name)}" for name in _packages()]
    tools = [f"{tool} ({path})" for tool in _TOOLS if (path := shutil.which(tool))]
    return "\n".join([*lines, f"tools: {', '.join(tools) or 'none'}"])


def _packages() -> Iterator[str]:
    """Names of the dependencies, those of extras too, in the order in which they are stated."""
    try:
        stated = requires("hysdel-py") or []
    except PackageNotFoundError:  # run from a folder that nobody has installed
        stated = ["numpy", "scipy", "lark", "osqp", "piqp", "networkx"]
    names = (text.replace("<", " ").replace(">", " ").replace("=", " ").replace(";", " ").split()[0] for text in stated)
    yield from dict.fromkeys(names)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
