"""Operators, precedence, numbers, comments."""

import pytest
from golden_text import ast_text, expression_text, parsed

import hysdel_py as hys
from hysdel_py.syntax import ast


def system_with(expression, section="LOGIC", target="d = "):
    return f"SYSTEM s {{ INTERFACE {{ }} IMPLEMENTATION {{ {section} {{ {target}{expression}; }} }} }}"


def tree(expression):
    return parsed(system_with(expression)).sections[0].items[0].value


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        # real operators: + -  <  * /  <  ^  <  unary minus, all from left to right
        ("a + b * c", "(+ a (* b c))"),
        ("a - b - c", "(- (- a b) c)"),
        ("a / b * c", "(* (/ a b) c)"),
        ("a * b ^ c", "(* a (^ b c))"),
        ("a ^ b ^ c", "(^ (^ a b) c)"),
        ("-2^2", "(^ (-x 2) 2)"),
        ("2^-2", "(^ 2 (-x 2))"),
        ("2*-3", "(* 2 (-x 3))"),
        ("--1", "(-x (-x 1))"),
        ("a - -b", "(- a (-x b))"),
        ("a--b", "(- a (-x b))"),
        ("-(a + b)*c", "(* (-x [(+ a b)]) c)"),
        ("sin(a) + 1", "(+ (sin a) 1)"),
        ("-sqrt(a)^2", "(^ (-x (sqrt a)) 2)"),
        # logic: |  <  -> <- <->  <  &  <  ~
        ("a | b -> c", "(| a (-> b c))"),
        ("a -> b | c", "(| (-> a b) c)"),
        ("a & b -> c & d", "(-> (& a b) (& c d))"),
        ("a -> b -> c", "(-> (-> a b) c)"),
        ("a <-> b <- c", "(<- (<-> a b) c)"),
        ("~a & b", "(& (~ a) b)"),
        ("~~a", "(~ (~ a))"),
        ("!a || b && c", "(| (~ a) (& b c))"),
        ("a | b | c", "(| (| a b) c)"),
        ("a & (b | c)", "(& a [(| b c)])"),
        # comparisons bind tighter than logic, looser than arithmetic
        ("a + 1 <= b - 1", "(<= (+ a 1) (- b 1))"),
        ("a >= b & c", "(& (>= a b) c)"),
        # casts take any expression and their own parentheses
        ("2*(REAL a & ~b)", "(* 2 ((REAL) (& a (~ b))))"),
        ("(REAL a | b -> c)", "((REAL) (| a (-> b c)))"),
        # what only looks like an operator or keyword
        ("a<-b", "(<- a b)"),
        ("a< -b", "(< a (-x b))"),
        ("TRUE & FALSE", "(& TRUE FALSE)"),
        ("TRUEx", "TRUEx"),
        ("sinus", "sinus"),
        ("sin_1", "sin_1"),
        ("true", "true"),
        ("REALx", "REALx"),
    ],
)
def test_precedence(written, meant):
    if meant is None:
        with pytest.raises(hys.CompileError):
            tree(written)
    else:
        assert expression_text(tree(written)) == meant


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1.0), ("007", 7.0), ("1.", 1.0), (".5", 0.5), ("0.25", 0.25), ("1e3", 1000.0), ("1.5e-3", 0.0015),
        ("2e+1", 20.0), ("1E2", 100.0), (".5E-1", 0.05), ("123456789012345678", 123456789012345678.0),
        ("1e-400", 0.0), ("0.1", 0.1),
    ],
)  # fmt: skip
def test_number(text, value):
    number = tree(text)
    assert isinstance(number, ast.Number)
    assert number.value == value
    assert number.text == text


@pytest.mark.parametrize("text", ["1e", "1.2.3", "1 2", "e5x 1", "1x", "0x10", "1_000"])
def test_not_a_number(text):
    with pytest.raises(hys.CompileError):
        tree(text)


@pytest.mark.parametrize(
    "comment",
    ["/**/", "/* a */", "/***/", "/* * / */", "/* // \n\n */", "/* /* not nested */", "/* \u00e9 \u2212 \u4e2d */"],
)
def test_comment_counts_as_space(comment):
    assert expression_text(tree(f"a{comment}&{comment}b")) == "(& a b)"


@pytest.mark.parametrize("comment", ["/* a */ */", "*/", "/ * a */", "/ / a"])
def test_not_a_comment(comment):
    with pytest.raises(hys.CompileError):
        tree(f"a {comment} & b")


def test_unterminated_comment_at_the_end_is_accepted():
    assert parsed("SYSTEM s { INTERFACE { } IMPLEMENTATION { } } /* and so on").name == "s"


def test_sections_may_repeat_come_in_any_order_and_be_empty():
    text = """SYSTEM s {
      INTERFACE { OUTPUT { REAL y; } STATE { REAL x; } STATE { BOOL b; } }
      IMPLEMENTATION { MUST { } OUTPUT { y = x; } AD { } DA { } LOGIC { } LINEAR { } CONTINUOUS { x = x; } OUTPUT { }
        AUTOMATA { b = b; } }
    }"""
    assert ast_text(parsed(text)).split("\n")[1:4] == ["  OUTPUT", "    REAL y", "  STATE"]


def test_spans_are_exact():
    text = system_with("aa &  (b | c)")
    system = parsed(text)
    value = system.sections[0].items[0].value
    assert text[value.span.start : value.span.end] == "aa &  (b | c)"
    group = value.args[1]
    assert text[group.span.start : group.span.end] == "(b | c)"
    assert text[system.span.start : system.span.end] == text


def test_equality_ignores_places():
    assert tree("a &   b") == tree("a & b")
    assert tree("a & b") != tree("b & a")


def test_long_names_are_fine():
    name = "a" * 300
    assert expression_text(tree(name)) == name


@pytest.mark.parametrize("text", ["", " \n\t", "/* only */", "/* open"])
def test_text_without_system_is_empty_with_a_warning(text, tmp_path):
    path = tmp_path / "empty.hys"
    path.write_text(text)
    model = hys.load(path)
    assert [d.code.value for d in model.diagnostics] == ["HYS005"]
    assert model.mld.nx == 0
    assert [v.size for v in model.dha.step(())] == [0, 0, 0, 0]


def test_expected_tokens_are_in_words():
    with pytest.raises(hys.CompileError, match="expected an expression, found '\\)'"):
        tree("a & )")
    with pytest.raises(hys.CompileError, match="expected a name, found '1'"):
        hys.load("SYSTEM 1 {")
    with pytest.raises(hys.CompileError, match="found the end of the file"):
        hys.load("SYSTEM s {")
