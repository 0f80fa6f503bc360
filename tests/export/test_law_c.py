"""Laws in C: they compile without a warning, agree with Python, and refuse points outside the map."""

from __future__ import annotations

import ctypes
import re
from functools import cache

import numpy as np
import pytest
from export.compiled_c import needs_gcc, replay, shared
from export.laws import inner_region, saturation, solved, without

import hysdel_py as hys
from hysdel_py.control.explicit_certificate import random_points
from hysdel_py.export.law_c import law_to_c
from hysdel_py.export.law_number import Number, scaling_of
from hysdel_py.export.law_points import far_from_borders
from hysdel_py.export.law_table import Method, law_table

NUMBERS = ("double", "float", "int32", "int16")
METHODS = ("tree", "sequential")
C_TYPES = {"double": ctypes.c_double, "float": ctypes.c_float, "int32": ctypes.c_int32, "int16": ctypes.c_int16}


class Compiled:
    """A written law that Python calls."""

    def __init__(self, law, path, number, method):
        self.code = law.to_c(path, number=number, method=method)
        self.scaling = scaling_of(law, Number(number))
        self.number, self.law = number, law
        self.library = ctypes.CDLL(str(shared(path)))

    def __call__(self, zeta, last=None):
        """Status and move; `last` is a number of a region in a c_long."""
        result = ctypes.c_int32 if self.scaling.number.is_fixed else C_TYPES[self.number]
        raw = self.scaling.raw(np.asarray(zeta, dtype=float)).tolist()
        raw = list(map(int, raw)) if self.scaling.number.is_fixed else raw
        point, move = (C_TYPES[self.number] * self.law.p)(*raw), (result * self.law.moves)(*[77] * self.law.moves)
        name = self.code.prefix
        if last is None:
            status = getattr(self.library, name)(point, move)
        else:
            status = getattr(self.library, f"{name}_from")(point, move, ctypes.byref(last))
        return status, np.array(list(move)) * self.scaling.unit


@cache
def around(name, count=400):
    law = solved(name)
    rng = np.random.default_rng(1)
    low, high = law.domain.bounding_box
    wide = rng.uniform(1.3 * low - 0.3 * high, 1.3 * high - 0.3 * low, (count // 2, law.p))
    return np.vstack([random_points(law, count - count // 2, rng), wide])


@needs_gcc
@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["a_di_N3", "g_ahmadi_ex2"])
def test_the_compiled_law_agrees(tmp_path, name, method, number):
    law = solved(name)
    compiled = Compiled(law, tmp_path / "law.c", number, method)
    scaling = compiled.scaling
    points = around(name)
    points = points[far_from_borders(law, points, max(1e-6, 2 * scaling.margin(law.A, -law.b)))]
    allowed = 2 * scaling.move_error(law.K[:, : law.moves], law.k[:, : law.moves])
    seen = set()
    for point in points:
        if scaling.number.is_fixed and np.abs(scaling.raw(point)).max() > 2**15 - 1 and number == "int16":
            continue  # the integer would wrap before the code sees it
        expected = law(point)
        status, move = compiled(point)
        seen.add(status)
        assert status == (0 if expected is not None else 1)
        if expected is not None:
            assert np.all(np.abs(move - expected) <= allowed)
        else:
            assert np.all(move == 77 * scaling.unit)
    assert seen == {0, 1}
    assert len(points) > 50


@needs_gcc
@pytest.mark.parametrize("method", METHODS)
def test_a_hole_is_outside(tmp_path, method):
    whole = solved("a_di_N3")
    law = without(whole, inner_region(whole))
    compiled = Compiled(law, tmp_path / "law.c", "double", method)
    points = random_points(whole, 200, np.random.default_rng(3))
    points = points[far_from_borders(law, points, 1e-6)]
    states = [compiled(point)[0] for point in points]
    assert states == [int(law.locate(point) < 0) for point in points]
    assert set(states) == {0, 1}
    assert (compiled.code.open_leaves > 0) == (method == "tree")


@needs_gcc
@pytest.mark.parametrize("method", METHODS)
def test_what_is_no_number_is_outside(tmp_path, method):
    compiled = Compiled(solved("a_di_N3"), tmp_path / "law.c", "double", method)
    for point in ([np.nan, 0.0], [0.0, np.nan], [np.inf, 0.0], [-np.inf, np.inf]):
        status, move = compiled(point)
        assert status == 1
        assert move == [77]


@needs_gcc
def test_the_region_of_the_step_before_is_kept(tmp_path):
    law = saturation()
    compiled = Compiled(law, tmp_path / "law.c", "double", "sequential")
    for start in (law.locate([0.0]), law.locate([2.0])):
        last = ctypes.c_long(start)
        assert compiled([1.0], last)[0] == 0
        assert last.value == start
    last = ctypes.c_long(law.locate([0.0]))
    compiled([1.001], last)
    assert last.value == law.locate([2.0])
    assert compiled([9.0], last)[0] == 1
    assert last.value == -1
    for wrong in (-5, 3, 1000):
        last = ctypes.c_long(wrong)
        assert compiled([0.25], last)[1] == pytest.approx([-0.25])


@needs_gcc
@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("method", METHODS)
def test_the_self_test_passes_and_notices_a_wrong_number(tmp_path, method, number):
    code = solved("a_di_N3").to_c(tmp_path / "law.c", number=number, method=method, points=60)
    assert code.points > 30
    assert replay(code.files[0], "law").returncode == 0
    text = code.files[0].read_text()
    laws = re.search(r"maps\[\d+\]\[\d+\] = \{(.*?)\n\};", text, flags=re.DOTALL)
    wrong = text.replace(laws[1], re.sub(r"-?\d[\w.+-]*", "0", laws[1]))
    code.files[0].write_text(wrong)
    failed = replay(code.files[0], "law")
    assert failed.returncode == 1
    assert "point" in failed.stdout


def test_the_bytes_are_the_same_each_time(tmp_path):
    law = solved("a_di_N3")
    texts = []
    for _ in range(2):
        code = law_to_c(law, tmp_path / "law.c")
        texts.append([file.read_bytes() for file in code.files])
    assert texts[0] == texts[1]


def test_names_units_and_sizes_are_told(tmp_path):
    law = solved("a_di_N3")
    code = law.to_c(tmp_path / "drive.c", units=("m", "m/s"), moves=("force [N]",), prefix="di")
    header = code.files[1].read_text()
    assert [file.name for file in code.files] == ["drive.c", "drive.h"]
    for text in ("zeta[0]: x1 [m]", "zeta[1]: x2 [m/s]", "u[0]: force [N]", "int di(const double", "DI_OUTSIDE 1"):
        assert text in header
    assert f"Tables of {code.table_bytes} bytes" in header
    assert (code.regions, code.laws) == (15, 9)
    assert "malloc" not in code.files[0].read_text()


def test_the_table_is_counted_as_the_compiler_counts_it(tmp_path):
    code = solved("a_di_N3").to_c(tmp_path / "law.c", number="float", method="tree")
    table = law_table(solved("a_di_N3"), Number.FLOAT, Method.TREE)
    numbers = table.planes.size + table.maps.size
    assert code.table_bytes == 4 * numbers + 3 * len(table.tests) + len(table.hull)
    assert code.table_bytes < solved("a_di_N3").to_c(tmp_path / "law.c", method="tree").table_bytes


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"number": "half"}, "one of double, float, int32, int16 was expected"),
        ({"method": "hash"}, "auto, tree or sequential was expected"),
        ({"prefix": "2law"}, "a letter, then letters"),
        ({"prefix": "double"}, "a letter, then letters"),
        ({"units": ("m",)}, "2 texts were expected"),
        ({"moves": "force"}, "1 texts were expected"),
        ({"points": -1}, "zero or more"),
    ],
)
def test_wrong_options_are_refused(tmp_path, options, message):
    with pytest.raises(hys.ArgumentError, match=message):
        solved("a_di_N3").to_c(tmp_path / "law.c", **options)


def test_a_wrong_path_and_an_empty_law_are_refused(tmp_path):
    law = solved("a_di_N3")
    with pytest.raises(hys.ArgumentError, match=r"ends in \.c"):
        law.to_c(tmp_path / "law.txt")
    nothing = hys.MpQp(
        np.eye(1),
        np.zeros(1),
        np.eye(1),
        [[1.0], [-1.0]],
        [0.0, -1.0],
        np.zeros((2, 1)),
        hys.Polyhedron.box([-1.0], [1.0]),
    )
    with pytest.raises(hys.ArgumentError, match="no regions"):
        hys.ExplicitLaw.of(hys.solve_mpqp(nothing)).to_c(tmp_path / "law.c")


@needs_gcc
def test_comments_in_names_do_no_harm(tmp_path):
    law = saturation()
    code = law.to_c(tmp_path / "law.c", units=("*/ int x; /* \\",))
    assert replay(code.files[0], "law").returncode == 0


@pytest.fixture(scope="module")
def law_of_a_controller():
    lti = hys.Lti([[1.0, 0.1], [0.0, 1.0]], [[0.005], [0.1]], ts=0.1)
    limits = hys.LinearLimits(u=(-1, 1))
    return hys.explicit(hys.LinearMpc(lti, "regulator", 2, limits=limits), {"x1": (-3, 3), "x2": (-3, 3)})


def test_names_of_a_controller_stand_in_the_header(law_of_a_controller, tmp_path):
    code = law_of_a_controller.to_c(tmp_path / "law.c")
    assert " u[0]: u1\n" in code.files[1].read_text()


@pytest.mark.parametrize(
    ("options", "words"),
    [({"points": -1}, "points is -1"), ({"seed": "a"}, "seed is 'a'"), ({"points": 2.5}, "points is 2.5")],
)
def test_wrong_options_are_told(law_of_a_controller, tmp_path, options, words):
    with pytest.raises(hys.ArgumentError, match=words):
        law_of_a_controller.to_c(tmp_path / "law.c", **options)


def test_a_folder_that_is_not_there_is_told(law_of_a_controller, tmp_path):
    with pytest.raises(hys.ArgumentError, match="does not exist"):
        law_of_a_controller.to_c(tmp_path / "nowhere" / "law.c")


def test_json_keeps_what_the_law_reads(law_of_a_controller, tmp_path):
    law_of_a_controller.to_json(tmp_path / "law.json")
    again = hys.ExplicitLaw.from_json(tmp_path / "law.json")
    assert again.signals == law_of_a_controller.signals
    assert again.solve([1.0, 0.0]).u == pytest.approx(law_of_a_controller.solve([1.0, 0.0]).u)
    assert repr(again) == f"<ExplicitLaw of x1, x2: {again.count} regions, 1 moves, complete>"
    assert repr(again.solve([1.0, 0.0])).startswith("<Move optimal: u = [")
