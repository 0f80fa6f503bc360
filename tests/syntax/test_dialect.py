"""The dialects differ in the order of the logic operators and in nothing else."""

import random

import pytest
from golden_text import expression_text

import hysdel_py as hys
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.dialect import Dialect
from hysdel_py.syntax.formatter import format_text
from hysdel_py.syntax.parser import parse
from hysdel_py.syntax.source import Source

THREE = "/* dialect: hysdel 3 */\n"
ARROWS = ("->", "<-", "<->")
# Operators from weakest to strongest, as the page of the language lists them.
LOGIC_OF_2 = ({"|"}, set(ARROWS), {"&"})
LOGIC_OF_3 = ({"|"}, {"&"}, set(ARROWS))
MUST_OF_3 = (set(ARROWS), {"|"}, {"&"})


def text_with(expression, section):
    target = "" if section == "MUST" else "d = "
    return f"SYSTEM s {{ INTERFACE {{ }} IMPLEMENTATION {{ {section} {{ {target}{expression}; }} }} }}"


def parsed(text):
    sink = Sink()
    system = parse(Source("text", text), sink)
    assert not sink.failed
    return system


def tree(text):
    return expression_text(parsed(text).sections[0].items[0].value)


def meant(operands, operators, levels):
    """What a row of operands means where the operators of each level group from the left."""
    for level in levels:
        split = [k for k, operator in enumerate(operators) if operator in level]
        if split:
            k = split[-1]
            left = meant(operands[: k + 1], operators[:k], levels)
            right = meant(operands[k + 1 :], operators[k + 1 :], levels)
            return f"({operators[k]} {left} {right})"
    return operands[0]


@pytest.mark.parametrize(
    ("front", "section", "levels"),
    [
        ("", "LOGIC", LOGIC_OF_2),
        ("", "MUST", LOGIC_OF_2),
        ("/* dialect: hysdel 2 */", "MUST", LOGIC_OF_2),
        (THREE, "LOGIC", LOGIC_OF_3),
        (THREE, "MUST", MUST_OF_3),
    ],
)
def test_precedence_is_that_of_the_table(front, section, levels):
    draw = random.Random(7)
    for _ in range(150):
        count = draw.randint(1, 6)
        operators = [draw.choice(("|", "&", *ARROWS)) for _ in range(count)]
        names = [draw.choice("abc") for _ in range(count + 1)]
        negated = [draw.random() < 0.3 for _ in names]
        words = [("~" if n else "") + v for n, v in zip(negated, names, strict=True)]
        written = words[0] + "".join(f" {o} {w}" for o, w in zip(operators, words[1:], strict=True))
        operands = [f"(~ {v})" if n else v for n, v in zip(negated, names, strict=True)]
        assert tree(front + text_with(written, section)) == meant(operands, operators, levels), written


def test_parentheses_in_must_hold_a_logic_expression():
    assert tree(THREE + text_with("(a & b -> c)", "MUST")) == "[(& a (-> b c))]"
    assert tree(THREE + text_with("a & b -> (c & a -> b)", "MUST")) == "(-> (& a b) [(& c (-> a b))])"
    assert tree(THREE + text_with("FALSE | 1 <= 2 <= 3 -> a", "MUST")) == "(-> (| FALSE (& (<= 1 2) (<= 2 3))) a)"


@pytest.mark.parametrize(
    "front",
    [
        "/* dialect: hysdel 3 */",
        "// dialect: hysdel 3\n",
        "/* a */ /*  Dialect :  HYSDEL   3  */",
        "// a\n//dialect:hysdel 3\n",
    ],
)
def test_ways_to_state_it(front):
    assert parsed(front + text_with("a", "MUST")).dialect is Dialect.HYSDEL_3


def test_other_comments_state_nothing():
    assert parsed("/* dialect */ // the dialect: hysdel 3\n" + text_with("a", "MUST")).dialect is Dialect.HYSDEL_2


def test_chain_of_comparisons_is_no_mix():
    text = """/* dialect: hysdel 3 */ SYSTEM s { INTERFACE { INPUT { REAL v [0, 9]; BOOL u; } }
      IMPLEMENTATION { MUST { 1 <= v <= 2 <= 3 -> u; %s } } }"""
    assert not [d for d in hys.load(text % "").diagnostics if d.code is Code.MIXED_LOGIC]
    assert [d for d in hys.load(text % "1 <= v & v <= 2 -> u;").diagnostics if d.code is Code.MIXED_LOGIC]


def test_each_file_of_a_whole_has_its_own(tmp_path):
    inner = """SYSTEM gate { INTERFACE { INPUT { BOOL a, b; } OUTPUT { BOOL y; } }
      IMPLEMENTATION { OUTPUT { y = a & b -> a; } } }"""
    whole = """SYSTEM whole { INTERFACE { MODULE { gate g; } INPUT { BOOL p, q; } OUTPUT { BOOL y, w; } }
      IMPLEMENTATION { LOGIC { g.a = p; g.b = q; } OUTPUT { y = g.y; w = p & q -> p; } } }"""
    found = {}
    for name, front in (("two", ("", "")), ("inner", ("", THREE)), ("outer", (THREE, ""))):
        (tmp_path / "gate.hys").write_text(front[1] + inner)
        (tmp_path / "whole.hys").write_text(front[0] + whole)
        model = hys.load(tmp_path / "whole.hys")
        found[name] = model.dha.step([], [0, 0])[1].tolist()
    assert found == {"two": [1, 1], "inner": [0, 1], "outer": [1, 0]}


def test_layout_keeps_the_meaning_and_breaks_at_the_weakest():
    names = [f"quite_a_long_name_{k}" for k in range(8)]
    logic = " & ".join(f"{a} -> {b}" for a, b in zip(names[::2], names[1::2], strict=True))
    for front, section in ((THREE, "LOGIC"), (THREE, "MUST"), ("", "LOGIC")):
        text = front + text_with(logic, section)
        formatted = format_text(text)
        assert parsed(formatted) == parsed(text)
        assert format_text(formatted) == formatted
        assert formatted.count("(") == 0
        starts = {line.split()[0] for line in formatted.splitlines() if line.split()[0] in ("&", "->")}
        assert starts == ({"&"} if (front, section) == (THREE, "LOGIC") else {"->"})


@pytest.mark.parametrize(
    "comment", ["/** dialect: hysdel 3 */", "/*\n * dialect: hysdel 3\n */", "//// dialect: HYSDEL 3\n"]
)
def test_decorated_comments_state_a_dialect(comment):
    text = comment + "SYSTEM s { INTERFACE { STATE { BOOL x, y; } } IMPLEMENTATION { AUTOMATA { x = x & ~x -> y; } } }"
    assert hys.load(text).dha.step([0, 0])[0][0] == 0.0


@pytest.mark.parametrize("comment", ["/* the dialect: hysdel 3 */", "/* dialect hysdel 3 */"])
def test_a_comment_that_nearly_states_a_dialect_is_warned_of(comment):
    model = hys.load(comment + "SYSTEM s { INTERFACE { STATE { BOOL x; } } IMPLEMENTATION { AUTOMATA { x = x; } } }")
    assert [d.code.value for d in model.diagnostics] == ["HYS006"]
