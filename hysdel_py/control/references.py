"""Values that the weighted signals should follow, constant or known in advance over the horizon."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError

__all__ = ["Reference", "References", "choose_references"]

Matrix = NDArray[np.float64]
Reference: TypeAlias = Mapping[str, ArrayLike] | ArrayLike | None


@dataclass(frozen=True, slots=True)
class References:
    """Names of the signals that have a reference, and the horizon.

    Attributes
    ----------
    names : tuple of str
        In the order of a reference given as a vector.
    required : bool
        Whether each name needs a value; otherwise a missing one is 0.
    horizon : int
    """

    names: tuple[str, ...]
    required: bool
    horizon: int

    def table(self, ref: Reference) -> dict[str, Matrix]:
        """Return the values at the times 0..N of each name.

        Parameters
        ----------
        ref : mapping of name to number or array, array_like with one entry per name, or None
            A number holds over the whole horizon. An array of length N or N+1 has the value at time k as its entry k;
            with N entries the last one holds at time N as well.

        Raises
        ------
        ArgumentError
            Unknown or missing name, wrong length, not a finite number.
        """
        given = ref if isinstance(ref, (dict, Mapping)) else self._by_order(ref)
        unknown = [str(name) for name in given if name not in self.names]
        if unknown:
            raise ArgumentError(f"reference {', '.join(unknown)} is not known: {self._expected()}")
        missing = [name for name in self.names if name not in given]
        if missing and self.required:
            raise ArgumentError(f"no reference for {', '.join(missing)}: {self._expected()}")
        return {name: self._values(given.get(name, 0.0), name) for name in self.names}

    def _expected(self) -> str:
        return f"expected {', '.join(self.names)}" if self.names else "the controller has no references"

    def _by_order(self, ref: ArrayLike | None) -> Mapping[str, ArrayLike]:
        if ref is None:
            return {}
        try:
            vector = np.atleast_1d(np.array(ref, dtype=float))
        except (TypeError, ValueError):
            raise ArgumentError(
                f"the reference is {ref!r}: a mapping or numbers expected; {self._expected()}"
            ) from None
        if vector.shape != (len(self.names),):
            raise ArgumentError(
                f"the reference has shape {vector.shape}: {len(self.names)} entries were expected; {self._expected()} "
                "(give a mapping of names to arrays for values known in advance)"
            )
        return dict(zip(self.names, vector.tolist(), strict=True))

    def _values(self, value: ArrayLike, name: str) -> Matrix:
        if isinstance(value, float) and isfinite(value):
            return np.full(self.horizon + 1, value)
        try:
            array = np.array(value, dtype=float)
        except (TypeError, ValueError):
            raise ArgumentError(f"reference {name} is {value!r}: a number or an array was expected") from None
        n = self.horizon
        if array.ndim and array.shape not in ((n,), (n + 1,)):
            raise ArgumentError(
                f"reference {name} has shape {array.shape}: expected a number, or an array of length {n} or {n + 1}"
            )
        if not np.isfinite(array).all():
            raise ArgumentError(f"reference {name} has an entry that is not a finite number")
        if array.ndim == 0:
            return np.full(n + 1, float(array))
        return array if len(array) == n + 1 else np.append(array, array[-1])


def choose_references(names: Sequence[str] | None, weighted: Iterable[str], horizon: int) -> References:
    """Return the references of a controller.

    Parameters
    ----------
    names : sequence of str or None
        Signals that need a value in every call; None for any weighted signal, 0 where no value is given.
    weighted : iterable of str
        The signals that the cost names.
    horizon : int

    Raises
    ------
    ArgumentError
        A name without weight, or a name given twice.
    """
    known = tuple(weighted)
    if names is None:
        return References(known, required=False, horizon=horizon)
    if not isinstance(names, Iterable):
        raise ArgumentError(f"references is {names!r}: names of signals were expected")
    chosen = (names,) if isinstance(names, str) else tuple(names)
    without = [str(name) for name in chosen if name not in known]
    if without:
        raise ArgumentError(
            f"references names {', '.join(without)}, which has no weight in the cost; "
            f"signals with a weight: {', '.join(known) or '(none)'}"
        )
    if len(set(chosen)) < len(chosen):
        raise ArgumentError(f"references names a signal twice: {', '.join(chosen)}")
    return References(chosen, required=True, horizon=horizon)
