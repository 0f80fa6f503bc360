"""The model description of a functional mock-up unit (FMI 2.0, co-simulation) and the header of its C sources."""

from __future__ import annotations

import hashlib
import math
import uuid
from collections.abc import Iterator, Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from hysdel_py.export.c_text import array, comment, float_text
from hysdel_py.export.fmu_model import INVALID, FmuModel
from hysdel_py.systems.signals import Variable
from hysdel_py.version import __version__

__all__ = ["STATUS_NAME", "description_text", "guid_of", "header_lines"]

STATUS_NAME = "step_status"
"""Variable that holds the sum of the bits of the last step."""

_TIME_SLACK = "1e-3"
"""Share of a sample time by which communication points may miss a sample instant: sums of many steps do."""


def guid_of(model: FmuModel, sources: Sequence[str]) -> str:
    """An identifier of the model and its code: the same model has the same one."""
    digest = hashlib.sha256("\0".join((repr(model.start), repr(model.variables), *sources)).encode()).digest()
    return f"{{{uuid.UUID(bytes=digest[:16], version=4)}}}"


def header_lines(model: FmuModel, prefix: str, guid: str) -> Iterator[str]:
    """Lines of ``fmu_model.h``: sizes, first values, and the step function."""
    sizes = [len(group) for group in (model.x, model.u, model.y, model.d, model.z)]
    places = [sum(sizes[:k]) for k in range(len(sizes) + 1)]
    yield from comment([f"Model of the unit, written by hysdel_py {__version__}."])
    yield f'#define MODEL_GUID "{guid}"'
    yield f"#define MODEL_STEP {prefix}_step"
    yield f"#define MODEL_INVALID {INVALID}"
    yield f"#define SAMPLE_TIME {float_text(model.sample_time)}"
    yield f"#define TIME_SLACK {_TIME_SLACK}"
    yield "/* First value references: states begin at 0. */"
    yield f"enum {{ U = {places[1]}, Y = {places[2]}, D = {places[3]}, Z = {places[4]}, COUNT = {places[5]} }};"
    yield ""
    yield f"int {prefix}_step(const double *x, const double *u, double *x_next, double *y, double *d, double *z);"
    yield ""
    yield from array("double initial_value[COUNT + 1]", [*map(float_text, _first_values(model)), "0.0"])
    types = "".join("b" if v.is_bool else "r" for v in model.variables)
    yield f'static const char value_type[] = "{types}i";'
    entries = [f'{{{bit}, "{text}"}}' for bit, text in model.remarks]
    yield f"static const struct {{ int bit; const char *text; }} remarks[] = {{{', '.join(entries)}}};"


def _first_values(model: FmuModel) -> tuple[float, ...]:
    rest = len(model.y) + len(model.d) + len(model.z)
    return (*model.start, *map(_first_input, model.u), *[0.0] * rest)


def _first_input(v: Variable) -> float:
    return 0.0 if v.is_bool else min(max(0.0, v.low), v.high) + 0.0


def description_text(model: FmuModel, prefix: str, guid: str, files: Sequence[str]) -> str:
    """The text of ``modelDescription.xml``."""
    root = Element("fmiModelDescription", {
        "fmiVersion": "2.0", "modelName": _plain(model.name), "guid": guid, "description": _plain(model.description),
        "generationTool": f"hysdel_py {__version__}", "variableNamingConvention": "flat",
    })  # fmt: skip
    unit = SubElement(root, "CoSimulation", {
        "modelIdentifier": prefix, "canHandleVariableCommunicationStepSize": "true", "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
    })  # fmt: skip
    listed = SubElement(unit, "SourceFiles")
    for name in files:
        SubElement(listed, "File", {"name": name})
    _units(root, model)
    categories = SubElement(root, "LogCategories")
    for name in ("logStatusWarning", "logStatusError"):
        SubElement(categories, "Category", {"name": name})
    SubElement(root, "DefaultExperiment", {"startTime": "0", "stepSize": repr(model.sample_time)})
    _variables(root, model)
    _structure(root, model)
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def _units(root: Element, model: FmuModel) -> None:
    units = dict.fromkeys(_plain(v.unit) for v in model.variables if v.unit and not v.is_bool)
    if units:
        definitions = SubElement(root, "UnitDefinitions")
        for unit in units:
            SubElement(definitions, "Unit", {"name": unit})


def _variables(root: Element, model: FmuModel) -> None:
    listed = SubElement(root, "ModelVariables")
    firsts = (*model.start, *map(_first_input, model.u))
    for reference, v in enumerate(model.variables):
        is_state, is_input = reference < len(model.x), len(model.x) <= reference < len(firsts)
        is_output = v in model.y or (is_state and model.shows_states)
        causality = "input" if is_input else "output" if is_output else "local"
        told = {"name": v.name, "valueReference": str(reference), "description": _plain(v.description),
                "causality": causality, "variability": "discrete"}  # fmt: skip
        if not is_input:
            told["initial"] = "exact" if is_state else "calculated"
        one = SubElement(listed, "ScalarVariable", {key: text for key, text in told.items() if text})
        _typed(one, v, firsts[reference] if reference < len(firsts) else None, ranged=is_state or is_input)
    status = {"name": _status_name(model), "valueReference": str(len(model.variables)), "causality": "local",
              "variability": "discrete", "initial": "calculated", "description": _meaning(model)}  # fmt: skip
    SubElement(SubElement(listed, "ScalarVariable", status), "Integer")


def _typed(one: Element, v: Variable, first: float | None, *, ranged: bool) -> None:
    if v.is_bool:
        SubElement(one, "Boolean", {} if first is None else {"start": "true" if first else "false"})
        return
    told = {"unit": _plain(v.unit)} if v.unit else {}
    if ranged:
        told |= {key: repr(end) for key, end in (("min", v.low), ("max", v.high)) if math.isfinite(end)}
    SubElement(one, "Real", told if first is None else told | {"start": repr(first)})


def _status_name(model: FmuModel) -> str:
    """A name that no variable of the model has."""
    taken, name = {v.name for v in model.variables}, STATUS_NAME
    while name in taken:
        name += "_"
    return name


def _meaning(model: FmuModel) -> str:
    return "0, or the sum of: " + ", ".join(f"{bit} {text}" for bit, text in model.remarks)


def _structure(root: Element, model: FmuModel) -> None:
    """Outputs, which follow states and inputs; those of a model without outputs are its states."""
    structure = SubElement(root, "ModelStructure")
    first = len(model.x) + len(model.u)
    outputs = range(1, len(model.x) + 1) if model.shows_states else range(first + 1, first + len(model.y) + 1)
    if not outputs:
        return
    for tag in ("Outputs", "InitialUnknowns") if model.y else ("Outputs",):
        listed = SubElement(structure, tag)
        for index in outputs:
            SubElement(listed, "Unknown", {"index": str(index)})


def _plain(text: str) -> str:
    """A text without characters that XML does not have."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())
