"""The page of a model: what it holds, that it is whole, and that nothing in a model can act in it."""

import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.errors import ArgumentError
from hysdel_py.reports.page import html_report
from hysdel_py.reports.page_run import modes_of
from hysdel_py.reports.page_source import place_of_items
from hysdel_py.reports.run_file import recorded

HOSTILE = """SYSTEM hostile { /* <script>document.title = "taken"</script> */
  INTERFACE {
    STATE { REAL x [-9, 9]; /* [<img src=x onerror=alert(1)>] </script><script>document.title = "taken"</script> */ }
    INPUT { BOOL u; /* " onmouseover="alert(1) */ }
  }
  IMPLEMENTATION {
    AUX { REAL z; BOOL
      low; }
    AD { low = x
      <= 0; /* </style> ]]> <!-- */ }
    DA { z = {IF u & low THEN 1 ELSE -1}; }
    CONTINUOUS { x = 0.5*x + z; }
  }
}"""
VOID = {"meta", "br"}


class Page(HTMLParser):
    """The tree of a page as far as the tests ask."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.open, self.text = [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        if "script" not in self.open and "style" not in self.open:
            self.text.append(data)

    def all(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def hostile():
    return hys.load(HOSTILE)


@pytest.fixture(scope="module")
def run(hostile):
    return hostile.simulate([2.0], np.array([[0.0], [1.0], [1.0], [0.0], [1.0]]), ts=0.5)


@pytest.fixture(scope="module")
def text(hostile, run):
    return html_report(hostile, run)


def test_the_tags_are_in_order_and_nothing_is_fetched(text):
    page = Page(text)
    assert page.open == []
    fetched = {"src", "href", "data", "action"}
    assert {a["href"][0] for a in page.all("a")} == {"#"}
    assert not [t for t, attributes in page.tags if t != "a" and fetched & set(attributes)]
    assert "url(http" not in text
    assert "@import" not in text


def test_a_hostile_model_adds_no_tag_and_no_handler(text):
    page = Page(text)
    assert len(page.all("script")) == 2
    assert not page.all("img")
    assert not [name for _, attributes in page.tags for name in attributes if name.startswith("on")]
    assert 'document.title = "taken"' in "".join(page.text)  # it is shown, as text


def test_only_the_script_of_the_page_may_run(text):
    policy = next(a["content"] for a in Page(text).all("meta") if "content" in a and "default-src" in a["content"])
    assert "default-src 'none'" in policy
    assert len(re.findall(r"script-src 'sha256-[A-Za-z0-9+/]{43}='", policy)) == 1


def test_same_arguments_same_bytes(hostile, run, text):
    assert html_report(hys.load(HOSTILE), run) == text


def test_every_row_and_equation_is_there_with_its_lines(hostile, text):
    page, mld = Page(text), hostile.mld
    rows = [a["data-rows"] for a in page.all("button") if "data-rows" in a]
    assert len(rows) == mld.nx + mld.ny + mld.ne
    shown = [{int(key.split("-")[1]) for key in row.split()} for row in rows]
    origins = (*mld.updates, *mld.outputs, *mld.rows)
    assert all(origin.line in lines for origin, lines in zip(origins, shown, strict=True))
    assert {9, 10} in shown  # an item of two lines
    lines = [a["data-key"] for a in page.all("li") if "data-key" in a]
    assert lines == [f"0-{k}" for k in range(1, HOSTILE.count("\n") + 2)]


def test_modes_of_a_run_are_those_of_the_pwa():
    model = hys.load("two_tanks")
    inputs = np.column_stack([np.repeat([1e-4, 0.0, 0.0], 20), np.repeat([0.0, 0.0, 1.0], 20)])
    run = model.simulate([0.25, 0.58], inputs)
    found = modes_of(recorded(run), model.pwa)
    expected = [model.pwa.locate(x, u) for x, u in zip(run.x[:-1], run.u, strict=True)]
    assert (found - 1).tolist() == expected
    assert len(set(expected)) > 2


def test_data_of_the_run_reads_back(text, run):
    data = json.loads(re.search(r'id="run-data">(.*?)</script>', text)[1])
    assert data["t"] == run.t.tolist()
    assert next(s for s in data["signals"] if s["name"] == "x")["values"] == pytest.approx(run["x"], abs=1e-8)


def test_records_of_a_controller_are_summed_up(hostile, run):
    info = {"status": np.array([0.0, 0, 6, 1, 0]), "seconds": np.arange(5) / 1e3, "cost": np.full(5, np.inf)}
    filled = hys.Trajectory(run.t, run.x, run.u, run.y, run.d, run.z, run.variables, ("step 2: a fallback",), info)
    shown = " ".join(Page(html_report(hostile, filled)).text)
    assert "5 moves: 3 optimal, 1 feasible, 1 fallback." in shown
    assert "step 2: a fallback" in shown
    assert re.search(r"seconds \[ms\]\s+2\s+2\s+3.8\s+4", shown)


def test_long_runs_are_thinned_and_it_is_said(hostile):
    short = hostile.simulate([0.0], np.zeros((1, 1)))
    t, x = np.arange(50_001.0), np.sin(np.arange(50_001.0))[:, None]
    long = (np.repeat(getattr(short, key), 50_000, axis=0) for key in "uydz")
    shown = html_report(hostile, hys.Trajectory(t, x, *long, short.variables))
    assert "One of 3 steps is shown." in shown
    assert len(shown) < 2_000_000


def test_modules_show_every_file(tmp_path):
    (tmp_path / "leak.hys").write_text(
        "SYSTEM leak { INTERFACE { STATE { REAL level [0, 9]; } INPUT { REAL q [0, 1]; } }\n"
        "  IMPLEMENTATION { CONTINUOUS {\n    level = 0.5*level + q; } } }\n"
    )
    (tmp_path / "top.hys").write_text(
        "SYSTEM top { INTERFACE { MODULE { leak a; } INPUT { REAL q [0, 1]; } }\n"
        "  IMPLEMENTATION { LINEAR { a.q = q; } } }\n"
    )
    model = hys.load(tmp_path / "top.hys")
    files = {place.file for place in place_of_items(model).values()}
    page = Page(html_report(model))
    assert len(files) >= 1
    assert {a["data-key"] for a in page.all("li") if "data-key" in a} >= {"0-1", "1-3"}


@pytest.mark.parametrize(("arguments", "words"), [(("clutch",), "a Model was expected"), ((None, 3), "a Model")])
def test_wrong_arguments(arguments, words):
    with pytest.raises(ArgumentError, match=words):
        html_report(*arguments)


def test_wrong_run(hostile):
    with pytest.raises(ArgumentError, match="run is a int: a Trajectory was expected"):
        html_report(hostile, 3)


def test_many_modes_are_counted_but_not_drawn():
    shown = html_report(hys.load("supply_chain"), max_modes=45)
    assert "The search for modes was ended after 45: there are more." in shown
    assert "The graph of 45 modes is not drawn" in shown
