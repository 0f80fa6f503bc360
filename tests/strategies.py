"""Random valid models as text, for property tests.

A model is drawn as a list of auxiliaries, each defined by an item that reads only earlier names, so that no algebraic
loop can arise; updates, outputs and requirements read any of them. All real names have ranges, declared or derived.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from hypothesis import strategies as st

NUMBERS = ("0.5", "1", "2", "0.25", "3", "1.5", "a", "(a + 1)")
CONNECTIVES = ("&", "|", "->", "<-", "<->", "&&", "||")


@dataclass
class Names:
    """Names that an expression may read."""

    reals: list[str] = field(default_factory=list)
    bools: list[str] = field(default_factory=list)


@st.composite
def logic(draw: st.DrawFn, names: Names, depth: int = 2) -> str:
    """A Boolean expression."""
    if depth == 0 or draw(st.integers(0, 3)) == 0:
        if draw(st.integers(0, 5)) == 0:
            return draw(comparison(names))
        leaves = [*names.bools, "TRUE", "FALSE"] if draw(st.integers(0, 9)) == 0 or not names.bools else names.bools
        return draw(st.sampled_from(leaves))
    kind = draw(st.sampled_from(["not", "binary", "binary", "group"]))
    if kind == "not":
        return draw(st.sampled_from("~!")) + "(" + draw(logic(names, depth - 1)) + ")"
    if kind == "group":
        return "(" + draw(logic(names, depth - 1)) + ")"
    left, right = draw(logic(names, depth - 1)), draw(logic(names, depth - 1))
    return f"({left}) {draw(st.sampled_from(CONNECTIVES))} {right}"


@st.composite
def comparison(draw: st.DrawFn, names: Names) -> str:
    """A comparison in parentheses, now and then a chain."""
    sides = draw(st.lists(affine(names, casts=False), min_size=2, max_size=3))
    text = sides[0]
    for side in sides[1:]:
        text += f" {draw(st.sampled_from(['<=', '>=', '<', '>']))} {side}"
    return f"({text})"


@st.composite
def term(draw: st.DrawFn, names: Names, *, casts: bool = True) -> str:
    """A product, quotient, cast or number."""
    kind = draw(st.sampled_from(["real"] * 4 + ["number"] + ["cast"] * casts))
    number = draw(st.sampled_from(NUMBERS))
    if kind == "real" and names.reals:
        name = draw(st.sampled_from(names.reals))
        return draw(st.sampled_from([f"{number}*{name}", f"{name}/2", name, f"-{name}*{number}", f"0*{name}"]))
    if kind == "cast":
        return f"{number}*(REAL {draw(logic(names, 1))})"
    return number


@st.composite
def affine(draw: st.DrawFn, names: Names, *, casts: bool = True) -> str:
    """An affine expression of one to three terms."""
    terms = draw(st.lists(term(names, casts=casts), min_size=1, max_size=3))
    text = terms[0]
    for following in terms[1:]:
        text += draw(st.sampled_from([" + ", " - "])) + following
    return text


@st.composite
def auxiliary(draw: st.DrawFn, names: Names, index: int) -> tuple[str, str, str, str]:
    """(section, type, name, item) of one auxiliary that reads the names so far."""
    section = draw(st.sampled_from(["AD", "AD", "DA", "DA", "LOGIC", "LINEAR"]))
    if section == "AD":
        sign = draw(st.sampled_from(["<=", ">=", "<=", ">=", "<", ">"]))
        name = f"d{index}"
        return section, "BOOL", name, f"{name} = {draw(affine(names))} {sign} {draw(affine(names, casts=False))};"
    if section == "LOGIC":
        name = f"d{index}"
        return section, "BOOL", name, f"{name} = {draw(logic(names))};"
    name = f"z{index}"
    if section == "LINEAR":
        return section, "REAL", name, f"{name} = {draw(affine(names))};"
    return section, "REAL", name, f"{name} = {draw(choice(names))};"


@st.composite
def choice(draw: st.DrawFn, names: Names, depth: int = 1) -> str:
    """A choice, whose branches may be choices."""
    branch = affine(names) if depth == 0 else st.one_of(affine(names), affine(names), choice(names, depth - 1))
    otherwise = draw(st.one_of(st.just(""), branch.map(" ELSE {}".format)))
    return f"{{IF {draw(logic(names))} THEN {draw(branch)}{otherwise}}}"


@dataclass(frozen=True)
class Parts:
    """A model before it is written: names by role, and items as (section, text)."""

    states: tuple[str, ...]
    modes: tuple[str, ...]
    real_inputs: tuple[str, ...]
    bool_inputs: tuple[str, ...]
    auxiliaries: tuple[tuple[str, str], ...]
    items: tuple[tuple[str, str], ...]

    @property
    def declared(self) -> tuple[tuple[str, str, str, str], ...]:
        """(section, type, name, range) of each variable in the order of declaration."""
        return (
            *(("STATE", "REAL", x, f"[-{i + 2}, {i + 3}.5]") for i, x in enumerate(self.states)),
            *(("STATE", "BOOL", b, "") for b in self.modes),
            *(("INPUT", "REAL", u, "[-1.5, 1]") for u in self.real_inputs),
            *(("INPUT", "BOOL", v, "") for v in self.bool_inputs),
            ("OUTPUT", "REAL", "y0", ""),
            ("OUTPUT", "BOOL", "w0", ""),
            *(("AUX", type_, name, "") for type_, name in self.auxiliaries),
        )


@st.composite
def parts(draw: st.DrawFn) -> Parts:
    """The parts of a valid model without undefined names or loops."""
    states = [f"x{i}" for i in range(draw(st.integers(1, 2)))]
    modes = [f"b{i}" for i in range(draw(st.integers(0, 2)))]
    real_inputs, bool_inputs = ["u0"] * draw(st.integers(0, 1)), ["v0"] * draw(st.integers(0, 1))
    names = Names([*states, *real_inputs], [*modes, *bool_inputs])
    auxiliaries = []
    for index in range(draw(st.integers(1, 5))):
        auxiliaries.append(draw(auxiliary(names, index)))
        _, type_, name, _ = auxiliaries[-1]
        (names.reals if type_ == "REAL" else names.bools).append(name)
    items = [(section, item) for section, _, _, item in draw(st.permutations(auxiliaries))]
    items += [("CONTINUOUS", f"{x} = {draw(affine(names))};") for x in states]
    items += [("AUTOMATA", f"{b} = {draw(logic(names))};") for b in modes]
    items += [("OUTPUT", f"y0 = {draw(affine(names))};"), ("OUTPUT", f"w0 = {draw(logic(names))};")]
    if draw(st.booleans()):
        items.append(("MUST", draw(requirement(names)) + ";"))
    declared = tuple((type_, name) for _, type_, name, _ in auxiliaries)
    ordered = tuple(draw(st.permutations(items)))
    return Parts(tuple(states), tuple(modes), tuple(real_inputs), tuple(bool_inputs), declared, ordered)


def models() -> st.SearchStrategy[str]:
    """The text of a valid model without undefined names or loops."""
    return parts().map(lambda drawn: written(drawn.declared, drawn.items))


@st.composite
def requirement(draw: st.DrawFn, names: Names) -> str:
    """An item of MUST."""
    kind = draw(st.sampled_from(["logic", "logic", "comparison", "comparison", "chain", "conjunction"]))
    if kind == "logic":
        return draw(logic(names))
    if kind == "conjunction":
        return f"{draw(comparison(names))} & ({draw(logic(names))})"
    sides = draw(st.lists(affine(names), min_size=3 if kind == "chain" else 2, max_size=3 if kind == "chain" else 2))
    sign = draw(st.sampled_from(["<=", ">="]))
    return f" {sign} ".join(sides)


def written(
    declared: Iterable[tuple[str, str, str, str]],
    items: Iterable[tuple[str, str]],
    *,
    name: str = "random",
    preamble: str = "",
    iterators: str = "",
) -> str:
    """The text of a model: declarations as :attr:`Parts.declared` gives them, items with their sections."""
    declared = tuple(declared)

    def variables(role: str) -> str:
        return "".join(f"      {type_} {name} {limits};\n" for kind, type_, name, limits in declared if kind == role)

    interface = "".join(
        f"    {role} {{\n{variables(role)}    }}\n" for role in ("STATE", "INPUT", "OUTPUT") if variables(role)
    )
    auxiliaries = iterators + variables("AUX")
    return (
        f"SYSTEM {name} {{\n  INTERFACE {{\n    PARAMETER {{ REAL a = 0.75; }}\n{preamble}{interface}  }}\n"
        "  IMPLEMENTATION {\n"
        + (f"    AUX {{\n{auxiliaries}    }}\n" if auxiliaries else "")
        + "".join(f"    {section} {{\n      {item}\n    }}\n" for section, item in items)
        + "  }\n}\n"
    )


NAME = re.compile(r"\b(?:[xbuvdzyw]\d)\b")
"""A variable of a random model."""


def renamed(text: str, rename: Callable[[str], str]) -> str:
    """A text with other names for its variables."""
    return NAME.sub(lambda match: rename(match.group()), text)


def split(item: str) -> tuple[str, str]:
    """What an item defines, with the equals sign, and the rest; nothing for a requirement."""
    match = re.match(r"[xbdzyw]\d = ", item)
    return (match.group(), item[match.end() :]) if match else ("", item)


@st.composite
def vector_models(draw: st.DrawFn) -> tuple[str, str]:
    """A model over vectors, with items element by element, in loops and as a whole, and the same over scalars.

    Every variable of a random model becomes a vector. Loops may read the states and inputs of the element opposite, so
    that elements are coupled.
    """
    drawn, n = draw(parts()), draw(st.integers(1, 3))
    items, scalar_items = [], []
    for section, item in drawn.items:
        style = draw(st.sampled_from(["whole", "loop", "opposite", "each"]))
        each = [with_indices(item, f"({k})", f"({k})") for k in range(1, n + 1)]
        opposite = "(n + 1 - i)" if style == "opposite" else "(i)"
        loop = f"FOR (i = 1:n) {{ {with_indices(item, '(i)', opposite)} }}"
        items.append((section, {"whole": item, "each": " ".join(each)}.get(style, loop)))
        for k in range(1, n + 1):
            other = n + 1 - k if style == "opposite" else k
            scalar_items.append((section, with_indices(item, f"_{k}", f"_{other}")))
    vectors = [(role, type_, f"{name}(n)", limits) for role, type_, name, limits in drawn.declared]
    scalars = [(role, type_, f"{name}_{k}", r) for role, type_, name, r in drawn.declared for k in range(1, n + 1)]
    preamble = f"    PARAMETER {{ REAL n = {n}; }}\n"
    return written(vectors, items, preamble=preamble, iterators="      INDEX i;\n"), written(scalars, scalar_items)


def with_indices(item: str, index: str, read: str) -> str:
    """An item whose variables have an index; states and inputs on its right side have that of what is read."""
    target, rest = split(item)
    return renamed(target, lambda name: name + index) + renamed(
        rest, lambda name: name + (read if name[0] in "xbuv" else index)
    )


@st.composite
def module_models(draw: st.DrawFn) -> tuple[str, tuple[str, str], str]:
    """A whole with two modules ``p`` and ``q``, the files of these, and the same model in one text.

    The whole has inputs of its own, which feed the modules; the Boolean output of p feeds q.
    """
    drawn = (draw(parts()), draw(parts()))
    files = tuple(written(part.declared, part.items, name=f"part{k}") for k, part in enumerate(drawn, start=1))
    declared = [("INPUT", "REAL", "u", "[-1.5, 1]"), ("INPUT", "BOOL", "v", "")]
    outputs = [("OUTPUT", "REAL", "y", ""), ("OUTPUT", "BOOL", "w", "")]
    feeds = [("LINEAR", f"{name}.u0 = u;") for name, part in zip("pq", drawn, strict=True) if part.real_inputs]
    feeds += [("LOGIC", f"{name}.v0 = {source};")
              for name, part, source in zip("pq", drawn, ("v", "p.w0"), strict=True) if part.bool_inputs]  # fmt: skip
    feeds += [("OUTPUT", "y = p.y0 - q.y0;"), ("OUTPUT", "w = p.w0 & q.w0;")]
    preamble = "    MODULE { part1 p; part2 q; }\n"
    whole = written([*declared, *outputs], feeds, name="whole", preamble=preamble)
    inner, items = [], [(section, item.replace(".", "_")) for section, item in feeds]
    for name, part in zip("pq", drawn, strict=True):
        for role, type_, variable, limits in part.declared:
            inner.append(("STATE" if role == "STATE" else "AUX", type_, f"{name}_{variable}", limits))
        for section, item in part.items:
            kind = {"y": "LINEAR", "w": "LOGIC"}[item[0]] if section == "OUTPUT" else section
            items.append((kind, renamed(item, lambda variable, name=name: f"{name}_{variable}")))
    return whole, files, written([*declared, *outputs, *inner], items)
