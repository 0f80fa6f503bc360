"""Explicit hybrid laws as JSON files; reading one back gives an equal law."""

from __future__ import annotations

import json
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from hysdel_py.control.hybrid_file import head_of, law_of
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.errors import ArgumentError
from hysdel_py.export.law_json import law_from_dict, law_to_dict
from hysdel_py.export.reading import json_data

__all__ = ["HYBRID_SCHEMA", "read_hybrid_json", "write_hybrid_json"]

HYBRID_SCHEMA = "hysdel_py explicit hybrid law 1"


def write_hybrid_json(law: HybridLaw, path: str | PathLike[str]) -> None:
    """Write a law; each sequence is on a line of its own."""
    head = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in head_of(law).items()]
    laws = ",\n".join(json.dumps(law_to_dict(sequence.law), allow_nan=False) for sequence in law.sequences)
    first = f'"schema": {json.dumps(HYBRID_SCHEMA)}'
    text = "{\n" + ",\n".join([first, *head, f'"laws": [\n{laws}\n]']) + "\n}\n"
    Path(path).write_text(text, encoding="utf-8", newline="\n")


def read_hybrid_json(path: str | PathLike[str]) -> HybridLaw:
    """The law that a file holds.

    Raises
    ------
    ArgumentError
        It holds something else, or its data is damaged.
    """
    data: Any = json_data(path)
    schema = data.get("schema") if isinstance(data, Mapping) else None
    if schema != HYBRID_SCHEMA:
        raise ArgumentError(f"the data has the schema {schema!r}: {HYBRID_SCHEMA!r} was expected")
    try:
        return law_of(data, [law_from_dict(entry) for entry in data["laws"]])
    except (KeyError, TypeError, ValueError) as error:
        raise ArgumentError(f"the data of a hybrid law is damaged: {type(error).__name__}: {error}") from None
