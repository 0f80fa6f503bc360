"""What a file under tests/data/bad expects, written in its own comments.

``/* error HYS302 5:18 */`` (also warning and note; several, separated by semicolons; without a place for a diagnostic
about the whole file) and ``/* options constants=forbid */``; ``check=deep`` asks for
the search of ``hysdel check --deep``.
"""

import re
from functools import cache
from pathlib import Path

import hysdel_py as hys
from hysdel_py import compiler
from hysdel_py.lowering.big_m import BigM
from hysdel_py.lowering.constants import Constants

BAD = Path(__file__).parents[1] / "data" / "bad"
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_EXPECTED = re.compile(r"(error|warning|note) (HYS\d{3})(?: (\d+:\d+))?")


def bad_files():
    """All files in alphabetical order."""
    return sorted(BAD.glob("*.hys"))


def expected_in(text):
    """Set of (severity, code, place or None) that the comments of a text announce."""
    found = [match.groups() for comment in _COMMENT.findall(text) for match in _EXPECTED.finditer(comment)]
    return sorted(found, key=str)


def options_in(text):
    """Options of the lowering that the comments of a text ask for."""
    match = re.search(r"/\* options ([^*]*?) \*/", text)
    return dict(option.split("=") for option in match[1].split()) if match else {}


@cache
def diagnostics_of(path):
    """All diagnostics of all stages, notes included, as far as the compiler gets."""
    options = options_in(path.read_text(encoding="utf-8"))
    constants = Constants(options.get("constants", "affine"))
    try:
        typed, values, found = compiler.analyse(path, {})
        dha, lowered = compiler.lower_to_dha(typed, values, constants)
        _, last = compiler.lower_to_mld(typed, dha, BigM.LP)
    except hys.CompileError as error:
        return error.diagnostics
    if options.get("check") == "deep":
        return hys.well_posed(hys.load(path)).beside((*found, *lowered, *last))
    return (*found, *lowered, *last)


def as_triples(diagnostics, source):
    """Diagnostics in the form of expected_in."""
    triples = []
    for d in diagnostics:
        place = None if d.span is None else "{}:{}".format(*source.position(d.span.start))
        triples.append((d.severity.value, d.code.value, place))
    return sorted(triples, key=str)
