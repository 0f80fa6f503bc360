"""The answer to "why is there no input?", as data and as text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hysdel_py.analysis.contradiction import Finding, Verdict
from hysdel_py.analysis.horizon import Demand
from hysdel_py.model import Model
from hysdel_py.reports.parts import Part, parts_of
from hysdel_py.reports.remedies import remedies
from hysdel_py.reports.wording import explanation_text
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["Explanation"]


@dataclass(frozen=True, eq=False, slots=True)
class Explanation:
    """What contradicts each other over some steps, or a run if there is one.

    Attributes
    ----------
    model : Model
    horizon : int
    demands : tuple of Demand
        The limits beside the model.
    finding : Finding
        What the search found, step by step.
    """

    model: Model
    horizon: int
    demands: tuple[Demand, ...]
    finding: Finding

    @property
    def verdict(self) -> str:
        """``"feasible"``, ``"smallest"`` (proven), ``"irreducible"`` or ``"not settled"``."""
        return self.finding.verdict.value

    @property
    def feasible(self) -> bool:
        """Whether there is a run, which the simulator confirms."""
        return self.finding.verdict is Verdict.FEASIBLE

    @property
    def run(self) -> Trajectory | None:
        """A run, None where there is none."""
        return self.finding.run

    @property
    def parts(self) -> tuple[Part, ...]:
        """What contradicts each other, each with its steps: what is demanded first, definitions behind it."""
        return parts_of(self.finding, self.model)

    @property
    def remedies(self) -> tuple[str, ...]:
        """Changes of which each alone would allow a run, in words."""
        return remedies(self.finding, self.model.dha, self.demands)

    def to_dict(self) -> dict[str, Any]:
        """Plain data, ready for JSON."""
        found = self.finding
        return {
            "verdict": self.verdict,
            "horizon": self.horizon,
            "borderline": found.borderline,
            "least_violation": found.violation,
            "contradiction": [part.to_dict(self.model.typed.source) for part in self.parts],
            "remedies": list(self.remedies),
            "run": None if found.run is None else found.run.to_dict(),
            "message": found.message,
            "searches": found.calls,
            "seconds": found.seconds,
        }

    def __str__(self) -> str:
        return explanation_text(self.finding, self.horizon, self.parts, self.remedies, self.model.typed)
