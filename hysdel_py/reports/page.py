"""A model, and a run of it, as one page of HTML that needs nothing else."""

from __future__ import annotations

import base64
import hashlib
from importlib.resources import files
from typing import TYPE_CHECKING

from hysdel_py.errors import ArgumentError
from hysdel_py.markup.elements import Markup, element, fragment
from hysdel_py.model import Model, to_pwa
from hysdel_py.reports.page_model import (
    audit_section,
    diagnostics_section,
    modes_section,
    signals_section,
    sizes_section,
)
from hysdel_py.reports.page_run import run_section
from hysdel_py.reports.page_source import source_section
from hysdel_py.reports.run_file import RecordedRun, recorded
from hysdel_py.systems.trajectory import Trajectory

if TYPE_CHECKING:
    from hysdel_py.systems.pwa import Pwa

__all__ = ["html_report"]

_MOST_MODES = 200


def html_report(model: Model, run: Trajectory | RecordedRun | None = None, *, max_modes: int = _MOST_MODES) -> str:
    """The page of a model: source and rows, signals, diagnostics, big-M constants, modes, and a run.

    Everything is inside, so that the file works without a network and from a folder. The same arguments give the same
    bytes.

    Parameters
    ----------
    model : Model
        All its parameters have values.
    run : Trajectory or RecordedRun, optional
        A run of it, from a simulation or from a closed loop.
    max_modes : int
        The search for modes ends after so many.

    Returns
    -------
    str
        HTML in UTF-8.

    Raises
    ------
    CompileError
        The model has no MLD form.
    ArgumentError
        Something else than a model or a run.

    Examples
    --------
    >>> import hysdel_py as hys
    >>> hys.html_report(hys.load("two_tanks")).startswith("<!DOCTYPE html>")
    True
    """
    if not isinstance(model, Model):
        raise ArgumentError(f"model is a {type(model).__name__}: a Model was expected, as load gives it")
    if not isinstance(run, Trajectory | RecordedRun | None):
        raise ArgumentError(f"run is a {type(run).__name__}: a Trajectory was expected")
    pwa = to_pwa(model, max_modes=max_modes)
    sections = _sections(model, pwa, recorded(run) if isinstance(run, Trajectory) else run)
    return f"<!DOCTYPE html>\n{_page(model.name or 'model', sections)}\n"


def _sections(model: Model, pwa: Pwa, run: RecordedRun | None) -> dict[str, tuple[str, Markup]]:
    """Title and content of each section by its anchor."""
    found = {
        "sizes": ("Sizes", sizes_section(model, pwa)),
        "source": ("Source and rows", source_section(model)),
        "signals": ("Signals", signals_section(model)),
        "diagnostics": ("Diagnostics", diagnostics_section(model)),
        "audit": ("Big-M constants", audit_section(model)),
        "modes": ("Modes", modes_section(pwa)),
    }
    return found if run is None else found | {"run": ("Run", run_section(run, pwa))}


def _page(name: str, sections: dict[str, tuple[str, Markup]]) -> Markup:
    style, script = _asset("report.css"), _asset("report.js")
    policy = f"default-src 'none'; style-src '{_digest(style)}'; script-src '{_digest(script)}'"
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", http_equiv="Content-Security-Policy", content=policy),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("title", f"{name}: hysdel report"),
        element("style", style),
    )
    links = [element("a", title, href=f"#{anchor}") for anchor, (title, _) in sections.items()]
    body = element(
        "body",
        element("header", element("h1", name), element("nav", links, aria_label="Sections")),
        element("main", [_section(anchor, *part) for anchor, part in sections.items()]),
        element("script", script),
    )
    return element("html", head, "\n", body, lang="en")


def _section(anchor: str, title: str, content: Markup) -> Markup:
    return fragment("\n", element("section", element("h2", title), content, id=anchor))


def _asset(name: str) -> Markup:
    """A file beside this module; it is ours, so that nothing in it is escaped."""
    return Markup((files("hysdel_py.reports") / "assets" / name).read_text(encoding="utf-8"))


def _digest(text: str) -> str:
    """What a content security policy calls a text, so that no other script or style is obeyed."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"
