"""Feedback tables in C against the same tables in Python."""

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

from hysdel_py.control.dynamic_programming.grids import Axis
from hysdel_py.control.dynamic_programming.problem import DynamicProgram
from hysdel_py.errors import ArgumentError
from hysdel_py.export.table_c import table_to_c

COMPILER = shutil.which("gcc") or shutil.which("cc")


def problem(remember=True):
    def change(a, u):
        return np.where(np.abs(a - u).max(axis=1) <= 1, np.abs(a - u).sum(axis=1), np.inf)

    return DynamicProgram(
        lambda x, u: np.stack([x[:, 0] + 0.4 * x[:, 1], 0.9 * x[:, 1] + 0.3 * u[:, 0] - 0.1 * u[:, 1]], axis=1),
        (Axis("s", -2, 2, 9, "m"), Axis("v", -1, 1, 7)), (Axis("a", -2, 2, 5), Axis("b", 0, 1, 2)), 3,
        lambda x, u, x1: (x1**2).sum(axis=1) + 0.1 * u[:, 1], end_set=lambda x: np.abs(x[:, 0]) < 1.2,
        change_cost=change if remember else None,
    )  # fmt: skip


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
@pytest.mark.parametrize("remember", [True, False])
def test_c_equals_python(remember, tmp_path):
    table = problem(remember).backward()
    source, _ = table.to_c(tmp_path / "law.c")
    library = tmp_path / "law.so"
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-shared", "-fPIC"]
    subprocess.run([COMPILER, *flags, "-o", library, source], check=True)
    law = ctypes.CDLL(str(library)).law
    rng, outside = np.random.default_rng(0), 0
    points = np.vstack([rng.uniform([-2.2, -1.1], [2.2, 1.1], (200, 2)), problem().schedule[0].mesh.nodes()])
    for x in points:
        last, stage = rng.uniform([-2, 0], [2, 1]), int(rng.integers(0, 3))
        u = np.full(2, 7.0)
        expected = table(x, stage, last, "interpolate")
        pointers = [v.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for v in (np.ascontiguousarray(x), last, u)]
        found = law(stage, *pointers)
        assert found == (expected is not None)
        outside += expected is None
        np.testing.assert_allclose(u, [7.0, 7.0] if expected is None else expected, atol=1e-12)
    assert 0 < outside < len(points)


def test_the_text_is_the_same_every_time(tmp_path):
    table = problem().backward()
    first, header = table_to_c(table, tmp_path / "a.c", "law")
    second, _ = table_to_c(table, tmp_path / "b.c", "law")
    assert first.read_text().replace("a.h", "b.h") == second.read_text()
    assert "s [m], -2 to 2" in header.read_text()


def test_what_cannot_be_written(tmp_path):
    table = problem().backward()
    with pytest.raises(ArgumentError, match="prefix is '2a'"):
        table.to_c(tmp_path / "law.c", "2a")
    refined = problem().refine([0.5, 0.0], 2, last_input=[0.0, 0.0]).table
    with pytest.raises(ArgumentError, match="differ from stage to stage"):
        refined.to_c(tmp_path / "law.c")
