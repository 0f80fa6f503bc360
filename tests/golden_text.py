"""Readable text of the stages of the compiler, and the files under tests/golden that hold what it should be.

After a change that is meant, ``python tests/golden_text.py`` writes the files anew; read the difference.
"""

from __future__ import annotations

from pathlib import Path

from hysdel_py.diagnostics.sink import Sink
from hysdel_py.model import load, to_mld
from hysdel_py.semantics import expressions as typed
from hysdel_py.semantics.typed_model import Choice, Equation, Requirement, Threshold, TypedModel
from hysdel_py.syntax import ast
from hysdel_py.syntax.parser import parse
from hysdel_py.syntax.source import Source
from hysdel_py.syntax.traversal import fold

GOLDEN = Path(__file__).parent / "golden"
MODELS = ("heater", "casts", "vectors", "queries")
STAGES = ("ast", "typed", "dha", "mld", "tight")


def parsed(text: str) -> ast.System:
    sink = Sink()
    source = Source("<text>", text)
    system = parse(source, sink)
    sink.raise_errors(source)
    assert system is not None
    return system


def expression_text(expression: ast.Expression) -> str:
    """Prefix notation: (+ x (* 2 y)); parentheses of the source are shown as [...]."""

    def node(node: ast.Expression, args: list[str]) -> str:
        match node:
            case ast.Number(text=text):
                return text
            case ast.Truth(value=value):
                return str(value).upper()
            case ast.Name(name=name):
                return name
            case ast.Group():
                return f"[{args[0]}]"
            case ast.Indexed(name=name):
                return f"{name}({' '.join(args)})"
            case ast.Range():
                return f"{args[0]}:{args[1]}"
            case ast.Matrix(rows=rows):
                entries = iter(args)
                return "{" + "; ".join(", ".join(next(entries) for _ in row) for row in rows) + "}"
            case ast.Conditional():
                return f"(if {' '.join(args)})"
            case ast.Apply(op=op):
                return f"({op.value} {' '.join(args)})"

    return fold(expression, ast.children, node)


def ast_text(system: ast.System) -> str:
    lines = [f"SYSTEM {system.name}"]
    for section in system.declarations:
        lines.append(f"  {section.kind.value}")
        lines += [f"    {_declaration(d)}" for d in section.declarations]
    for items in system.sections:
        lines.append(f"  {items.kind.value}")
        lines += [f"    {line}" for item in items.items for line in _item(item)]
    return "\n".join(lines) + "\n"


def _declaration(d: ast.Declaration) -> str:
    text = f"{d.type} {d.name}" + (f"({', '.join(map(expression_text, d.size))})" if d.size else "")
    if d.interval:
        pairs = ((d.interval.low, d.interval.high), *d.interval.further)
        text += " in " + "; ".join(f"{expression_text(low)} .. {expression_text(high)}" for low, high in pairs)
    return text + (f" = {expression_text(d.value)}" if d.value else "")


def _triple(triple: ast.Triple | None) -> str:
    if triple is None:
        return ""
    return " within " + ", ".join(map(expression_text, (triple.low, triple.high, triple.epsilon)))


def _item(item: ast.Item) -> list[str]:
    match item:
        case ast.Equation(target=target, value=value, triple=triple):
            return [f"{expression_text(target)} = {expression_text(value)}{_triple(triple)}"]
        case ast.Requirement(value=value):
            return [expression_text(value)]
        case ast.Query(kind=kind, condition=condition, steps=steps, start=start):
            parts = [kind.value.lower(), expression_text(condition), "within", expression_text(steps)]
            return [" ".join(parts + ([] if start is None else ["from", expression_text(start)]))]
        case ast.Loop(iterator=iterator, low=low, high=high, items=items):
            head = f"for {iterator.name} = {expression_text(low)}:{expression_text(high)}"
            return [head, *(f"  {line}" for inner in items for line in _item(inner))]
        case ast.Choice():
            lines = [f"{expression_text(item.target)}", f"  if {expression_text(item.condition)}"]
            lines.append(f"  then {expression_text(item.then)}{_triple(item.then_triple)}")
            if item.otherwise is not None:
                lines.append(f"  else {expression_text(item.otherwise)}{_triple(item.otherwise_triple)}")
            return lines


def typed_expression_text(expression: typed.Expression) -> str:
    """Prefix notation with the type of every operator: r for real, b for Boolean."""

    def node(node: typed.Expression, args: list[str]) -> str:
        match node:
            case typed.Constant(value=value):
                return f"{value:g}:{node.type.value[0].lower()}"
            case typed.Reference(symbol=symbol):
                return symbol.name
            case typed.Apply(op=op):
                return f"({op.value}:{node.type.value[0].lower()} {' '.join(args)})"

    return fold(expression, typed.children, node)


def typed_text(model: TypedModel) -> str:
    lines = [f"model {model.name}"]
    for symbol in model.symbols:
        bounds = f" in {' .. '.join(map(typed_expression_text, symbol.bounds))}" if symbol.bounds else ""
        value = f" = {typed_expression_text(symbol.value)}" if symbol.value else ""
        unit = f" [{symbol.unit}] {symbol.description}" if symbol.unit else ""
        lines.append(f"  line {symbol.line}: {symbol.spoken} {symbol.name}{bounds}{value}{unit}")
    for item in model.items:
        target = f"{item.target.name} " if item.target else ""
        lines.append(f"  {item.number} {item.section.value} line {item.line}: {target}{_body(item.body)}")
    for query in model.queries:
        start = "" if query.start is None else f" from {typed_expression_text(query.start)}"
        asked = f"{query.kind.value.lower()} {typed_expression_text(query.condition)} within {query.steps}{start}"
        lines.append(f"  query line {query.line}: {asked}")
    return "\n".join(lines) + "\n"


def _body(body: object) -> str:
    match body:
        case Threshold(left=left, right=right, at_least=at_least):
            sign = ">=" if at_least else "<="
            return f"<-> {typed_expression_text(left)} {sign} {typed_expression_text(right)}"
        case Choice(condition=condition, then=then, otherwise=otherwise):
            text = f"= {typed_expression_text(then.value)} if {typed_expression_text(condition)}"
            return text + (f" else {typed_expression_text(otherwise.value)}" if otherwise else "")
        case Equation(value=value) | Requirement(value=value):
            return f"= {typed_expression_text(value)}"
        case _:
            raise AssertionError(body)


def stage_text(name: str, stage: str) -> str:
    path = GOLDEN / f"{name}.hys"
    if stage == "ast":
        return ast_text(parsed(path.read_text()))
    model = load(path)
    texts = {
        "typed": lambda: typed_text(model.typed),
        "dha": model.dha.describe,
        "mld": lambda: to_mld(model, big_m="interval").describe(),
        "tight": model.mld.describe,
    }
    return texts[stage]()


if __name__ == "__main__":
    for name in MODELS:
        for stage in STAGES:
            (GOLDEN / f"{name}.{stage}.txt").write_text(stage_text(name, stage))
