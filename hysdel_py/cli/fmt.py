"""``hysdel fmt``: one layout for all models."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

from hysdel_py.diagnostics.render import render
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.errors import ArgumentError
from hysdel_py.syntax.formatter import format_text
from hysdel_py.syntax.parser import parse
from hysdel_py.syntax.reader import read_source
from hysdel_py.syntax.source import Source

__all__ = ["add_parser"]

_EPILOG = """\
examples:
  hysdel fmt model.hys                   rewrite a file in the canonical layout
  hysdel fmt --check models/*.hys        name the files that are laid out otherwise; status 1 if there are any
  hysdel fmt --diff model.hys            show what would change
  hysdel fmt - < model.hys               write the result to the standard output

Comments stay, and so does the meaning. A file with a mistake of syntax is left as it is; status 1.
"""
_STDIN = "-"
_BOM = b"\xef\xbb\xbf"


@dataclass(frozen=True, slots=True)
class _Formatted:
    """A text before and after."""

    name: str
    before: str
    after: str

    @property
    def changed(self) -> bool:
        return self.before != self.after


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "fmt",
        description="Rewrite models in the canonical layout; see docs/formatter.md.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("files", metavar="FILE", nargs="+", help="a .hys file, or - for the standard input")
    parser.add_argument("--check", action="store_true", help="write nothing; status 1 if a file would change")
    parser.add_argument("--diff", action="store_true", help="write nothing; print the changes")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the command."""
    if _STDIN in options.files and len(options.files) > 1:
        raise ArgumentError("- stands for the standard input and goes with no other file")
    return max([_format_one(name, options) for name in options.files])


def _format_one(name: str, options: argparse.Namespace) -> int:
    """Format one file; returns its part of the exit status."""
    formatted = _formatted(name)
    if formatted is None:
        return 1
    if options.diff:
        print("\n".join(_diff(formatted)), end="\n" * formatted.changed)
    elif name == _STDIN and not options.check:
        print(formatted.after, end="")
    if options.check:
        if formatted.changed:
            print(f"{formatted.name} would change", file=sys.stderr)
        return int(formatted.changed)
    if not options.diff and name != _STDIN and formatted.changed:
        _write(Path(name), formatted.after)
        print(f"{name}: formatted", file=sys.stderr)
    return 0


def _formatted(name: str) -> _Formatted | None:
    """The text of a file before and after; None after a mistake, which has been told."""
    sink = Sink()
    source = Source("<stdin>", sys.stdin.read()) if name == _STDIN else read_source(Path(name), sink)
    if not sink.failed:
        parse(source, sink)
    if sink.failed:
        print("\n".join(render(diagnostic, source) for diagnostic in sink.diagnostics), file=sys.stderr)
        return None
    return _Formatted(name if name != _STDIN else source.name, source.text, format_text(source.text))


def _write(path: Path, text: str) -> None:
    """Replace the text of a file in its own encoding, byte order mark included."""
    data = path.read_bytes()
    path.write_bytes(text.encode(_encoding(data)))


def _encoding(data: bytes) -> str:
    """Encoding by which the reader has read a file; it reads foreign bytes in comments one to one."""
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8-sig" if data.startswith(_BOM) else "utf-8"


def _diff(formatted: _Formatted) -> list[str]:
    from difflib import unified_diff

    before, after = (text.split("\n") for text in (formatted.before, formatted.after))
    return list(unified_diff(before, after, formatted.name, f"{formatted.name} (formatted)", lineterm=""))
