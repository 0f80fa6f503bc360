"""A missing brace is shown where it is most likely missing: at the loop, if that is what indentation says."""

import pytest

import hysdel_py as hys
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.parser import parse
from hysdel_py.syntax.source import Source

FRAME = """SYSTEM s {{
  INTERFACE {{ STATE {{ REAL x(3) [0, 1]; }} }}
  IMPLEMENTATION {{
    AUX {{ INDEX i, j; REAL z(3); }}
    {0}
    CONTINUOUS {{ x = z; }}
  }}
}}
"""
LOOP = "FOR (i = 1:3) {"


@pytest.mark.parametrize(
    ("items", "line", "column"),
    [
        (f"LINEAR {{\n      {LOOP}\n        z(i) = x(i);\n    }}", 6, 21),
        (f"LINEAR {{\n      {LOOP}\n        z(i) = x(i);\n      }}", 5, 12),
        (f"LINEAR {{\n      {LOOP} z(i) = x(i); }}", 5, 12),
        (f"LINEAR {{ {LOOP} z(i) = x(i); }}", 5, 28),
        (f"LINEAR {{\n      {LOOP}\n        FOR (j = 1:1) {{\n          z(i) = x(i);\n      }}\n    }}", 7, 23),
        ("LINEAR {\n      z = x;", 5, 12),
    ],
)
def test_place(items, line, column):
    with pytest.raises(hys.CompileError) as error:
        hys.load(FRAME.format(items))
    first = error.value.data[0]
    assert (first["code"], first["line"], first["column"]) == ("HYS105", line, column)


def test_an_earlier_error_does_not_make_a_sound_file_unreadable():
    sink = Sink()
    sink.error(Code.MODULE, "something else")
    assert parse(Source("text", FRAME.format("LINEAR { z = x; }")), sink) is not None
    assert parse(Source("text", "SYSTEM"), sink) is None
    assert parse(Source("text", "/* nothing */"), sink) is not None
