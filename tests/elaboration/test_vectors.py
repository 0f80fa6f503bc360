"""Models over vectors and matrices are the same as those written out element by element."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import hysdel_py as hys

MATRICES = ("A", "B1", "B2", "B3", "B5", "C", "D1", "D2", "D3", "D5", "E5")


def same(left, right):
    """Whether two models have the same Mld, names of variables included."""
    left, right = left.mld, right.mld
    for group in "xuydz":
        ours, theirs = ([(v.name, v.type, v.low, v.high) for v in getattr(m, group)] for m in (left, right))
        renamed = [(name.replace("_", "(", 1) + ")" if index(name) else name, *rest) for name, *rest in theirs]
        assert ours == renamed
    for name in MATRICES:
        np.testing.assert_array_equal(getattr(left, name), getattr(right, name), err_msg=name)
    for name in ("E1", "E2", "E3", "E4"):
        np.testing.assert_array_equal(getattr(left, name).toarray(), getattr(right, name).toarray(), err_msg=name)


def index(name):
    """Whether a name of a scalar model stands for an element: x_2, W_2,1 cannot be written and is x_2_1."""
    return not name.startswith("__") and "_" in name


def system(interface, implementation):
    return f"SYSTEM s {{ INTERFACE {{ {interface} }} IMPLEMENTATION {{ {implementation} }} }}"


VECTOR = system(
    """STATE { REAL x(2) [-1, 1; -2, 3]; BOOL on(2); } INPUT { REAL u [0, 1]; } OUTPUT { REAL y(2); }
       PARAMETER { REAL A = [1, 0.1; 0, k]; REAL B(2,1); REAL k = 3; }""",
    """AUX { REAL z(2); BOOL low(2), any; }
       AD { low = x <= [0.5; 1]; }
       LOGIC { any = low(1) | low(2); }
       DA { z = {IF on(1) & any THEN A*x + B*u ELSE [0; x(2)]}; }
       CONTINUOUS { x = 0.5*z; } AUTOMATA { on = ~on & low; } OUTPUT { y = x([2, 1]) + 1; }
       MUST { x <= 0.9; u >= [0; 0]; on -> low; }""",
)
SCALAR = system(
    """STATE { REAL x_1 [-1, 1]; REAL x_2 [-2, 3]; BOOL on_1, on_2; } INPUT { REAL u [0, 1]; } OUTPUT { REAL y_1, y_2; }
       PARAMETER { REAL k = 3; }""",
    """AUX { REAL z_1, z_2; BOOL low_1, low_2, any, c; }
       AD { low_1 = x_1 <= 0.5; low_2 = x_2 <= 1; }
       LOGIC { any = low_1 | low_2; }
       DA { z_1 = {IF c THEN x_1 + 0.1*x_2 + 5*u ELSE 0}; z_2 = {IF c THEN 0*x_1 + k*x_2 + 7*u ELSE x_2}; }
       CONTINUOUS { x_1 = 0.5*z_1; x_2 = 0.5*z_2; } AUTOMATA { on_1 = ~on_1 & low_1; on_2 = ~on_2 & low_2; }
       OUTPUT { y_1 = x_2 + 1; y_2 = x_1 + 1; }
       MUST { x_1 <= 0.9; x_2 <= 0.9; u >= 0; u >= 0; on_1 -> low_1; on_2 -> low_2; }
       LOGIC { c = on_1 & any; }""",
)


def test_vector_model_is_its_expansion():
    """The condition is shared by the elements, so the expansion names it; only its column is elsewhere."""
    ours, theirs = hys.load(VECTOR, B=[5, 7]).mld, hys.load(SCALAR).mld
    assert [v.name for v in ours.d] == ["low(1)", "low(2)", "any", *(f"__additional_{k}" for k in (1, 2, 3))]
    assert (ours.ne, ours.nd, ours.nz) == (theirs.ne, theirs.nd, theirs.nz)
    np.testing.assert_array_equal(ours.A, theirs.A)
    np.testing.assert_array_equal(np.sort(ours.E5), np.sort(theirs.E5))
    for seed in range(40):
        generator = np.random.default_rng(seed)
        x = np.r_[generator.uniform([-1, -2], [1, 3]), generator.integers(0, 2, 2)]
        answers = []
        for mld in (ours, theirs):
            try:
                answers.append(np.hstack(mld.step(x, generator.uniform(0, 1, 1) * 0 + 0.5)[:2]))
            except hys.SimulationError:
                answers.append(None)
        assert (answers[0] is None) == (answers[1] is None)
        if answers[0] is not None:
            np.testing.assert_allclose(answers[0], answers[1], atol=1e-9)


@st.composite
def linear_systems(draw):
    """Sizes, matrices and an operation of a vector model, and its expansion as text."""
    n, m = draw(st.integers(1, 3)), draw(st.integers(1, 3))
    number = st.integers(-3, 3)
    A = draw(st.lists(st.lists(number, min_size=n, max_size=n), min_size=n, max_size=n))
    B = draw(st.lists(st.lists(number, min_size=m, max_size=m), min_size=n, max_size=n))
    limits = draw(st.lists(number, min_size=n, max_size=n))
    sign = draw(st.sampled_from(["<=", ">=", "<", ">"]))
    return n, m, A, B, limits, sign


def literal(matrix):
    return "[" + "; ".join(", ".join(map(str, row)) for row in matrix) + "]"


def row_times(row, name):
    return " + ".join(f"({a})*{name}_{j}" for j, a in enumerate(row, start=1))


@settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(linear_systems())
def test_random_linear_systems(drawn):
    n, m, A, B, limits, sign = drawn
    vector = hys.load(
        system(
            f"STATE {{ REAL x({n}) [-1, 2]; }} INPUT {{ REAL u({m}) [0, 1]; }} OUTPUT {{ REAL y({n}); }}"
            f" PARAMETER {{ REAL A = {literal(A)}; REAL B({n},{m}); REAL c({n}) = {literal([[v] for v in limits])}; }}",
            f"AUX {{ BOOL d({n}); REAL z({n}); }} AD {{ d = A*x {sign} c; }}"
            "DA { z = {IF d THEN A*x + B*u ELSE -x}; } CONTINUOUS { x = 0.1*z + 1; } OUTPUT { y = (REAL d); }"
            "MUST { x - c <= 9; }",
        ),
        B=B,
    )

    def each(text):
        return " ".join(text(i) for i in range(1, n + 1))

    Ax = [row_times(row, "x") for row in A]
    Bu = [row_times(row, "u") for row in B]
    scalar = hys.load(
        system(
            f"STATE {{ {each(lambda i: f'REAL x_{i} [-1, 2];')} }}"
            f"INPUT {{ {' '.join(f'REAL u_{j} [0, 1];' for j in range(1, m + 1))} }}"
            f"OUTPUT {{ {each(lambda i: f'REAL y_{i};')} }}",
            f"AUX {{ {each(lambda i: f'BOOL d_{i}; REAL z_{i};')} }}"
            f"AD {{ {each(lambda i: f'd_{i} = {Ax[i - 1]} {sign} {limits[i - 1]};')} }}"
            + f"DA {{ {each(lambda i: f'z_{i} = {{IF d_{i} THEN {Ax[i - 1]} + ({Bu[i - 1]}) ELSE -x_{i}}};')} }}"
            f"CONTINUOUS {{ {each(lambda i: f'x_{i} = 0.1*z_{i} + 1;')} }}"
            f"OUTPUT {{ {each(lambda i: f'y_{i} = (REAL d_{i});')} }}"
            f"MUST {{ {each(lambda i: f'x_{i} - ({limits[i - 1]}) <= 9;')} }}",
        )
    )
    same(vector, scalar)


@pytest.mark.parametrize(
    ("loop", "unrolled"),
    [
        (
            "LINEAR { FOR (i = 1:3) { z(i) = i*x(4 - i) + n; } }",
            "z(1) = x(3) + n; z(2) = 2*x(2) + n; z(3) = 3*x(1) + n;",
        ),
        (
            "LINEAR { z(1) = x(1); FOR (i = 2:n) { z(i) = z(i-1) + x(i); } }",
            "z(1) = x(1); z(2) = z(1) + x(2); z(3) = z(2) + x(3);",
        ),
        ("LINEAR { FOR (i = 1:0) { z(i) = x(i); } z = x; }", "z = x;"),
        (
            "LINEAR { FOR (i = 1:1) { FOR (j = i+1:n) { z(j) = W(i, j)*x(j); } z(i) = x(1:1); } }",
            "z(2) = 8*x(2); z(3) = 9*x(3); z(1) = x(1);",
        ),
    ],
)
def test_loop_is_its_unrolling(loop, unrolled):
    interface = "STATE { REAL x(3) [0, 1]; } PARAMETER { REAL n = 3; REAL W = [7, 8, 9]; }"
    frame = "AUX {{ INDEX i, j; REAL z(n); }} {} CONTINUOUS {{ x = z; }}"
    same(
        hys.load(system(interface, frame.format(loop))),
        hys.load(system(interface, frame.format(f"LINEAR {{ {unrolled} }}"))),
    )


def test_loops_in_every_section():
    model = hys.load(
        system(
            "STATE { REAL x(2) [-1, 1]; BOOL b(2); } OUTPUT { REAL y(2); BOOL w(2); }",
            """AUX { INDEX k; BOOL d(2), e(2); REAL z(2); }
               AD { FOR (k = 1:2) { d(k) = x(k) >= 0; } } LOGIC { FOR (k = 1:2) { e(k) = d(3-k) & b(k); } }
               DA { FOR (k = 1:2) { z(k) = {IF e(k) THEN x(k)}; } } CONTINUOUS { FOR (k = 1:2) { x(k) = z(k); } }
               AUTOMATA { FOR (k = 1:2) { b(k) = ~e(k); } } OUTPUT { FOR (k = 1:2) { y(k) = x(k); w(k) = d(k); } }
               MUST { FOR (k = 1:2) { x(k) <= 1; } }""",
        )
    )
    x1 = model.dha.step([0.5, -0.5, 1, 1])[0]
    assert x1.tolist() == [0, -0.5, 1, 0]
    assert model.mld.step([0.5, -0.5, 1, 1])[0].tolist() == pytest.approx(x1.tolist())


def test_one_condition_for_all_elements():
    model = hys.load(VECTOR, B=[5, 7])
    conditions = {item.condition.name for item in model.dha.items if type(item).__name__ == "Switch"}
    assert len(conditions) == 1


def test_units_reach_every_element():
    model = hys.load(system("STATE { REAL x(2) [0, 1]; /* [m] level */ }", ""))
    assert [(v.name, v.unit) for v in model.dha.x] == [("x(1)", "m"), ("x(2)", "m")]


def test_matrices_are_laid_out_row_by_row():
    model = hys.load(system("STATE { REAL W(2,2) [0, 1; 2, 3; 4, 5; 6, 7]; }", "CONTINUOUS { W(1:2,2) = [1; 2]; }"))
    assert [(v.name, v.low) for v in model.dha.x] == [("W(1,1)", 0), ("W(1,2)", 2), ("W(2,1)", 4), ("W(2,2)", 6)]
    assert model.dha.step([0, 2, 4, 6])[0].tolist() == [0, 1, 0, 2]


def test_bounds_may_be_vectors():
    text = system("PARAMETER { REAL high = [1; 2]; } STATE { REAL x(2) [0, high]; }", "")
    assert [v.high for v in hys.load(text).dha.x] == [1, 2]


def test_sizes_may_be_given():
    text = system("PARAMETER { REAL n; REAL g(n); } STATE { REAL x(n) [0, 1]; }", "CONTINUOUS { x = g*0.1; }")
    assert len(hys.load(text, n=3, g=[1, 2, 3]).dha.x) == 3
    with pytest.raises(hys.CompileError, match="HYS603"):
        hys.load(text)


@pytest.mark.parametrize("given_value", [[1, 2], [[1, 2, 3]], [[[1]]], 4, "abc", [1, "x", 2], None])
def test_given_matrix_has_to_fit(given_value):
    with pytest.raises(hys.CompileError):
        hys.load(system("PARAMETER { REAL g(3); } STATE { REAL x(3) [0, 1]; }", ""), g=given_value)


@pytest.mark.parametrize(
    ("item", "code", "words"),
    [
        ("z = x + [1, 2];", "HYS601", "2-by-1 and 1-by-2"),
        ("z = [1; 2; 3];", "HYS601", "2-by-1 and 3-by-1"),
        ("z = A*[1, 2];", "HYS601", "2-by-2 and 1-by-2"),
        ("z(1) = x;", "HYS601", "a scalar and 2-by-1"),
        ("z = x/[1; 2];", "HYS601", "there is no /"),
        ("z = [x, [1; 2; 3]];", "HYS601", "2-by-1 and 3-by-1"),
        ("z = [1, 2; 3];", "HYS601", "1-by-2 and a scalar"),
        ("z(3) = 1;", "HYS602", "z has no element 3: it is 2-by-1"),
        ("z(0) = 1;", "HYS602", "z has no element 0"),
        ("z(1) = x(1.5);", "HYS603", "whole number, this is 1.5"),
        ("z(1) = x(x(1));", "HYS603", "whole number"),
        ("z(1) = A(1);", "HYS602", "takes two indices"),
        ("z(1) = a(1);", "HYS602", "a is a scalar"),
        ("z(1) = q(1);", "HYS201", "q is not declared"),
        ("z(1) = x(2:1);", "HYS602", "empty"),
        ("z(1) = i;", "HYS602", "only inside its FOR"),
        ("i = 1;", "HYS602", "only inside its FOR"),
        ("FOR (i = 1:2) { i = 1; }", "HYS303", "iterator"),
        ("FOR (q = 1:2) { z(q) = 1; }", "HYS201", "iterator q is not declared"),
        ("FOR (i = 1:2) { FOR (i = 1:2) { z(i) = 1; } }", "HYS602", "counts the FOR around"),
        ("FOR (i = 1:1e9) { z(1) = 1; }", "HYS603", "passes"),
        ("FOR (i = 1:x(1)) { z(1) = 1; }", "HYS603", "an end of FOR"),
        ("FOR (i = 1:2) { z(1) = x(i); }", "HYS304", "z(1) is already defined"),
    ],
)
def test_mistakes(item, code, words):
    interface = "STATE { REAL x(2) [0, 1]; } PARAMETER { REAL a = 2; REAL A = [1, 2; 3, 4]; }"
    with pytest.raises(hys.CompileError) as caught:
        hys.load(system(interface, f"AUX {{ INDEX i; REAL z(2); }} LINEAR {{ {item} }}"))
    assert code in [d.code.value for d in caught.value.diagnostics]
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("interface", "code"),
    [
        ("STATE { REAL x(0); }", "HYS603"),
        ("STATE { REAL x(1e9); }", "HYS603"),
        ("STATE { REAL x(1e5, 1e5); }", "HYS603"),
        ("STATE { REAL x(2) [0, 1; 2, 3; 4, 5]; }", "HYS601"),
        ("STATE { REAL x(2); BOOL x; }", "HYS202"),
        ("PARAMETER { REAL A(2,2) = [1, 2]; }", "HYS601"),
        ("PARAMETER { REAL n = m; REAL m = n; } STATE { REAL x(n); }", "HYS603"),
        ("STATE { REAL a.b; }", "HYS101"),
    ],
)
def test_mistakes_in_declarations(interface, code):
    with pytest.raises(hys.CompileError) as caught:
        hys.load(system(interface, ""))
    assert code in [d.code.value for d in caught.value.diagnostics]


def test_words_of_later_dialects_are_names_where_they_were():
    text = """SYSTEM MODULE { INTERFACE { STATE { REAL FOR [0, 1], INDEX [0, 1]; } }
      IMPLEMENTATION { CONTINUOUS { FOR = INDEX; INDEX = FOR; } } }"""
    assert [v.name for v in hys.load(text).dha.x] == ["FOR", "INDEX"]


def test_deep_vector_expressions():
    depth = 3000
    model = hys.load(system("STATE { REAL x(2) [0, 1]; }", f"CONTINUOUS {{ x = {'-(' * depth}x{')' * depth}; }}"))
    assert model.dha.step([0.5, 1])[0].tolist() == [0.5, 1]
