"""Modules: the same model as the one with their text in it."""

import numpy as np
import pytest

import hysdel_py as hys

TANK = """SYSTEM tank {
  INTERFACE {
    PARAMETER { REAL area = 2; REAL n = 2; }
    STATE { REAL level(n) [0, 10]; /* [m] height */ }
    INPUT { REAL q [0, 1]; BOOL shut; }
    OUTPUT { REAL out; BOOL full(2); }
  }
  IMPLEMENTATION {
    AUX { INDEX i; BOOL high; REAL flow; }
    AD { high = level(1) >= 8; }
    DA { flow = {IF shut THEN 0 ELSE 0.1*level(1)}; }
    CONTINUOUS { FOR (i = 1:n) { level(i) = level(i) + (q - flow)/area; } }
    OUTPUT { out = flow; full = [high; ~high]; }
  }
}
"""
WHOLE = """SYSTEM whole {
  INTERFACE { MODULE { tank t1, t2; } STATE { REAL x [0, 1]; } INPUT { REAL u [0, 1]; } OUTPUT { REAL y; } }
  IMPLEMENTATION {
    LINEAR { t1.q = u; t2.q = t1.out; }
    LOGIC { t1.shut = t2.full(1); t2.shut = FALSE; }
    CONTINUOUS { x = 0.5*x; }
    OUTPUT { y = t2.level(1); }
  }
}
"""


def inlined():
    """The whole with its modules written into it; dots and brackets become underscores."""
    state, aux, items = "", "", ""
    for t in ("t1", "t2"):
        state += f"REAL {t}_l_1 [0, 10]; REAL {t}_l_2 [0, 10];"
        aux += f"REAL {t}_q [0, 1]; BOOL {t}_s; REAL {t}_out; BOOL {t}_f_1, {t}_f_2; BOOL {t}_high; REAL {t}_flow;"
        items += f"""AD {{ {t}_high = {t}_l_1 >= 8; }} DA {{ {t}_flow = {{IF {t}_s THEN 0 ELSE 0.1*{t}_l_1}}; }}
          CONTINUOUS {{ {t}_l_1 = {t}_l_1 + ({t}_q - {t}_flow)/2; {t}_l_2 = {t}_l_2 + ({t}_q - {t}_flow)/2; }}
          LINEAR {{ {t}_out = {t}_flow; }} LOGIC {{ {t}_f_1 = {t}_high; {t}_f_2 = ~{t}_high; }}"""
    return f"""SYSTEM whole {{ INTERFACE {{
      STATE {{ REAL x [0, 1]; {state} }} INPUT {{ REAL u [0, 1]; }} OUTPUT {{ REAL y; }} }}
      IMPLEMENTATION {{ AUX {{ {aux} }} LINEAR {{ t1_q = u; t2_q = t1_out; }} LOGIC {{ t1_s = t2_f_1; t2_s = FALSE; }}
      CONTINUOUS {{ x = 0.5*x; }} OUTPUT {{ y = t2_l_1; }} {items} }} }}"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "tank.hys").write_text(TANK)
    (tmp_path / "whole.hys").write_text(WHOLE)
    return tmp_path


def test_module_is_its_text(folder):
    ours, theirs = hys.load(folder / "whole.hys").mld, hys.load(inlined()).mld
    for name in ("A", "B1", "B2", "B3", "B5", "C", "D1", "D2", "D3", "D5", "E5"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name), err_msg=name)
    for name in ("E1", "E2", "E3", "E4"):
        np.testing.assert_array_equal(getattr(ours, name).toarray(), getattr(theirs, name).toarray(), err_msg=name)


def test_names_units_and_sizes(folder):
    model = hys.load(folder / "whole.hys")
    assert [v.name for v in model.dha.x] == ["x", *(f"t{k}.level({i})" for k in (1, 2) for i in (1, 2))]
    assert [v.name for v in model.dha.u] == ["u"]
    assert (model.dha.x[1].unit, model.dha.x[1].line) == ("m", 4)
    assert {"t1.q", "t1.out"} <= {v.name for v in model.dha.z}


def test_parameters_of_a_module(folder):
    model = hys.load(folder / "whole.hys", **{"t1.area": 4, "t2.n": 1})
    assert model.parameters["t1.area"] == 4
    assert [v.name for v in model.dha.x if v.name.startswith("t2")] == ["t2.level(1)"]


def test_search_path_and_model_as_text(folder, tmp_path_factory):
    assert hys.load(WHOLE, search_path=[folder]).mld.nx == 5
    with pytest.raises(hys.CompileError, match="HYS604"):
        hys.load(WHOLE, search_path=[tmp_path_factory.mktemp("empty")])
    for wrong in (str(folder), [3]):
        with pytest.raises(hys.ArgumentError, match="search_path"):
            hys.load(WHOLE, search_path=wrong)


def test_modules_of_modules(folder):
    (folder / "outer.hys").write_text(
        "SYSTEM o { INTERFACE { MODULE { whole w; } OUTPUT { REAL y; } } IMPLEMENTATION {"
        " LINEAR { w.u = 0.5; } OUTPUT { y = w.y + w.t2.level(2); } } }"
    )
    model = hys.load(folder / "outer.hys")
    assert [v.name for v in model.dha.x][:2] == ["w.x", "w.t1.level(1)"]
    assert model.dha.step([0, 1, 1, 2, 3])[1] == [5.0]


def test_mistake_in_a_module_shows_its_file(folder):
    (folder / "tank.hys").write_text(TANK.replace("out = flow", "out = flaw"))
    with pytest.raises(hys.CompileError) as caught:
        hys.load(folder / "whole.hys")
    assert "tank.hys:13:20" in str(caught.value)
    assert "t1.flaw is not declared" in str(caught.value)
    assert "OUTPUT { out = flaw;" in str(caught.value)


def test_syntax_error_in_a_module_shows_its_file(folder):
    (folder / "tank.hys").write_text("SYSTEM tank {\n  oops }")
    with pytest.raises(hys.CompileError, match=r"tank\.hys:2:3"):
        hys.load(folder / "whole.hys")


def test_open_comment_ends_with_its_file(folder):
    (folder / "whole.hys").write_text(WHOLE + "/* still open")
    assert hys.load(folder / "whole.hys").dha.x[1].unit == "m"


def test_files_that_contain_each_other(folder):
    (folder / "a.hys").write_text("SYSTEM a { INTERFACE { MODULE { b m; } } IMPLEMENTATION { } }")
    (folder / "b.hys").write_text("SYSTEM b { INTERFACE { MODULE { a m; } } IMPLEMENTATION { } }")
    with pytest.raises(hys.CompileError, match=r"a\.hys -> b\.hys -> a\.hys"):
        hys.load(folder / "a.hys")


def test_name_of_a_module_is_taken(folder):
    with pytest.raises(hys.CompileError, match="HYS202"):
        hys.load(WHOLE.replace("tank t1, t2", "tank t1, t2, x"), search_path=[folder])
