"""Values of matrix parameters that the caller gives."""

from __future__ import annotations

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.elaboration.scope import Shape
from hysdel_py.syntax.source import Span

__all__ = ["entries_of"]


def entries_of(value: object, shape: Shape, name: str, span: Span, sink: Sink) -> list[float]:
    """Entries row by row; an error and nothing if the value is no matrix of this size."""
    import numpy as np

    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        sink.error(Code.PARAMETER_VALUE, f"the parameter {name} was given {value!r:.80}: numbers were expected", span)
        return []
    flat = array.ndim == 1 and 1 in (shape.rows, shape.columns) and array.size == shape.rows * shape.columns
    if array.shape != (shape.rows, shape.columns) and not flat:
        found = "-by-".join(map(str, array.shape)) or "a single number"
        sink.error(Code.SIZE_MISMATCH, f"the parameter {name} is {shape.size} and was given {found}", span)
        return []
    return [float(entry) for entry in array.ravel()]
