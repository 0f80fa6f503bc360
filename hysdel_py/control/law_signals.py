"""What the parameters and the moves of an explicit law stand for."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Any

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.signals import Kind, Type, Variable

__all__ = ["LawSignals", "check_distinct", "last_input_name", "read_signals", "reference_name", "signals_text"]


def last_input_name(name: str) -> str:
    """Name of the parameter that carries the input applied last."""
    return f"{name}(-1)"


def reference_name(name: str) -> str:
    """Name of the parameter that carries a reference."""
    return f"r({name})"


def check_distinct(names: tuple[str, ...]) -> None:
    """Refuse parameters of one name, as a state that is called like an input applied last would give.

    Parameters
    ----------
    names : tuple of str
        Names of all parameters.

    Raises
    ------
    ArgumentError
    """
    twice = dict.fromkeys(name for name in names if names.count(name) > 1)
    if twice:
        raise ArgumentError(
            f"two parameters of the law are called {', '.join(twice)}: different names were expected; "
            "NAME(-1) is the input NAME applied last and r(NAME) the reference of NAME, so give states other names"
        )


@dataclass(frozen=True, slots=True)
class LawSignals:
    """The signals that a law reads and gives.

    Attributes
    ----------
    x, u : tuple of Variable
        States, all of which are parameters, and inputs.
    previous : bool
        Whether the inputs applied last are parameters.
    references : tuple of str
        Signals whose references are parameters.
    increment : bool
        Whether the move is the change of the input instead of the input.
    sample_time : float
    fixed : tuple of (name, value)
        Parameters that were set to numbers.
    required : bool
        Whether a reference must be given; otherwise a missing one is 0.
    """

    x: tuple[Variable, ...]
    u: tuple[Variable, ...]
    previous: bool
    references: tuple[str, ...]
    increment: bool
    sample_time: float = 1.0
    fixed: tuple[tuple[str, float], ...] = ()
    required: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all parameters, those that were fixed among them: states, last inputs, references."""
        last = [last_input_name(v.name) for v in self.u] if self.previous else []
        return (*(v.name for v in self.x), *last, *(reference_name(name) for name in self.references))

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the parameters that are not fixed."""
        given = dict(self.fixed)
        return tuple(name for name in self.names if name not in given)

    @property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Names of the parameters of the states (x), of the last inputs (u) and of the references (r)."""
        names, nx = self.names, len(self.x)
        split = nx + len(self.u) * self.previous
        return {"x": names[:nx], "u": names[nx:split], "r": names[split:]}


def signals_text(signals: LawSignals) -> str:
    """The signals as JSON."""
    plain = asdict(signals)
    for group in ("x", "u"):
        plain[group] = [_plain(v) for v in getattr(signals, group)]
    return json.dumps(plain, sort_keys=True)


def read_signals(text: str) -> LawSignals:
    """The signals from JSON."""
    plain = json.loads(text)
    plain["x"] = tuple(_variable(entry, Kind.STATE) for entry in plain["x"])
    plain["u"] = tuple(_variable(entry, Kind.INPUT) for entry in plain["u"])
    plain["references"] = tuple(plain["references"])
    plain["fixed"] = tuple((str(name), float(value)) for name, value in plain["fixed"])
    return LawSignals(**plain)


def _plain(v: Variable) -> dict[str, Any]:
    kept = {name: getattr(v, name) for name in ("name", "low", "high", "unit", "description")}
    return kept | {"type": v.type.value}


def _variable(entry: dict[str, Any], kind: Kind) -> Variable:
    return Variable(**(entry | {"type": Type(entry["type"]), "kind": kind}))
