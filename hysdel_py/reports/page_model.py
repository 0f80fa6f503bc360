"""What a model is made of: sizes, signals, diagnostics, big-M constants, modes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from hysdel_py.diagnostics.render import render
from hysdel_py.markup.elements import Child, Markup, element, fragment, table
from hysdel_py.markup.mode_graph import Node, graph_picture
from hysdel_py.model import audit

if TYPE_CHECKING:
    from hysdel_py.model import Model
    from hysdel_py.systems.pwa import Pwa
    from hysdel_py.systems.signals import Variable

__all__ = ["audit_section", "diagnostics_section", "modes_section", "signals_section", "sizes_section"]

MOST_DRAWN = 40
"""Graphs of more modes are not drawn: nobody could follow the arrows."""

_KINDS = (("x", "state"), ("u", "input"), ("y", "output"), ("d", "Boolean"), ("z", "real"))


def sizes_section(model: Model, pwa: Pwa) -> Markup:
    """Numbers of signals, rows and modes."""
    mld = model.mld
    sizes = {
        "states": mld.nx, "inputs": mld.nu, "outputs": mld.ny, "Boolean auxiliaries": mld.nd,
        "real auxiliaries": mld.nz, "rows": mld.ne, "modes": _count(pwa), "different dynamics": len(pwa.dynamics),
        "sample time": model.sample_time,
    }  # fmt: skip
    pairs = [element("div", element("dt", name), element("dd", value)) for name, value in sizes.items()]
    return element("dl", pairs, class_="sizes")


def _count(pwa: Pwa) -> Child:
    return float(len(pwa.modes)) if pwa.is_complete else f"more than {len(pwa.modes)}"


def signals_section(model: Model) -> Markup:
    """Every variable with type, range, unit and line."""
    head = ("name", "kind", "type", "range", "unit", "line", "description")
    rows = [_signal(word, v) for key, word in _KINDS for v in getattr(model.mld, key)]
    values = ", ".join(f"{name} = {value:.6g}" for name, value in sorted(model.parameters.items()))
    given = element("p", "Parameters: ", element("code", values)) if values else None
    return fragment(table(head, rows), given)


def _signal(kind: str, v: Variable) -> tuple[Child, ...]:
    ranged = "" if v.is_bool or kind == "output" else f"[{v.low:g}, {v.high:g}]"
    line = str(v.line) if v.line else ""
    return element("code", v.name), kind, v.type.value.lower(), ranged, v.unit, line, v.description


def diagnostics_section(model: Model) -> Markup:
    """Warnings and notes as the compiler prints them."""
    found = [element("pre", render(d, model.typed.source)) for d in model.diagnostics]
    return fragment(found) if found else element("p", "No warnings and no notes.")


def audit_section(model: Model) -> Markup:
    """Big-M constants by both rules, the loosest first."""
    report = audit(model)
    head = ("row", "interval", "lp", "loose", "condition", "where it comes from", "which range")
    rows = [
        (f"E{r.index}", r.interval, r.lp, r.looseness, r.condition, element("code", str(r.origin)), r.advice)
        for r in report.rows
    ]
    merged = [element("li", f"{name} equals {kept}: share=True merges them") for name, kept in report.merged.items()]
    extra = [element("li", f"row {r.index} follows from the others: {r.origin}") for r in report.redundant]
    findings = element("ul", merged, extra) if merged or extra else None
    return fragment(element("p", f"{report.summary}."), table(head, rows) if rows else None, findings)


def modes_section(pwa: Pwa) -> Markup:
    """The modes with their conditions, and the graph of their transitions."""
    colours = {index: number for number, group in enumerate(pwa.dynamics) for index in group}
    names = ", ".join(name for name, _ in pwa.modes[0].word) if pwa.modes else ""
    head = ("mode", "word", "dynamics", "conditions")
    rows = [
        (str(m.index), element("code", m.bits), f"{colours[m.index]}{' (flat)' * m.is_flat}",
         [element("code", text, class_="condition") for text in m.conditions])
        for m in pwa.modes
    ]  # fmt: skip
    listed = table(head, rows, id="modes-table")
    return fragment(list(_remarks(pwa)), _graph(pwa, colours), element("p", "word = ", element("code", names)), listed)


def _remarks(pwa: Pwa) -> Iterator[Markup]:
    if not pwa.is_complete:
        yield element("p", f"The search for modes was ended after {len(pwa.modes)}: there are more.", class_="remark")
    if len(pwa.modes) > MOST_DRAWN:
        yield element(
            "p", f"The graph of {len(pwa.modes)} modes is not drawn (at most {MOST_DRAWN}): hysdel graph writes it.",
            class_="remark",
        )  # fmt: skip


def _graph(pwa: Pwa, colours: dict[int, int]) -> Markup | None:
    if not pwa.modes or len(pwa.modes) > MOST_DRAWN:
        return None
    graph: Any = pwa.transitions()
    nodes = [
        Node(m.index, "; ".join((f"mode {m.index}", *m.conditions)), colours[m.index], m.is_flat) for m in pwa.modes
    ]
    label = f"transitions between {len(nodes)} modes; the same colour stands for the same dynamics"
    told = element("p", "An arrow leads from a mode to each that can follow; a ring: the mode can stay. ",
                   "The same colour stands for the same dynamics. Choose a mode to see its arrows alone.")  # fmt: skip
    return fragment(told, graph_picture(nodes, graph.edges, label))
