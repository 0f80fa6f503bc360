"""Numbers in columns, as all answers print them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

__all__ = ["aligned", "cell"]


def aligned(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Rows of texts, of one length each, as indented lines with the columns flush right."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        yield "  " + "  ".join(text.rjust(width) for text, width in zip(row, widths, strict=True)).rstrip()


def cell(value: Any) -> str:
    """A number with six digits, what rounding leaves of a zero as 0; a text as it is."""
    return value if isinstance(value, str) else f"{np.round(value, 12) + 0.0:.6g}"
