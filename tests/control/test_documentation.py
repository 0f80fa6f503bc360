"""The examples of docs/hybrid-mpc.md run, and so do those of the docstrings."""

from __future__ import annotations

import doctest
import importlib
import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "hybrid-mpc.md"


def test_examples_of_the_page(capsys):
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) >= 3
    scope: dict[str, object] = {}
    for block in blocks:
        exec(block, scope)
    assert capsys.readouterr().out.startswith("[")
    assert scope["run"]["T"][19] == pytest.approx(21, abs=1.5)
    assert scope["run"]["T"][40] == pytest.approx(17, abs=1.5)


@pytest.mark.parametrize("module", ["costs", "limits", "hybrid_mpc", "closed_loop"])
def test_examples_of_docstrings(module):
    assert doctest.testmod(importlib.import_module(f"hysdel_py.control.{module}")).failed == 0
