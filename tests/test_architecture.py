"""The rules of docs/architecture.md: who may import whom, what loading the package costs, and what is public."""

from __future__ import annotations

import ast
import subprocess
import sys
from dataclasses import dataclass
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import hysdel_py as hys

ROOT = Path(hys.__file__).parent
DOCS = ROOT.parent / "docs"

# What the modules of a room may import when they are loaded. Whoever adds a room adds it here and in the document.
MAY_IMPORT: dict[str, set[str]] = {
    "version": set(),
    "tolerances": set(),
    "errors": set(),
    "compiled": set(),
    "diagnostics": {"errors", "syntax"},
    "syntax": {"errors", "diagnostics"},
    "systems": {"errors", "tolerances", "geometry"},
    "elaboration": {"errors", "diagnostics", "syntax", "semantics"},
    "semantics": {"errors", "diagnostics", "syntax", "systems"},
    "lowering": {"errors", "tolerances", "diagnostics", "syntax", "semantics", "systems", "geometry"},
    "optimize": {"errors", "compiled", "geometry"},
    "geometry": {"errors", "compiled"},
    "control": {"errors", "tolerances", "systems", "optimize", "geometry"},
    "analysis": {"errors", "tolerances", "systems", "optimize", "geometry", "diagnostics", "syntax"},
    "drivetrain": {"errors", "tolerances", "compiled", "optimize"},
    "export": {
        "errors",
        "tolerances",
        "version",
        "diagnostics",
        "syntax",
        "semantics",
        "systems",
        "lowering",
        "compiler",
        "geometry",
        "control",
    },
    "plotting": {"errors", "systems"},
    "shipped": {"syntax"},
    "sweeps": {"errors"},
    "compiler": {"errors", "diagnostics", "syntax", "elaboration", "semantics", "systems", "lowering", "geometry"},
    "model": {"errors", "diagnostics", "semantics", "systems", "lowering", "compiler"},
    "reports": {"errors", "diagnostics", "syntax", "semantics", "systems", "control", "analysis", "model", "markup"},
    "markup": set(),
    "bridges": {"errors", "systems", "export"},
    "demos": {"errors", "model", "systems", "control", "geometry", "drivetrain", "analysis"},
}
# These import what they like, and nobody imports them at module level.
LEAVES = {"plotting", "cli", "lsp", "notebook", "__main__"}
# What may be imported inside a function on top of that.
LAZILY = {
    "systems": {"plotting", "markup"},
    "control": {"plotting", "export", "markup"},
    "model": {"shipped", "markup"},
    "markup": {"systems"},
    "demos": {"plotting"},
    "drivetrain": {"plotting"},
    "analysis": {"lowering"},
}

HEAVY = ("matplotlib", "osqp", "piqp", "networkx", "lark", "scipy", "numpy", "pandas")
SECONDS_TO_IMPORT = 0.3

# Methods whose names are given from outside: rules of the grammar, attributes of a protocol.
NAMED_ELSEWHERE = {"TreeToAst", "Steppable"}


@dataclass(frozen=True)
class Import:
    """One import of a module of the package by another."""

    importer: str
    imported: str
    lazy: bool

    @property
    def rooms(self) -> tuple[str, str]:
        return room(self.importer), room(self.imported)


def room(module: str) -> str:
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else "__init__"


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {module_name(path): path for path in sorted(ROOT.rglob("*.py"))}
TREES = {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in FILES.items()}


def is_type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)


def imports_of(name: str) -> list[Import]:
    """Imports at run time; those for type checkers only do not count."""
    found: list[Import] = []

    def visit(node: ast.AST, lazy: bool) -> None:
        if is_type_checking(node):
            return
        for imported in imported_modules(node):
            found.append(Import(name, imported, lazy))
        inside = lazy or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        for child in ast.iter_child_nodes(node):
            visit(child, inside)

    visit(TREES[name], False)
    return found


def imported_modules(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names if alias.name.split(".")[0] == "hysdel_py"]
    if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "hysdel_py":
        inner = [f"{node.module}.{alias.name}" for alias in node.names]
        return [name if name in FILES else str(node.module) for name in inner]
    return []


IMPORTS = [found for name in FILES for found in imports_of(name)]


def test_the_walk_sees_the_package():
    assert len(FILES) > 50
    assert Import("hysdel_py.lowering.rows", "hysdel_py.lowering.cnf", lazy=False) in IMPORTS
    assert Import("hysdel_py.model", "hysdel_py.shipped", lazy=True) in IMPORTS
    assert not [i for i in IMPORTS if i.importer == "hysdel_py.errors"]


def test_every_room_has_a_rule():
    rooms = {room(name) for name in FILES} - LEAVES - {"__init__"}
    assert rooms <= set(MAY_IMPORT), "add the room to MAY_IMPORT and to docs/architecture.md"


def test_rooms_import_only_what_they_may():
    wrong = []
    for found in IMPORTS:
        importer, imported = found.rooms
        if importer in LEAVES or importer == "__init__" or importer == imported:
            continue
        allowed = MAY_IMPORT[importer] | (LAZILY.get(importer, set()) if found.lazy else set())
        if imported not in allowed:
            wrong.append(f"{found.importer} imports {found.imported}")
    assert not wrong


def test_nobody_imports_a_leaf_at_module_level():
    assert not [i for i in IMPORTS if not i.lazy and i.rooms[1] in LEAVES and i.rooms[0] not in (*LEAVES,)]


def test_no_circle_of_imports():
    graph: dict[str, set[str]] = {name: set() for name in FILES}
    for found in IMPORTS:
        if not found.lazy and found.importer != found.imported:
            graph[found.importer].add(found.imported)
    tuple(TopologicalSorter(graph).static_order())  # raises CycleError, which names the circle


def test_the_document_shows_every_rule():
    text = (DOCS / "architecture.md").read_text(encoding="utf-8")
    rooms = {room(name) for name in FILES} - {"__init__"}
    assert not [name for name in rooms if f"`{name}`" not in text]


def run(code: str) -> str:
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT.parent
    ).stdout


def test_import_loads_nothing_heavy():
    loaded = run("import sys, hysdel_py; print(*sorted({name.split('.')[0] for name in sys.modules}))").split()
    assert "hysdel_py" in loaded
    assert not set(HEAVY) & set(loaded)


def test_every_public_name_resolves():
    for name in hys.__all__:
        assert getattr(hys, name) is not None
    assert set(hys.__all__) <= set(dir(hys))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = hys.nothing


def test_compiling_needs_no_solver_and_no_plots():
    code = "import sys, hysdel_py as h; h.load('clutch').dha; print(*{name.split('.')[0] for name in sys.modules})"
    assert not {"matplotlib", "osqp", "piqp", "networkx", "pandas", "scipy"} & set(run(code).split())


def test_import_is_fast():
    code = "from time import perf_counter as t; a = t(); import hysdel_py; print(t() - a)"
    assert min(float(run(code)) for _ in range(5)) < SECONDS_TO_IMPORT


def public_nodes(name: str) -> list[tuple[str, ast.AST]]:
    """Module, public classes, functions and methods; nested functions are private."""
    tree = TREES[name]
    found: list[tuple[str, ast.AST]] = [(name, tree)] if FILES[name].read_text(encoding="utf-8").strip() else []
    for node in tree.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
            found.append((f"{name}.{node.name}", node))
            if isinstance(node, ast.ClassDef) and node.name not in NAMED_ELSEWHERE:
                methods = [m for m in node.body if isinstance(m, ast.FunctionDef) and not m.name.startswith("_")]
                found += [(f"{name}.{node.name}.{method.name}", method) for method in methods]
    return found


@pytest.mark.parametrize("name", [n for n in FILES if "._" not in n])
def test_everything_public_has_a_docstring(name):
    missing = [label for label, node in public_nodes(name) if not ast.get_docstring(node)]  # type: ignore[arg-type]
    assert not missing


@pytest.mark.parametrize(
    "name",
    ["load", "to_mld", "HybridMpc", "LinearMpc", "Cost", "Limits", "closed_loop", "Trajectory", "Model", "Dha", "Mld"],
)
def test_fixed_names_are_public(name):
    assert name in hys.__all__


@pytest.mark.parametrize(
    ("owner", "names"),
    [
        ("Model", ("dha", "mld", "simulate")),
        ("Dha", ("step", "simulate")),
        ("Mld", ("step", "simulate")),
        ("HybridMpc", ("solve",)),
        ("LinearMpc", ("solve",)),
        ("ExplicitLaw", ("locate", "solve")),
        ("Trajectory", ("to_pandas", "plot", "modes", "names")),
    ],
)
def test_fixed_methods(owner, names):
    assert not [name for name in names if not hasattr(getattr(hys, owner), name)]
