"""Read a source text from a path or a string, with a diagnostic instead of an exception where it cannot be read."""

from __future__ import annotations

import os
from pathlib import Path

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.errors import ArgumentError
from hysdel_py.syntax.source import COMMENT, Source

__all__ = ["MAX_CHARACTERS", "is_text", "read_source"]

MAX_CHARACTERS = 2_000_000
"""Longest source text that is compiled, comments not counted; a model of this size has some 50,000 lines."""

_WANTED = "give the path of a .hys file, the name of a shipped model, or the text of a model (SYSTEM name {...})"


def is_text(path_or_text: str | os.PathLike[str]) -> bool:
    """Whether an argument is a model's text and not the path of a file: only texts hold a brace or a line end."""
    return isinstance(path_or_text, str) and any(mark in path_or_text for mark in ("{", "}", "\n", "/*"))


def read_source(path_or_text: str | os.PathLike[str], sink: Sink) -> Source:
    """Read a model.

    Parameters
    ----------
    path_or_text : str or path
        The path of a file, or the text of a model.
    sink : Sink
        Receives an error if there is nothing to compile; the returned text is then empty.

    Raises
    ------
    ArgumentError
        The argument is neither a text nor a path.
    """
    if not isinstance(path_or_text, str | os.PathLike):
        raise ArgumentError(f"the model is {path_or_text!r:.80}: a path or the text of a model was expected")
    if not str(path_or_text):
        sink.error(Code.UNREADABLE, "the name of the file is empty", help=_WANTED)
        return Source("", "")
    if is_text(path_or_text):
        source = Source("<text>", str(path_or_text).removeprefix("\ufeff"))
    else:
        path = Path(path_or_text)
        source = Source(path.name or str(path), _read(path, sink), path)
    return _of_sensible_size(source, sink)


def _read(path: Path, sink: Sink) -> str:
    try:
        data = path.read_bytes()
    except OSError as error:
        sink.error(
            Code.UNREADABLE, f"cannot read {str(path)[:200]}: {error.strerror or error}", help=_near_misses(path)
        )
        return ""
    except ValueError as error:
        sink.error(Code.UNREADABLE, f"this is not the name of a file: {error}")
        return ""
    if b"\0" in data:
        sink.error(Code.NOT_TEXT, f"{path.name} is not a text file: it holds a zero byte at offset {data.index(0)}")
        return ""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        return _decode_with_foreign_comments(path, data, error, sink)


def _decode_with_foreign_comments(path: Path, data: bytes, error: UnicodeDecodeError, sink: Sink) -> str:
    """Accept bytes of another encoding inside comments, as the original compiler does; refuse them elsewhere."""
    text = data.decode("latin-1")
    bare = COMMENT.sub("", text)
    if bare.isascii():
        return text
    line = data.count(b"\n", 0, error.start) + 1
    sink.error(
        Code.NOT_UTF8,
        f"{path.name} is not UTF-8: byte 0x{data[error.start]:02x} in line {line} (offset {error.start})",
        help="save the file as UTF-8; outside comments the language needs plain ASCII only",
    )
    return ""


def _near_misses(path: Path) -> str:
    with_suffix = path.with_name(path.name + ".hys") if path.name else path
    try:
        if path.is_dir():
            return "this is a folder; name one of its .hys files"
        return f"did you mean {with_suffix}?" if with_suffix.is_file() else _WANTED
    except OSError:  # a name that the file system does not allow
        return _WANTED


def _of_sensible_size(source: Source, sink: Sink) -> Source:
    if len(source.text) <= MAX_CHARACTERS:
        return source
    comments = sum(span.end - span.start for span in source.comments)
    code = len(source.text) - comments
    if code <= MAX_CHARACTERS:
        return source
    sink.error(
        Code.TOO_LONG,
        f"{source.name} holds {code} characters of code; at most {MAX_CHARACTERS} are compiled",
        help="split the model, or generate fewer scalar items",
    )
    return Source(source.name, "", source.path)
