"""Every page of the documents runs as it stands, and every link between them leads somewhere."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from pages import Session, alike, blocks, outputs

import hysdel_py as hys

ROOT = Path(__file__).parents[1]
PAGES = sorted([*(ROOT / "docs").rglob("*.md"), ROOT / "README.md"])
SESSIONS = [ROOT / "docs" / name for name in ("tutorial.md", "why.md", "coming-from.md")]
SESSIONS += sorted((ROOT / "docs" / "how-to").glob("*.md"))
WITH_C = {
    "tutorial.md": ("bodies_law", "bodies"),
    "microcontroller.md": ("tank_law", "tank_plant"),
}
BENCHMARK = re.compile(r"python (benchmarks/\w+\.py)([^`\n|]*)")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


def programs(text):
    """(first line, code) of each Python block that is run."""
    return [(block.line, block.body) for block in blocks(text) if block.language == "python" and not block.title]


def anchors(text):
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize(
    "page", [page for page in PAGES if page not in SESSIONS], ids=lambda page: page.relative_to(ROOT).as_posix()
)
def test_python_blocks_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    namespace = {"__name__": "__docs__"}
    for line, code in programs(page.read_text(encoding="utf-8")):
        exec(compile("\n" * (line - 1) + code, str(page), "exec"), namespace)


@pytest.mark.parametrize("page", SESSIONS, ids=lambda page: page.name)
def test_pages_show_what_is_printed(page, tmp_path, monkeypatch):
    """Files, programs and commands of a page, in one session; ``python tests/pages.py`` writes the outputs anew."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    for output in outputs(page.read_text(encoding="utf-8"), Session(tmp_path), str(page)):
        assert alike(output.shown, output.found), f"{output.source}\n{output.found}"
    if page.name in WITH_C:
        self_tests_pass(WITH_C[page.name], tmp_path)


def self_tests_pass(names, folder):
    """The C that a page wrote, where there is a compiler."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    for name in names if compiler else ():
        defined = f"-D{name.upper()}_SELF_TEST"
        subprocess.run([compiler, "-std=c99", defined, f"{name}.c", "-o", name], cwd=folder, check=True)
        assert subprocess.run([folder / name], capture_output=True, check=False).returncode == 0


def test_calls_beside_those_of_other_tools_are_run():
    """What the right columns of coming-from.md call is called in its programs."""
    text = (ROOT / "docs" / "coming-from.md").read_text(encoding="utf-8")
    ours = [line.rsplit("|", 2)[1] for line in text.splitlines() if line.startswith("|")]
    calls = {call for column in ours for call in re.findall(r"(?:hys|\w)\.(\w+)\(", column)}
    calls |= {name for column in ours for name in re.findall(r"hys\.(\w+)", column)}
    run = "\n".join(code for _, code in programs(text))
    assert len(calls) > 20
    assert not [call for call in calls if not re.search(rf"\.{call}\b", run)]


def test_every_public_name_is_in_the_reference_once():
    pages = (ROOT / "docs" / "reference").glob("*.md")
    shown = re.findall(r"^::: (\S+)$", "\n".join(page.read_text(encoding="utf-8") for page in pages), re.MULTILINE)
    home = {name: f"hysdel_py.{module}.{name}" for name, module in hys._HOME.items()}
    assert sorted(shown) == sorted(home.values())


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    for link in LINK.findall(page.read_text(encoding="utf-8")):
        if link.startswith(("http:", "https:", "mailto:")):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), f"{page.name} links to {link}"
        if anchor and target.suffix == ".md":
            assert anchor in anchors(target.read_text(encoding="utf-8")), f"{page.name} links to {link}"


def test_benchmarks_that_pages_name_take_the_options_that_they_name():
    named = [match.groups() for page in PAGES for match in BENCHMARK.finditer(page.read_text(encoding="utf-8"))]
    asked = {(file, option) for file, rest in named for option in re.findall(r"(?<!\S)--[a-z-]+", rest)}
    assert len(asked) > 10
    assert not [pair for pair in asked if f'"{pair[1]}"' not in (ROOT / pair[0]).read_text(encoding="utf-8")]


def test_the_blocks_are_found():
    assert programs("a\n```python\nx = 1\n```\n") == [(3, "x = 1\n")]
    assert sum(len(programs(page.read_text(encoding="utf-8"))) for page in PAGES) > 10
    assert set(SESSIONS) < set(PAGES)


def test_a_session_runs_files_programs_and_commands(tmp_path):
    page = """```python title="greet.py"
print("hello", 2)
```

```console
$ python greet.py
hello 2.01
$ echo $?
0
```

```python
print(1, 2)
```

```text
1 3
```

<!-- not run: it would fail -->
```python
raise ValueError
```
"""
    found = [(output.shown, output.found) for output in outputs(page, Session(tmp_path))]
    assert found == [("hello 2.01\n", "hello 2\n"), ("0\n", "0\n"), ("1 3\n", "1 2\n")]
    assert [alike(*pair) for pair in found] == [True, True, False]
