"""Whatever form a JSON file of :mod:`hysdel_py.export` holds: its schema says which."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import Any

from hysdel_py.errors import ArgumentError
from hysdel_py.export.matrices import SCHEMA
from hysdel_py.export.pwa_data import PWA_SCHEMA, pwa_from_dict
from hysdel_py.export.reading import json_data, mld_from_dict
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.pwa import Pwa

__all__ = ["read_json"]

_READERS: dict[str, Callable[[Mapping[str, Any]], Mld | Pwa]] = {SCHEMA: mld_from_dict, PWA_SCHEMA: pwa_from_dict}


def read_json(path: str | os.PathLike[str]) -> Mld | Pwa:
    """The form that a JSON file holds, equal to what was written.

    Parameters
    ----------
    path : str or path
        A file that ``hysdel compile`` wrote with or without ``--form pwa``.

    Returns
    -------
    Mld or Pwa

    Raises
    ------
    ArgumentError
        It holds something else, or its data is damaged.
    """
    data = json_data(path)
    schema = data.get("schema") if isinstance(data, Mapping) else None
    reader = _READERS.get(schema) if isinstance(schema, str) else None
    if reader is None:
        expected = " or ".join(map(repr, _READERS))
        raise ArgumentError(f"{os.fspath(path)}: the data has the schema {schema!r}: {expected} was expected")
    return reader(data)
