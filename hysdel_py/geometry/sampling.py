"""Points that fill a box evenly, the same ones each time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["spread_points"]


def spread_points(count: int, dimension: int) -> NDArray[np.float64]:
    """Points of the additive recurrence in ``(0, 1)^n`` with the powers of the generalised golden ratio as steps.

    The ratio is the positive root of ``r^(n+1) = r + 1``; for n = 1 the sequence is that of the golden ratio.
    """
    ratio = 2.0
    for _ in range(60):
        ratio = (1.0 + ratio) ** (1.0 / (dimension + 1))
    steps = ratio ** -np.arange(1.0, dimension + 1)
    return np.asarray((0.5 + np.arange(1.0, count + 1)[:, None] * steps) % 1.0)
