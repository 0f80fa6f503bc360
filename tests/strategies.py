"""Random valid models as text, for property tests.

A model is drawn as a list of auxiliaries, each defined by an item that reads only earlier names, so that no algebraic
loop can arise; updates, outputs and requirements read any of them. All real names have ranges, declared or derived.
"""

from __future__ import annotations

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
        sign = draw(st.sampled_from(["<=", ">="]))
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


@st.composite
def models(draw: st.DrawFn) -> str:
    """The text of a valid model without undefined names or loops."""
    reals, bools = draw(st.integers(1, 2)), draw(st.integers(0, 2))
    real_inputs, bool_inputs = draw(st.integers(0, 1)), draw(st.integers(0, 1))
    states = [f"x{i}" for i in range(reals)]
    modes = [f"b{i}" for i in range(bools)]
    names = Names([*states, *(["u0"] * real_inputs)], [*modes, *(["v0"] * bool_inputs)])
    auxiliaries = []
    for index in range(draw(st.integers(1, 5))):
        auxiliaries.append(draw(auxiliary(names, index)))
        _, type_, name, _ = auxiliaries[-1]
        (names.reals if type_ == "REAL" else names.bools).append(name)
    sections = [_section(section, [item]) for section, _, _, item in draw(st.permutations(auxiliaries))]
    sections.append(_section("CONTINUOUS", [f"{x} = {draw(affine(names))};" for x in states]))
    sections.append(_section("AUTOMATA", [f"{b} = {draw(logic(names))};" for b in modes]))
    outputs = [f"y0 = {draw(affine(names))};", f"w0 = {draw(logic(names))};"]
    sections.append(_section("OUTPUT", outputs))
    if draw(st.booleans()):
        sections.append(_section("MUST", [draw(requirement(names)) + ";"]))
    return _file(states, modes, real_inputs, bool_inputs, auxiliaries, draw(st.permutations(sections)))


@st.composite
def requirement(draw: st.DrawFn, names: Names) -> str:
    """An item of MUST."""
    if draw(st.booleans()):
        return draw(logic(names))
    return f"{draw(affine(names))} {draw(st.sampled_from(['<=', '>=']))} {draw(affine(names, casts=False))}"


def _section(keyword: str, items: list[str]) -> str:
    return f"    {keyword} {{\n" + "".join(f"      {item}\n" for item in items) + "    }\n"


def _file(
    states: list[str], modes: list[str], real_inputs: int, bool_inputs: int, auxiliaries: list, sections: list[str]
) -> str:
    declared = "".join(f"      REAL {x} [-{i + 2}, {i + 3}.5];\n" for i, x in enumerate(states))
    declared += "".join(f"      BOOL {b};\n" for b in modes)
    inputs = "      REAL u0 [-1.5, 1];\n" * real_inputs + "      BOOL v0;\n" * bool_inputs
    auxiliary_text = "".join(f"      {type_} {name};\n" for _, type_, name, _ in auxiliaries)
    return (
        "SYSTEM random {\n  INTERFACE {\n    PARAMETER { REAL a = 0.75; }\n"
        f"    STATE {{\n{declared}    }}\n"
        + (f"    INPUT {{\n{inputs}    }}\n" if inputs else "")
        + "    OUTPUT { REAL y0; BOOL w0; }\n  }\n  IMPLEMENTATION {\n"
        f"    AUX {{\n{auxiliary_text}    }}\n" + "".join(sections) + "  }\n}\n"
    )
