"""Ranges of affine forms, from which the big-M constants are taken.

``interval`` is the rule of the original compiler: a variable has its declared range, else the range of its definition;
a form has the interval of its collected terms. Where neither gives a range, the default bound of the Dha does, if it
has one, with a warning.
``lp`` starts from it and is in :mod:`hysdel_py.lowering.tightening`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Protocol

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Label
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.syntax.source import Span
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, Definition, Dha, Event, Switch
from hysdel_py.systems.origin import Origin
from hysdel_py.systems.symbolic import greatest, is_finite, least

__all__ = ["BigM", "EventConstants", "Ranges", "Rule", "SwitchConstants"]

Interval = tuple[float, float]
_UNKNOWN = (-math.inf, math.inf)


class BigM(Enum):
    """How the big-M constants are computed."""

    INTERVAL = "interval"
    LP = "lp"


@dataclass(frozen=True, slots=True)
class EventConstants:
    """Constants of ``f >= eps + (m - eps) d`` and ``f <= M (1 - d)``: `low` is m, `high` is M."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class SwitchConstants:
    """Coefficients of s in the four rows of ``z = {IF s THEN f1 ELSE f2}``.

    ::

        f1 - z + c1 s <= c1      c1 bounds f1 - f2 where s = 0
        z - f1 + c2 s <= c2      c2 bounds f2 - f1 where s = 0
        f2 - z + c3 s <= 0      -c3 bounds f2 - f1 where s = 1
        z - f2 + c4 s <= 0      -c4 bounds f1 - f2 where s = 1
    """

    c1: float
    c2: float
    c3: float
    c4: float

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """What each row allows when it is switched off."""
        return self.c1, self.c2, 0.0 - self.c3, 0.0 - self.c4


class Rule(Protocol):
    """Gives the constants of rows and the ranges of variables."""

    def event(self, event: Event) -> EventConstants:
        """Constants of the two rows of an event."""

    def switch(self, switch: Switch) -> SwitchConstants:
        """Constants of the four rows of a switch."""

    def of_variable(self, name: str) -> Interval:
        """Range of a variable, infinite where it is not known."""


class Ranges:
    """Ranges of variables and forms of one Dha, computed when first needed.

    Mistakes are reported once for each item that needs a range which does not exist.
    """

    def __init__(self, dha: Dha, sink: Sink, declared: Mapping[str, Span] | None = None) -> None:
        self._definitions = dha.definitions
        self._sink = sink
        self._declared = declared or {}
        self._tolerance = dha.tolerances.range
        self._default = dha.default_bound
        self._known: dict[str, Interval] = {
            v.name: (v.low, v.high)
            for v in (*dha.x, *dha.u, *dha.y, *dha.d, *dha.z)
            if is_finite(v.low) or is_finite(v.high)
        }

    def of(self, form: Affine, limits: Interval | None, origin: Origin) -> Interval:
        """Range of a form, or the stated limits; unknown ranges are errors at `origin`."""
        if limits is not None:
            self._warn_of_loose(form, limits, origin)
            return limits
        for name, coefficient in form.terms:
            if coefficient and not self._settle(name, origin):
                return (0.0, 0.0)
        low, high = form.range(self._known.__getitem__)
        if not (is_finite(low) and is_finite(high)):
            infinite = [n for n, c in form.terms if c and not all(map(is_finite, self._known[n]))]
            self._report(Code.NO_BOUNDS, f"the range of {', '.join(infinite)} is not finite", origin, infinite[-1:])
            return (0.0, 0.0)
        return low, high

    def event(self, event: Event) -> EventConstants:
        """Constants of the two rows of an event."""
        return EventConstants(*self.of(event.form, event.limits, event.origin))

    def switch(self, switch: Switch) -> SwitchConstants:
        """Constants of the four rows of a switch."""
        (f1, limits1), (f2, limits2) = switch.branches
        low1, high1 = self.of(f1, limits1, switch.origin)
        low2, high2 = self.of(f2, limits2, switch.origin)
        return SwitchConstants(high1 - low2, high2 - low1, low1 - high2, low2 - high1)

    @property
    def known(self) -> Mapping[str, Interval]:
        """Ranges that are declared or have been needed so far, by the name of the variable."""
        return MappingProxyType(self._known)

    def _warn_of_loose(self, form: Affine, limits: Interval, origin: Origin) -> None:
        if not all(self._settle(name, None) for name, coefficient in form.terms if coefficient):
            return
        low, high = form.range(self._known.__getitem__)
        slack = self._tolerance * max(1.0, abs(low), abs(high))
        if limits[0] < low - slack or limits[1] > high + slack:
            self._sink.warning(
                Code.LOOSE_TRIPLE,
                f"the stated range [{limits[0]:g}, {limits[1]:g}] is wider than [{low:g}, {high:g}] of {form}",
                Span(origin.start, origin.end),
                help="tighter ranges give tighter relaxations; without [min, max, epsilon] they are computed",
            )

    def of_variable(self, name: str) -> Interval:
        """Range of a variable if it can be known, else infinite; never an error."""
        return self._known[name] if self._settle(name, None) else _UNKNOWN

    def _settle(self, name: str, origin: Origin | None) -> bool:
        """Make the range of a variable known, following definitions depth first; report to `origin` if given."""
        path: list[str] = [name]
        while path:
            current = path[-1]
            needed = self._missing_for(current)
            if needed is None and self._assume(current, origin):
                continue
            if needed is None:
                self._report(Code.NO_BOUNDS, f"{current} has neither bounds nor a definition", origin, [current])
                return False
            if needed in path and self._assume(needed, origin):
                continue
            if needed in path:
                circle = [*path[path.index(needed) :], needed]
                self._report(
                    Code.CIRCULAR_BOUNDS, f"the range of {' <- '.join(circle)} depends on itself", origin, [needed]
                )
                return False
            if needed:
                path.append(needed)
            else:
                if current not in self._known:
                    self._known[current] = self._from_definition(self._definitions.get(current))
                path.pop()
        return True

    def _assume(self, name: str, origin: Origin | None) -> bool:
        """Give a variable the default bound where an item needs its range; False if there is no default."""
        if origin is None or math.isinf(self._default):
            return False
        self._known[name] = (-self._default, self._default)
        self._sink.warning(
            Code.ASSUMED_BOUNDS,
            f"{name} has no range: [{-self._default:g}, {self._default:g}] of MLD_bigMbound is assumed",
            self._declared.get(name, Span(origin.start, origin.end)),
            help=f"outside of it the MLD form has no step; declare the true range, as in REAL {name} [low, high];",
            labels=(Label(Span(origin.start, origin.end), "this item needs it for a big-M constant"),)
            if name in self._declared
            else (),
        )
        return True

    def _missing_for(self, name: str) -> str | None:
        """A variable whose range is needed first, "" if none is, None if there is nothing to compute from."""
        if name in self._known:
            return ""
        definition = self._definitions.get(name)
        if not isinstance(definition, AffineEquation | Switch):
            return None
        forms = [form for form, limits in _forms(definition) if limits is None]
        missing = (n for form in forms for n, c in form.terms if c and n not in self._known)
        return next(missing, "")

    def _from_definition(self, definition: Definition | None) -> Interval:
        if not isinstance(definition, AffineEquation | Switch):
            return _UNKNOWN
        ends = [
            form.range(self._known.__getitem__) if limits is None else limits for form, limits in _forms(definition)
        ]
        return least(*(low for low, _ in ends)), greatest(*(high for _, high in ends))

    def _report(self, code: Code, fact: str, origin: Origin | None, names: list[str]) -> None:
        if origin is None:
            return
        self._sink.error(
            code,
            f"this item needs a big-M constant, but {fact}",
            Span(origin.start, origin.end),
            help=f"declare a range, as in REAL {names[0] if names else 'x'} [low, high]; or one for all variables that "
            "have none, by the parameter REAL MLD_bigMbound = 1e4;",
            labels=tuple(Label(self._declared[name], "declared here") for name in names if name in self._declared),
        )


def _forms(definition: AffineEquation | Switch) -> list[tuple[Affine, Interval | None]]:
    if isinstance(definition, AffineEquation):
        return [(definition.value, None)]
    return [(definition.then, definition.then_limits), (definition.otherwise, definition.otherwise_limits)]
