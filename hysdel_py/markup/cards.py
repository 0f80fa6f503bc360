"""What a notebook shows of a model, a form, a law, a move or a run: one small table each.

Style is left to the notebook; nothing here loads more than the objects themselves have loaded.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from hysdel_py.markup.charts import Line, line_chart
from hysdel_py.markup.elements import Child, Markup, element, fragment, number, table

if TYPE_CHECKING:
    from hysdel_py.control.explicit_law import ExplicitLaw
    from hysdel_py.control.hybrid_law import HybridLaw
    from hysdel_py.control.move import Move
    from hysdel_py.model import Model
    from hysdel_py.systems.mld import Mld
    from hysdel_py.systems.pwa import Pwa
    from hysdel_py.systems.signals import Variable
    from hysdel_py.systems.trajectory import Trajectory

__all__ = ["law_card", "mld_card", "model_card", "move_card", "pwa_card", "trajectory_card"]

_MOST_ROWS = 20
_STYLE = (
    ".hysdel-chart text{font:11px sans-serif;fill:currentColor}.hysdel-chart .grid{stroke:currentColor;opacity:.15}"
    ".hysdel-chart .line{fill:none;stroke-width:1.6}.hysdel-chart .s1{stroke-dasharray:6 3}"
    ".hysdel-chart .s2{stroke-dasharray:2 3}"
)
_LINE_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#777777")
"""Okabe and Ito, "Color universal design", 2008; grey in place of black, which dark notebooks would hide."""


def model_card(model: Model) -> Markup:
    """Variables of a model as it is declared, and its parameters."""
    symbols = [s for s in model.typed.symbols if s.role.name in ("STATE", "INPUT", "OUTPUT")]
    rows = [
        (element("code", s.name), s.role.name.lower(), s.type.value.lower(), s.unit, s.description) for s in symbols
    ]
    given = ", ".join(f"{name} = {number(value)}" for name, value in sorted(model.parameters.items()))
    notes = element("p", f"{len(model.diagnostics)} warnings and notes") if model.diagnostics else None
    head = ("name", "kind", "type", "unit", "description")
    return _card(model, _first_rows(head, rows), element("p", "parameters: ", element("code", given)), notes)


def mld_card(mld: Mld) -> Markup:
    """Variables with ranges, and the first rows with their lines."""
    from hysdel_py.systems.describe import inequalities

    rows = [(element("code", text), str(origin.line or ""), element("code", origin.text))
            for text, origin in zip(inequalities(mld), mld.rows, strict=True)]  # fmt: skip
    return _card(mld, _signals(mld.x, mld.u, mld.y, mld.d, mld.z), _first_rows(("row", "line", "item"), rows))


def pwa_card(pwa: Pwa) -> Markup:
    """The first modes with their conditions."""
    rows = [(str(m.index), element("code", m.bits), element("code", " & ".join(m.conditions))) for m in pwa.modes]
    return _card(pwa, _first_rows(("mode", "word", "conditions"), rows))


def move_card(move: Move) -> Markup:
    """Status, input and what the answer is worth."""
    names = _input_names(move)
    applied = "none" if move.u is None else ", ".join(
        f"{name}{number(value)}" for name, value in zip(names, move.u.tolist(), strict=True)
    )  # fmt: skip
    rows = [("status", move.status.value), ("input", element("code", applied)), ("cost", move.cost),
            ("bound", move.bound), ("gap", move.gap), ("nodes", float(move.nodes)),
            ("time", f"{1e3 * move.seconds:.3g} ms"), ("message", move.message)]  # fmt: skip
    return _card(None, table(("", "Move"), rows))


def _input_names(move: Move) -> Iterable[str]:
    count = 0 if move.u is None else len(move.u)
    names = move.predicted.names.get("u", ()) if move.predicted is not None else ()
    return [f"{name} = " for name in names] if len(names) == count else [""] * count


def law_card(law: ExplicitLaw | HybridLaw) -> Markup:
    """Parameters of a law."""
    return _card(law, _first_rows(("parameter",), [(element("code", name),) for name in law.names]))


def trajectory_card(run: Trajectory) -> Markup:
    """States over time, one chart for each unit, and the messages of the run."""
    groups: dict[str, list[Line]] = {}
    t = tuple(run.t.tolist())
    for column, v in enumerate(run.variables.get("x", ())):
        groups.setdefault(v.unit, []).append(Line(v.name, t, tuple(run.x[:, column].tolist()), held=v.is_bool))
    charts = [_chart(unit, lines, (t[0], t[-1])) for unit, lines in groups.items()]
    messages = [element("p", text) for text in run.messages[:_MOST_ROWS]]
    return _card(run, element("style", Markup(_style())), charts, messages)


def _chart(unit: str, lines: Sequence[Line], span: tuple[float, float]) -> Markup:
    title = ", ".join(line.name for line in lines) + (f" [{unit}]" if unit else "")
    picture = line_chart(lines, title, span)
    return element("div", element("p", title), picture, class_="hysdel-chart", style="max-width:46rem")


def _style() -> str:
    colours = (f".hysdel-chart .c{k}{{stroke:{colour}}}" for k, colour in enumerate(_LINE_COLOURS))
    return "".join((_STYLE, *colours))


def _card(shown: Any, *parts: Child) -> Markup:
    return element("div", element("p", element("b", repr(shown))) if shown is not None else None, *parts)


def _signals(*groups: Sequence[Variable]) -> Markup:
    head = ("name", "vector", "type", "range", "unit", "line")
    rows = [
        (element("code", v.name), v.kind.value, v.type.value.lower(),
         "" if v.is_bool else f"[{number(v.low)}, {number(v.high)}]", v.unit, str(v.line or ""))
        for group in groups
        for v in group
    ]  # fmt: skip
    return _first_rows(head, rows)


def _first_rows(head: Sequence[str], rows: Sequence[Sequence[Child]]) -> Markup:
    more = element("p", f"and {len(rows) - _MOST_ROWS} more") if len(rows) > _MOST_ROWS else None
    return fragment(table(head, rows[:_MOST_ROWS]), more)
