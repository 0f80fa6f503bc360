"""What is proven about the closed loop of a predictive controller, premise by premise.

The argument is that of A. Bemporad and M. Morari, "Control of systems integrating logic, dynamics, and constraints",
Automatica 35 (1999), and D. Q. Mayne, J. B. Rawlings, C. V. Rao and P. O. M. Scokaert, "Constrained model predictive
control: stability and optimality", Automatica 36 (2000): a plan without its first step, with one more step from where
it ends, is a plan from the next state. So there always is a plan, and the cost of the best one falls by what the first
step cost, less what the step at the end adds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from math import inf, isfinite, nan
from typing import Any

__all__ = ["PredictiveCertificate", "Premise", "Proof"]


class Proof(Enum):
    """What is known about a premise."""

    PROVEN = "proven"
    VIOLATED = "violated"
    NOT_SETTLED = "not settled"


@dataclass(frozen=True, eq=False, slots=True)
class Premise:
    """One step of the argument.

    Attributes
    ----------
    name : str
    proof : Proof
    by : str
        What was computed.
    message : str
        What is missing, empty where nothing is.
    state : mapping of name to float, or None
        A state for which it does not hold.
    """

    name: str
    proof: Proof
    by: str
    message: str = ""
    state: Mapping[str, float] | None = None

    @property
    def verdict(self) -> str:
        """``"proven"``, ``"violated"`` or ``"not settled"``."""
        return self.proof.value

    @property
    def holds(self) -> bool:
        """Whether it is proven."""
        return self.proof is Proof.PROVEN

    def to_dict(self) -> dict[str, Any]:
        """Plain data, ready for JSON."""
        return {
            "name": self.name, "verdict": self.verdict, "by": self.by, "message": self.message,
            "state": None if self.state is None else dict(self.state),
        }  # fmt: skip

    def __str__(self) -> str:
        lines = [f"  {self.name}: {self.verdict}", *(f"      {text}" for text in (self.by, self.message) if text)]
        if self.state is not None:
            shown = ", ".join(f"{name} = {value:.6g}" for name, value in self.state.items())
            lines.append(f"      at {shown}")
        return "\n".join(lines)


@dataclass(frozen=True, eq=False, slots=True)
class PredictiveCertificate:
    """What is proven about a predictive controller in closed loop with its own model.

    Attributes
    ----------
    name : str
        Of the model.
    horizon : int
    limits : Premise
        A hard limit that the next state or its outputs break has no plan; with ``never`` this is searched.
    terminal : Premise
        From each state in which a plan may end some input keeps the limits and ends there again.
    next_plan : Premise
        The successor of each state with a plan has a plan.
    start : Premise
        Each first state has a plan.
    fall : Premise or None
        The cost of the best plan falls along each step outside of the target; None without a target.
    target : str
        In words; empty without one.
    decrease : float
        By at least so much the cost falls along each step outside of the target; the gap up to which plans are optimal
        is taken off.
    cost : float
        No first state has a best plan that costs more; infinite where the start is not covered.
    floor : float
        No plan costs less.
    parts : int
        Boxes of first states, each with one word of Booleans for the plans of all its states.
    seconds : float
    """

    name: str
    horizon: int
    limits: Premise
    terminal: Premise
    next_plan: Premise
    start: Premise
    fall: Premise | None
    target: str = ""
    decrease: float = nan
    cost: float = inf
    floor: float = 0.0
    parts: int = 0
    seconds: float = 0.0

    @property
    def premises(self) -> tuple[Premise, ...]:
        """All that were asked."""
        found = (self.limits, self.terminal, self.next_plan, self.start, self.fall)
        return tuple(premise for premise in found if premise is not None)

    @property
    def always_has_a_plan(self) -> bool:
        """Whether there is a plan at each step from each first state, and all hard limits are kept for ever."""
        return self.limits.holds and self.next_plan.holds and self.start.holds

    @property
    def steps(self) -> int | None:
        """Within so many steps the target is reached from each first state; None where that is not proven."""
        if self.fall is None or not (self.always_has_a_plan and self.fall.holds and isfinite(self.cost)):
            return None
        return int(max(0.0, self.cost - self.floor) // self.decrease) + 1

    @property
    def verdict(self) -> str:
        """``"proven"`` where all that was asked is; ``"violated"`` where a premise is contradicted; ``"not settled"``.

        The terminal set serves to show that there is a next plan, and does not count where that is shown otherwise.
        """
        asked = [premise for premise in self.premises if premise is not self.terminal]
        if all(premise.holds for premise in asked):
            return "proven"
        broken = any(premise.proof is Proof.VIOLATED for premise in asked)
        return "violated" if broken else "not settled"

    def to_dict(self) -> dict[str, Any]:
        """Plain data, ready for JSON."""
        return {
            "verdict": self.verdict, "model": self.name, "horizon": self.horizon, "target": self.target,
            "premises": [premise.to_dict() for premise in self.premises], "steps": self.steps,
            "decrease": _number(self.decrease), "cost": _number(self.cost), "floor": self.floor, "parts": self.parts,
            "seconds": self.seconds,
        }  # fmt: skip

    def __str__(self) -> str:
        lines = [f"{self.name}, plans of {self.horizon} steps: {self.verdict}", *map(str, self.premises)]
        if self.always_has_a_plan:
            lines.append("there is a plan at every step, and hard limits are kept for ever")
        if self.steps is not None:
            lines.append(f"{self.target}: reached within {self.steps} steps, as long as every plan is proven optimal")
        return "\n".join(lines) + "\n"


def _number(value: float) -> float | None:
    return value if isfinite(value) else None
