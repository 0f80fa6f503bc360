"""Modules beside an open file are found, and what is wrong in them has its place said in words."""

from hysdel_py.lsp.document import Document

LAG = """SYSTEM lag { INTERFACE { STATE { REAL s [0, 1]; } INPUT { REAL i; } OUTPUT { REAL q; } }
IMPLEMENTATION { CONTINUOUS { s = 0.5*s + i; } OUTPUT { q = s; } } }"""
WHOLE = """SYSTEM whole { INTERFACE { MODULE { lag a; } OUTPUT { REAL y; } }
  IMPLEMENTATION { LINEAR { a.i = 0; } OUTPUT { y = a.q; } } }"""


def test_modules_of_the_folder(tmp_path):
    (tmp_path / "lag.hys").write_text(LAG)
    assert [d.code.value for d in Document(WHOLE).diagnostics] == ["HYS604"]
    document = Document(WHOLE, "whole.hys", tmp_path)
    assert document.mld is not None
    assert all(d.span is None or d.span.end <= len(WHOLE) for d in document.diagnostics)


def test_mistakes_in_a_module_name_its_file(tmp_path):
    (tmp_path / "lag.hys").write_text(LAG.replace("+ i", "+ j"))
    found = Document(WHOLE, "whole.hys", tmp_path).diagnostics
    assert [(d.code.value, d.span) for d in found] == [("HYS201", None)]
    assert found[0].message == "lag.hys:2: a.j is not declared"


def test_names_of_a_wrong_text_over_vectors():
    text = """SYSTEM v { INTERFACE { PARAMETER { REAL A = [1; 2]; } STATE { REAL x(2) [0, 1]; } }
      IMPLEMENTATION { CONTINUOUS { x = nothing; } } }"""
    assert {"x(1)", "x(2)", "A(1)"} <= set(Document(text).symbols)
