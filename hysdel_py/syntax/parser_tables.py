"""The parser of a grammar, its tables kept on disk: working them out takes longer than most models take to compile.

They lie where Python keeps the compiled code of this module, under the same conditions: nothing is written where nobody
may write, nor where Python is told to write no byte code. A file that is not of this grammar, this version of lark and
this Python, or that is damaged, is not used.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from hashlib import sha256
from importlib.util import cache_from_source
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lark import Lark, Transformer

__all__ = ["parser_of"]

_OPTIONS: dict[str, Any] = {
    "start": "file",
    "parser": "lalr",
    "lexer": "basic",
    "keep_all_tokens": True,
    "maybe_placeholders": False,
}


def parser_of(grammar: str, name: str, transformer: Transformer[Any, Any]) -> Lark:
    """The parser of a grammar; its tables are read, or made and kept.

    Parameters
    ----------
    grammar : str
    name : str
        Of the grammar, for the name of the file.
    transformer : Transformer
        What makes values of the rules while the text is read.
    """
    from lark import Lark, __version__

    path = _place(name)
    key = f"{__version__} {sys.version_info[:2]} {_OPTIONS} {grammar}".encode()
    kept = _read(path, key) if path else None
    if kept is not None:
        # As Lark.load does, which takes no transformer; a lark that does it in another way makes its tables anew.
        with suppress(AttributeError, TypeError):
            return Lark.__new__(Lark)._load(BytesIO(kept), transformer=transformer)
    parser = Lark(grammar, transformer=transformer, **_OPTIONS)
    tables = BytesIO()
    parser.save(tables, exclude_options=("transformer",))
    if path:
        _keep(path, key, tables.getvalue())
    return parser


def _place(name: str) -> Path | None:
    """The file for the tables of a name; None where this Python keeps no byte code at all."""
    tag = sys.implementation.cache_tag
    return Path(cache_from_source(__file__)).with_name(f"{name}.{tag}.lark") if tag else None


def _digest(key: bytes, tables: bytes) -> bytes:
    return sha256(sha256(key).digest() + tables).digest()


def _read(path: Path, key: bytes) -> bytes | None:
    """Tables in a file; None if there is none, or one of another key."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    digest, tables = content[:32], content[32:]
    return tables if digest == _digest(key, tables) else None


def _keep(path: Path, key: bytes, tables: bytes) -> None:
    """Write a file that is whole whenever it is there, also where several processes write it."""
    if sys.dont_write_bytecode:
        return
    fresh = path.with_name(f"{path.name}.{os.getpid()}")
    with suppress(OSError):
        try:
            fresh.write_bytes(_digest(key, tables) + tables)
            fresh.replace(path)
        finally:
            fresh.unlink(missing_ok=True)
