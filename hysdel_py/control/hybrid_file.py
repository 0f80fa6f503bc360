"""Explicit hybrid laws as .npz files: numbers as arrays, everything else as one JSON text."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from os import PathLike
from typing import Any
from zipfile import BadZipFile

import numpy as np

from hysdel_py.control.explicit_file import law_arrays, law_of_arrays
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.explicit_parameters import Parameter, Parameters
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.control.hybrid_sequences import SearchReport, SequenceLaw
from hysdel_py.control.references import References
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Kind, Type, Variable

__all__ = ["head_of", "law_of", "load_hybrid", "save_hybrid"]

_FORMAT = "hybrid 1"
_PLAIN = ("switches", "horizon", "norm", "exact", "complete", "partition", "sample_time")


def save_hybrid(law: HybridLaw, path: str | PathLike[str]) -> None:
    """Write a law; nothing in the file needs to be executed to read it."""
    with open(path, "wb") as file:
        np.savez(file, **_content(law))


def _content(law: HybridLaw) -> dict[str, Any]:
    arrays = {
        f"{number}/{name}": value
        for number, sequence in enumerate(law.sequences)
        for name, value in law_arrays(sequence.law).items()
    }
    return {"format": np.array(_FORMAT), "head": np.array(json.dumps(head_of(law)))} | arrays


def head_of(law: HybridLaw) -> dict[str, Any]:
    """Plain data of everything but the laws of the sequences."""
    return {name: getattr(law, name) for name in _PLAIN} | {
        "words": [sequence.word for sequence in law.sequences],
        "parameters": [asdict(parameter) for parameter in law.parameters.every],
        "report": asdict(law.report),
        "references": asdict(law.references),
        "x": [_variable(v) for v in law.x],
        "u": [_variable(v) for v in law.u],
    }


def _variable(v: Variable) -> dict[str, Any]:
    return asdict(v) | {"type": v.type.value, "kind": v.kind.value}


def load_hybrid(path: str | PathLike[str]) -> HybridLaw:
    """Read a law.

    Raises
    ------
    ArgumentError
        The file is no explicit hybrid law or of another format.
    """
    try:
        with np.load(path, allow_pickle=False) as data:
            content = {name: data[name] for name in data.files}
    except (BadZipFile, ValueError) as error:
        raise ArgumentError(f"{path} is not an .npz file: {error}") from None
    if str(content.get("format")) != _FORMAT:
        raise ArgumentError(f"{path} holds no explicit hybrid law of this format")
    return _law(content)


def _law(content: Mapping[str, Any]) -> HybridLaw:
    head = json.loads(str(content["head"]))
    laws = [
        law_of_arrays({name.partition("/")[2]: value for name, value in content.items() if name.startswith(f"{k}/")})
        for k in range(len(head["words"]))
    ]
    return law_of(head, laws)


def law_of(head: Mapping[str, Any], laws: Sequence[ExplicitLaw]) -> HybridLaw:
    """The law of the data that :func:`head_of` gives, and the laws of its sequences."""
    return HybridLaw(
        **{name: head[name] for name in _PLAIN if name != "switches"},
        switches=tuple(head["switches"]),
        sequences=tuple(SequenceLaw(tuple(w), law) for w, law in zip(head["words"], laws, strict=True)),
        parameters=Parameters(tuple(Parameter(**entry) for entry in head["parameters"])),
        report=SearchReport(**head["report"]),
        references=References(**(head["references"] | {"names": tuple(head["references"]["names"])})),
        x=tuple(_as_variable(entry) for entry in head["x"]),
        u=tuple(_as_variable(entry) for entry in head["u"]),
    )


def _as_variable(entry: dict[str, Any]) -> Variable:
    return Variable(**(entry | {"type": Type(entry["type"]), "kind": Kind(entry["kind"])}))
