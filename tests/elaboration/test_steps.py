"""Steps of loops and ranges, all of an index, transposes: each against what it stands for."""

import pytest

import hysdel_py as hys
from hysdel_py.syntax.formatter import format_text

FRAME = """SYSTEM s {{
  INTERFACE {{
    PARAMETER {{ REAL n = 4; REAL A = [1, 2; 3, 4; 5, 6]; REAL r = [7, 8, 9]; }}
    STATE {{ REAL x(n) [-9, 9]; REAL W(2,3) [0, 1]; }}
  }}
  IMPLEMENTATION {{ AUX {{ INDEX i, j; REAL z(6); REAL Z(2,3); }} LINEAR {{ {0} }} }}
}}
"""


def rows(items):
    mld = hys.load(FRAME.format(items)).mld
    return mld.E3.toarray().tolist(), mld.E4.toarray().tolist(), mld.E5.tolist()


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("FOR (i = 1:2:n) { z(i) = x(i); }", "z(1) = x(1); z(3) = x(3);"),
        ("FOR (i = n:-1:3) { z(i) = x(i); }", "z(4) = x(4); z(3) = x(3);"),
        ("FOR (i = 1:n-2:6) { z(i) = i; }", "z(1) = 1; z(3) = 3; z(5) = 5;"),
        (
            "FOR (i = 3:-1:1) { FOR (j = i:3:6) { z(j) = i; } }",
            "z(3) = 3; z(6) = 3; z(2) = 2; z(5) = 2; z(1) = 1; z(4) = 1;",
        ),
        ("FOR (i = 3:1) { z(i) = x(i); }", ""),
        ("FOR (i = 1:-1:3) { z(i) = x(i); }", ""),
        ("z(1:2) = x(4:-3:1);", "z(1) = x(4); z(2) = x(1);"),
        ("z(1:2:5) = r';", "z(1) = 7; z(3) = 8; z(5) = 9;"),
        ("z(1:4) = x(:);", "z(1:4) = x;"),
        ("z = W(:);", "z = [W(1,1); W(2,1); W(1,2); W(2,2); W(1,3); W(2,3)];"),
        ("z(1:3) = r(:);", "z(1:3) = [7; 8; 9];"),
        ("z(1:2) = W(:,2);", "z(1:2) = [W(1,2); W(2,2)];"),
        ("z(1:3) = W(2,:)';", "z(1:3) = [W(2,1); W(2,2); W(2,3)];"),
        ("Z = A' - -W'';", "Z = [1, 3, 5; 2, 4, 6] + W;"),
        ("z(1:2) = A'*x(1:3);", "z(1:2) = [x(1) + 3*x(2) + 5*x(3); 2*x(1) + 4*x(2) + 6*x(3)];"),
        ("z(1) = (A(2,1)')'*x(1);", "z(1) = 3*x(1);"),
        ("z(1) = r*W(1,:)';", "z(1) = 7*W(1,1) + 8*W(1,2) + 9*W(1,3);"),
    ],
)
def test_stands_for(written, meant):
    assert rows(written) == rows(meant)
    text = FRAME.format(written)
    formatted = format_text(text)
    assert format_text(formatted) == formatted
    assert hys.load(formatted).mld.E5.tolist() == hys.load(text).mld.E5.tolist()


def test_layout_of_a_transpose():
    assert "z(1) = r'*r + A(:, 1)' - x(n:-1:1)';" in format_text(FRAME.format("z(1)=r '*r+A(:,1)'-x(n:-1:1)';"))


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("FOR (i = 1:0:n) { z(i) = x(i); }", "HYS602.*: the step of FOR is 0"),
        ("FOR (i = 1:0.5:n) { z(i) = x(i); }", "the step of FOR has to be a whole number, this is 0.5"),
        ("z(1) = x(3:1);", "the range 3:1 is empty or too long"),
        ("z(1) = x(1:-1:3);", "the range 1:-1:3 is empty or too long"),
        ("z(1:0:2) = x(1:2);", "the step of a range is 0"),
        ("z(1) = z(:);", "sizes do not match: left and right side of a scalar and 6-by-1"),
        ("z(1) = :;", "HYS102"),
        ("z(1) = 'x;", "HYS102"),
    ],
)
def test_mistakes(written, message):
    with pytest.raises(hys.CompileError, match=message):
        hys.load(FRAME.format(written))
