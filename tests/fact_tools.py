"""What the checks of facts share."""

from __future__ import annotations

from typing import Any

import numpy as np

Fact = dict[str, Any]


class NotSupported(Exception):
    """The package cannot judge this fact yet."""


def close(found, expected, tolerance, what):
    found, expected = np.asarray(found, dtype=float), np.asarray(expected, dtype=float)
    assert found.shape == expected.shape, f"{what} has shape {found.shape}, expected {expected.shape}"
    difference = np.abs(found - expected).max(initial=0.0)
    allowed = tolerance * max(1.0, np.abs(expected).max(initial=0.0))
    assert difference <= allowed, (
        f"{what} is {found.tolist()}, expected {expected.tolist()} (difference {difference:.3g})"
    )


def array(value, columns=None):
    return np.zeros((0, columns or 0)) if value is None else np.array(value, dtype=float)
