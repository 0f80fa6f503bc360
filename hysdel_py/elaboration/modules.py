"""Finds the files of modules and joins them to the text of the whole.

Input: the syntax tree of the whole. Output: one instance for the whole and each module in it, and a source in which
every span has its place, so that a diagnostic shows the file that it is about.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.elaboration.elaborate import Instance
from hysdel_py.syntax import ast
from hysdel_py.syntax.parser import parse
from hysdel_py.syntax.reader import read_source
from hysdel_py.syntax.source import Source

__all__ = ["MAX_INSTANCES", "load_modules"]

MAX_INSTANCES = 10_000
"""Most modules in one model, those of modules included."""


@dataclass(frozen=True, slots=True)
class _Pending:
    """An instance whose own modules are still to be found, and the files that it lies in."""

    instance: Instance
    folder: Path | None
    files: tuple[Path, ...]


@dataclass(slots=True)
class _Files:
    """Files that are read already."""

    source: Source
    search_path: Sequence[Path]
    sink: Sink
    systems: dict[Path, ast.System | None] = field(default_factory=dict)

    def find(self, name: str, folder: Path | None) -> Path | None:
        """Path of a module's file: beside the file that names it, then along the search path."""
        folders = [*([] if folder is None else [folder]), *self.search_path]
        found = (folder / f"{name}.hys" for folder in folders)
        return next((path.resolve() for path in found if path.is_file()), None)

    def system(self, path: Path) -> ast.System | None:
        """Syntax tree of a file, with spans in the joined source."""
        if path not in self.systems:
            module = read_source(path, self.sink)
            # Blanks in front put every span where it will be in the joined text.
            padded = Source(module.name, " " * len(self.source.text) + module.text, path)
            self.source = self.source.joined(module)
            self.systems[path] = parse(padded, self.sink) if module.text else None
        return self.systems[path]


def load_modules(
    system: ast.System, source: Source, search_path: Sequence[Path], sink: Sink
) -> tuple[tuple[Instance, ...], Source]:
    """Instances of a model, the whole first, and the joined source."""
    files = _Files(source, search_path, sink)
    whole = Instance("", system)
    own = (source.path.resolve(),) if source.path else ()
    folder = own[0].parent if own else None
    instances: list[Instance] = []
    pending = [_Pending(whole, folder, own)]
    while pending:
        current = pending.pop()
        instances.append(current.instance)
        if len(instances) + len(pending) > MAX_INSTANCES:
            sink.error(Code.MODULE, f"there are more than {MAX_INSTANCES} modules")
            break
        pending.extend(reversed(_modules_of(current, files)))
    return tuple(instances), files.source


def _modules_of(current: _Pending, files: _Files) -> list[_Pending]:
    found = []
    taken = {d.name: d.name_span for s in current.instance.system.declarations for d in s.declarations}
    for module in current.instance.system.modules:
        files.sink.note(Code.EXTENSION, "HYSDEL 2.0.5 knows no MODULE", module.file.span)
        earlier = taken.setdefault(module.name.name, module.name.span)
        if earlier is not module.name.span:
            labels = (Label(earlier, "declared here"),)
            message = f"{module.name.name} is already declared"
            files.sink.error(Code.DECLARED_TWICE, message, module.name.span, labels=labels)
            continue
        path = files.find(module.file.name, current.folder)
        if path is None:
            _report_missing(module, current, files)
        elif path in current.files:
            circle = " -> ".join(p.name for p in (*current.files[current.files.index(path) :], path))
            files.sink.error(Code.MODULE, f"files contain each other: {circle}", module.file.span)
        else:
            system = files.system(path)
            if system is not None:
                instance = Instance(f"{current.instance.prefix}{module.name.name}.", system)
                found.append(_Pending(instance, path.parent, (*current.files, path)))
    return found


def _report_missing(module: ast.Module, current: _Pending, files: _Files) -> None:
    folders = [*([] if current.folder is None else [current.folder]), *files.search_path]
    looked = ", ".join(str(folder) for folder in folders) or "nowhere, as the model came as a text"
    files.sink.error(
        Code.MODULE,
        f"there is no file {module.file.name}.hys for the module {module.name.name}",
        module.file.span,
        help=f"looked in {looked}; name further folders by search_path",
    )
