"""docs/errors.md has a section for every code, and its examples cause what they are examples of."""

import re
from pathlib import Path

import pytest
from diagnostics.expectations import diagnostics_of

from hysdel_py.diagnostics.codes import Code

PAGE = (Path(__file__).parents[2] / "docs" / "errors.md").read_text(encoding="utf-8")
FRAME = """SYSTEM example {
INTERFACE { STATE { REAL x [-1, 1]; BOOL b; } INPUT { REAL u [0, 1]; } OUTPUT { REAL y; }
  PARAMETER { REAL a = 2; BOOL q = TRUE; } }
IMPLEMENTATION { %s CONTINUOUS { x = u; } AUTOMATA { b = b; } OUTPUT { y = x; } }
}
"""


def sections():
    """Text of each section by its code."""
    parts = re.split(r"^### (HYS\d{3}): .*$", PAGE, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


@pytest.mark.parametrize("code", Code, ids=lambda code: code.name)
def test_every_code_has_a_section(code):
    assert len(sections()[code.value].split()) > 10


def test_no_section_is_left_over():
    assert set(sections()) == {code.value for code in Code}


@pytest.mark.parametrize(
    "code", [c for c in Code if "```hys" in sections().get(c.value, "")], ids=lambda code: code.name
)
def test_example_causes_its_code(code, tmp_path):
    example = re.search(r"```hys\n(.*?)```", sections()[code.value], re.DOTALL)[1]
    path = tmp_path / "example.hys"
    path.write_text(example if example.startswith(("SYSTEM", "/*")) else FRAME % example)
    found = {d.code for d in diagnostics_of(path)}
    assert code in found
    assert all(other is code for other in found if other.value < "HYS500"), "the example has another error as well"
