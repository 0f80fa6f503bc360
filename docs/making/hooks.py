"""What the site does beyond its generator: pages of shipped models, formulas as MathML, fresh pictures, whole links.

Loaded by mkdocs (``hooks`` in mkdocs.yml). Everything is made from the repository; nothing is fetched.
"""

from __future__ import annotations

import importlib.util
import logging
import posixpath
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from typing import Any
from urllib.parse import unquote, urlsplit

from latex2mathml.converter import convert
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[2]
LOG = logging.getLogger("mkdocs.hooks.hysdel_py")  # what is logged here as a warning ends a strict build

FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
FORMULA = re.compile(r"\$\$(.+?)\$\$|(?<![\w$\\])\$([^\s$](?:[^$\n`]*[^\s$])?)\$(?!\w)", re.DOTALL)
ROLE = re.compile(r":(?:class|func|meth|mod|attr|data|exc):(<code>)~?(?:hysdel_py\.[\w.]*\.)?")
LINK = re.compile(r"(!?\[[^\]]*\])\(([^)\s]+)\)")


def on_config(config: Any) -> Any:
    """Every page of a diagnostic is in the navigation, in the order of the codes."""
    pages = sorted((ROOT / "docs" / "errors").glob("HYS*.md"))
    entry = ["errors/README.md", *(f"errors/{page.name}" for page in pages)]
    nav = [{"Errors": entry} if item == {"Errors": "errors/"} else item for item in config["nav"]]
    config["nav"] = [item for item in map(_present, nav) if item != {"Bridges": []}]
    return config


def _present(item: Any) -> Any:
    """The section of bridges without pages that are not there."""
    if not isinstance(item, dict) or "Bridges" not in item:
        return item
    return {"Bridges": [page for page in item["Bridges"] if (ROOT / "docs" / next(iter(page.values()))).exists()]}


def on_files(files: Files, config: Any) -> Files:
    """Add the shipped models and the search from the disk, and put fresh pictures in the place of those kept."""
    for path in sorted((ROOT / "models").iterdir()):
        files.append(File.generated(config, f"models/{path.name}", abs_src_path=str(path)))
    worker = Path(__file__).with_name("iframe-worker.js")
    files.append(File.generated(config, f"assets/{worker.name}", abs_src_path=str(worker)))
    for name, content in _gallery().pictures():
        _replace(files, File.generated(config, f"pictures/gallery/{name}", content=content))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Links that leave the site are made plain text; formulas become MathML."""
    uri = page.file.src_uri
    return _outside_fences(markdown, lambda text: FORMULA.sub(_mathml, LINK.sub(lambda m: _link(m, uri), text)))


def on_page_content(html: str, **_: Any) -> str:
    """Docstrings name what they refer to by roles, which this generator would show as they are."""
    return ROLE.sub(r"\1", html)


def on_post_build(config: Any) -> None:
    """Follow every link of the built pages to a file and to a place in it."""
    pages = {path: _parsed(path) for path in sorted(Path(config["site_dir"]).rglob("*.html"))}
    for path, page in pages.items():
        for link in page.links:
            if problem := _problem(link, path, pages):
                LOG.warning("%s: %s", path.relative_to(config["site_dir"]), problem)


def _gallery() -> ModuleType:
    """The script beside this one, which is no part of a package."""
    spec = importlib.util.spec_from_file_location("gallery", Path(__file__).with_name("gallery.py"))
    if spec is None or spec.loader is None:
        raise ImportError("docs/making/gallery.py cannot be loaded")
    module = importlib.util.module_from_spec(spec)
    sys.modules["gallery"] = module
    spec.loader.exec_module(module)
    return module


def _replace(files: Files, file: File) -> None:
    old = files.get_file_from_path(file.src_uri)
    if old is not None:
        files.remove(old)
    files.append(file)


def _outside_fences(text: str, change: Any) -> str:
    """Change what is not in a fenced block."""
    parts, done = [], 0
    for fence in FENCED.finditer(text):
        parts += [change(text[done : fence.start()]), fence[0]]
        done = fence.end()
    return "".join([*parts, change(text[done:])])


def _link(match: re.Match[str], uri: str) -> str:
    """The link as the site has it: files of the repository that are not on the site are named only."""
    text, target = match[1], match[2]
    path, hash_, anchor = target.partition("#")
    if not path or urlsplit(target).scheme:
        return match[0]
    resolved = posixpath.normpath(posixpath.join("docs", posixpath.dirname(uri), path))
    if uri.startswith("models/"):  # lies outside docs in the repository, inside on the site
        return match[0]
    if resolved.startswith("docs/"):
        return match[0]
    if resolved.startswith("models/"):
        return f"{text}({posixpath.relpath(resolved, posixpath.dirname(uri) or '.')}{hash_}{anchor})"
    return text.removeprefix("!")[1:-1]


def _mathml(match: re.Match[str]) -> str:
    block = match[1] is not None
    return convert((match[1] or match[2]).strip(), display="block" if block else "inline").replace("\n", " ")


class _Page(HTMLParser):
    """Links and places of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.places: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect what the tag refers to and what it can be referred to by."""
        given = dict(attrs)
        self.places |= {given[key] or "" for key in ("id", "name") if key in given}
        target = given.get("href") if tag in ("a", "link") else given.get("src")
        if target:
            self.links.append(target)


def _parsed(path: Path) -> _Page:
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def _problem(link: str, path: Path, pages: dict[Path, _Page]) -> str:
    """Why a link is broken; empty if it is not."""
    parts = urlsplit(link)
    if parts.scheme in ("http", "https", "mailto", "data"):
        return "" if parts.scheme in ("mailto", "data") or _is_anchor(link) else f"{link} would be fetched"
    if path.name == "404.html":  # its links are absolute, since it is shown anywhere
        return ""
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    target = target / "index.html" if target.is_dir() else target
    if not target.exists():
        return f"{link} leads nowhere"
    place = unquote(parts.fragment)
    if place and target in pages and place not in pages[target].places:
        return f"{link} names a place that is not there"
    return ""


def _is_anchor(link: str) -> bool:
    """Links of text may lead to the network; nothing that a browser would load by itself may."""
    return not re.search(r"\.(js|css|woff2?|png|svg)(\?|$)", link)
