"""The answer to "do the outputs tell the states apart?", as data and as text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from hysdel_py.reports.columns import aligned, cell
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["Observability", "ObservabilityVerdict"]


class ObservabilityVerdict(Enum):
    """What is known."""

    OBSERVABLE = "observable"
    INDISTINGUISHABLE = "indistinguishable"
    NO_RUN = "no run"
    NOT_SETTLED = "not settled"


_SAID = {
    ObservabilityVerdict.OBSERVABLE: "observable: no two runs of {steps} steps that differ so have the same outputs",
    ObservabilityVerdict.INDISTINGUISHABLE: "indistinguishable: these two runs of {steps} steps have the same outputs",
    ObservabilityVerdict.NO_RUN: "no run: the model has no run of {steps} steps from there",
    ObservabilityVerdict.NOT_SETTLED: "not settled: {message}",
}


@dataclass(frozen=True, eq=False, slots=True)
class Observability:
    """Whether the first state or mode can be told from outputs and inputs.

    Attributes
    ----------
    name : str
        Of the model.
    of : tuple of str
        The states or Boolean auxiliaries that were asked for.
    outcome : ObservabilityVerdict
    steps : int
    apart : mapping of name to float
        By how much real states differ at least.
    resolution : mapping of name to float
        Real outputs that differ by no more are the same.
    first, second : Trajectory or None
        Two runs under the same inputs that the outputs do not tell apart, each replayed by the simulator of the model.
    borderline : bool
        Whether that is so only up to the tolerance of the solver.
    message : str
        Why it is not settled or borderline.
    searches : int
    seconds : float
    """

    name: str
    of: tuple[str, ...]
    outcome: ObservabilityVerdict
    steps: int
    apart: Mapping[str, float]
    resolution: Mapping[str, float]
    first: Trajectory | None
    second: Trajectory | None
    borderline: bool
    message: str
    searches: int
    seconds: float

    @property
    def verdict(self) -> str:
        """The outcome as a word."""
        return self.outcome.value

    def to_dict(self) -> dict[str, Any]:
        """Plain data, ready for JSON."""
        return {
            "verdict": self.verdict,
            "of": list(self.of),
            "steps": self.steps,
            "apart": dict(self.apart),
            "resolution": dict(self.resolution),
            "first": None if self.first is None else self.first.to_dict(),
            "second": None if self.second is None else self.second.to_dict(),
            "borderline": self.borderline,
            "message": self.message,
            "searches": self.searches,
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        lines = [f"{self.name}: {', '.join(self._asked())}"]
        lines.append(_SAID[self.outcome].format(steps=self.steps, message=self.message))
        if self.borderline:
            lines.append(f"borderline: {self.message or 'only up to the tolerance of the solver'}")
        if self.first is not None and self.second is not None:
            lines += ["", *_table(self.first, self.second), *_modes(self.first, self.second)]
        return "\n".join(lines) + "\n"

    def _asked(self) -> Iterator[str]:
        for name in self.of:
            yield f"{name} by {self.apart[name]:g}" if name in self.apart else name


def _table(first: Trajectory, second: Trajectory) -> Iterator[str]:
    """Inputs once, states and outputs of both runs side by side."""
    names = first.names
    rows = [["k", *names["u"], *(f"{n} | {n}" for n in (*names["x"], *names["y"]))]]
    for k in range(first.steps + 1):
        inside = k < first.steps
        pairs = [f"{cell(a)} | {cell(b)}" for a, b in zip(first.x[k], second.x[k], strict=True)]
        pairs += [f"{cell(a)} | {cell(b)}" for a, b in zip(first.y[k], second.y[k], strict=True)] if inside else []
        inputs = list(map(cell, first.u[k])) if inside else [""] * len(names["u"])
        rows.append([str(k), *inputs, *pairs, *[""] * (0 if inside else len(names["y"]))])
    yield from aligned(rows)


def _modes(first: Trajectory, second: Trajectory) -> Iterator[str]:
    """Booleans of the first step that differ."""
    differing = [v for i, v in enumerate(first.variables["d"]) if first.steps and first.d[0, i] != second.d[0, i]]
    named = [v.name for v in differing if not v.generated]
    if named:
        yield from ("", f"step 0: {', '.join(named)} differ")
