"""The answer to "can it be reached?" and "must it be?", as data and as text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any

from hysdel_py.diagnostics.render import place
from hysdel_py.model import Model
from hysdel_py.reports.columns import aligned, cell
from hysdel_py.syntax.source import Span
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["SafetyAnswer", "SafetyVerdict"]


class SafetyVerdict(Enum):
    """What is known."""

    REACHABLE = "reachable"
    UNREACHABLE = "unreachable"
    AVOIDABLE = "avoidable"
    INEVITABLE = "inevitable"
    NO_RUN = "no run"
    NOT_SETTLED = "not settled"


_SAID = {
    SafetyVerdict.REACHABLE: "reachable: this run meets it at step {time}",
    SafetyVerdict.UNREACHABLE: "unreachable: no run meets it at any of the steps 0 to {steps}",
    SafetyVerdict.AVOIDABLE: "avoidable: this run of {steps} steps never meets it",
    SafetyVerdict.INEVITABLE: "inevitable: every run meets it within {steps} steps",
    SafetyVerdict.NO_RUN: "no run: the model has no run of {steps} steps from there",
    SafetyVerdict.NOT_SETTLED: "not settled: {message}",
}


@dataclass(frozen=True, eq=False, slots=True)
class SafetyAnswer:
    """What was found about a condition.

    Attributes
    ----------
    model : Model
    target : str
        The condition in words.
    outcome : SafetyVerdict
    steps : int
        The last step that was judged; for what is inevitable the number of steps within which it is met.
    run : Trajectory or None
        A run that shows it, replayed by the simulator of the model.
    time : int or None
        When the run meets the target.
    borderline : bool
        Whether the run does what was asked only up to the tolerance of the solver.
    message : str
        Why it is not settled or borderline; also that no run lasts for all steps.
    searches : int
        Mixed-integer programs.
    seconds : float
    """

    model: Model
    target: str
    outcome: SafetyVerdict
    steps: int
    run: Trajectory | None
    time: int | None
    borderline: bool
    message: str
    searches: int
    seconds: float

    @property
    def verdict(self) -> str:
        """The outcome as a word: ``"reachable"``, ``"unreachable"``, ``"avoidable"`` and so on."""
        return self.outcome.value

    def to_dict(self) -> dict[str, Any]:
        """Plain data, ready for JSON."""
        return {
            "verdict": self.verdict,
            "target": self.target,
            "steps": self.steps,
            "time": self.time,
            "borderline": self.borderline,
            "run": None if self.run is None else self.run.to_dict(),
            "message": self.message,
            "searches": self.searches,
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        said = _SAID[self.outcome].format(time=self.time, steps=self.steps, message=self.message)
        lines = [f"{self.model.name}: {self.target}", said]
        if self.borderline:
            lines.append(f"borderline: {self.message or 'only up to the tolerance of the solver'}")
        elif self.message and self.outcome is SafetyVerdict.UNREACHABLE:
            lines.append(f"note: {self.message}")
        if self.run is not None:
            lines += ["", *_table(self.run), *_changes(self.run, self.model)]
        return "\n".join(lines) + "\n"


def _table(run: Trajectory) -> Iterator[str]:
    """States, inputs and outputs by step; the last state has no input yet."""
    names = run.names
    rows = [["k", *names["x"], *names["u"], *names["y"]]]
    for k in range(run.steps + 1):
        rest = (*run.u[k], *run.y[k]) if k < run.steps else ("",) * (len(names["u"]) + len(names["y"]))
        rows.append([str(k), *map(cell, run.x[k]), *map(cell, rest)])
    yield from aligned(rows)


def _changes(run: Trajectory, model: Model) -> Iterator[str]:
    """The Booleans of the first step that are true, and where one changes its value, with its source."""
    declared = [(i, v) for i, v in enumerate(run.variables["d"]) if not v.generated]
    if not declared or not run.steps:
        return
    yield from ("", f"step 0: {', '.join(v.name for i, v in declared if run.d[0, i] > 0.5) or 'no Boolean'} true")
    for k in range(1, run.steps):
        for i, v in declared:
            if run.d[k, i] != run.d[k - 1, i]:
                yield f"step {k}: {v.name} becomes {'true' if run.d[k, i] > 0.5 else 'false'}"
                yield from _source(model, v.name)


def _source(model: Model, name: str) -> list[str]:
    definition = model.dha.definitions.get(name)
    if definition is None or definition.origin.end <= definition.origin.start:
        return []
    return place(Span(definition.origin.start, definition.origin.end), model.typed.source)
