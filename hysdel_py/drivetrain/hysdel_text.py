"""A sampled drivetrain as a ``.hys`` text, so that a controller can be designed on what was simulated.

One step of Moreau's scheme or of the theta scheme is a piecewise affine map of speeds, twists and inputs: for each
choice of sticking and slipping contacts the impulses are affine, and the choice holds where they keep their limits and
the slips have the right signs. With Euler steps and Karnopp's rule the band takes the place of these conditions.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hysdel_py.drivetrain.checks import is_number
from hysdel_py.drivetrain.equations import Equations
from hysdel_py.drivetrain.sampled_step import (
    Branch,
    Sampled,
    branches_of,
    euler_step,
    karnopp_branches,
    moreau_step,
)
from hysdel_py.drivetrain.schemes.options import Karnopp, Moreau
from hysdel_py.drivetrain.signals import PiecewiseLinear
from hysdel_py.errors import ArgumentError

__all__ = ["hysdel_text"]

Matrix = NDArray[np.float64]
Ranges = Mapping[str, tuple[float, float]]

_MOST_CONTACTS = 3


def hysdel_text(equations: Equations, ranges: Ranges, scheme: Moreau | Karnopp, name: str = "drivetrain") -> str:
    """The text of the sampled model.

    Parameters
    ----------
    equations : Equations
    ranges : mapping of name to (low, high)
        Of every independent shaft and spring, and of the signals that become inputs; signals without a range have to be
        constant.
    scheme : Moreau or Karnopp
        With its step; Karnopp with ``integrator="euler"`` and one contact.
    name : str
        Of the system.

    Raises
    ------
    ArgumentError
        A range is missing or unknown, or these equations have no such piecewise affine step.
    """
    _check(equations, scheme)
    states = (*equations.names.coordinates, *equations.names.springs)
    _check_ranges(equations, ranges, states)
    inputs = [s for s in equations.signal_names if s in ranges and s not in states]
    step = moreau_step(equations, scheme) if isinstance(scheme, Moreau) else euler_step(equations, scheme)
    writer = _Writer(equations, inputs)
    branches = branches_of(step) if isinstance(scheme, Moreau) else karnopp_branches(step, float(scheme.band or 0.0))
    lines = _lines(equations, writer, step, branches, ranges, inputs, name, scheme)
    return "\n".join(lines)


def _check(equations: Equations, scheme: Moreau | Karnopp) -> None:
    if not equations.linear:
        raise ArgumentError("drag, engine maps and Stribeck friction have no piecewise affine step")
    if any(law.parameters[0] != law.parameters[1] for law in equations.laws):
        raise ArgumentError("contacts with different static and dynamic coefficients need a memory: make them equal")
    if np.any(equations.gains.shaft):
        raise ArgumentError("a SpeedSource cannot become part of a sampled model")
    count = len(equations.laws)
    if isinstance(scheme, Karnopp):
        if scheme.integrator != "euler" or scheme.band is None or count > 1:
            raise ArgumentError('Karnopp becomes a sampled model with integrator="euler", a band, and one contact')
    elif not isinstance(scheme, Moreau):
        raise ArgumentError(f"{type(scheme).__name__} has no piecewise affine step: Moreau or Karnopp was expected")
    if count > _MOST_CONTACTS:
        raise ArgumentError(f"{count} contacts have {3**count} modes: at most {_MOST_CONTACTS} contacts are written")


def _check_ranges(equations: Equations, ranges: Ranges, states: Sequence[str]) -> None:
    missing = [state for state in states if state not in ranges]
    if missing:
        raise ArgumentError(f"ranges has none for {', '.join(missing)}: every shaft and spring needs one")
    for known, given in ranges.items():
        if known not in states and known not in equations.signal_names:
            every = ", ".join((*states, *equations.signal_names))
            raise ArgumentError(f"ranges names {known}, which is no state and no signal: it may name {every}")
        if not (
            isinstance(given, Sequence) and len(given) == 2 and all(map(is_number, given)) and given[0] <= given[1]
        ):
            raise ArgumentError(f"range of {known} is {given!r}: two finite ascending numbers were expected")
    forces = np.flatnonzero(np.any(equations.gains.pressure != 0, axis=0))
    for known in (equations.signal_names[i] for i in forces):
        if known in ranges and ranges[known][0] < 0:
            raise ArgumentError(
                f"range of {known} begins at {ranges[known][0]:g}: a normal force of zero or more was expected"
            )


class _Writer:
    """Writes affine forms in the names of the language."""

    def __init__(self, equations: Equations, inputs: Sequence[str]) -> None:
        states = (*equations.names.coordinates, *equations.names.springs)
        self.states = [identifier(name) for name in states]
        self.inputs = [identifier(name) for name in inputs]
        every = [*self.states, *self.inputs, *(identifier(name) for name in equations.names.contacts)]
        names = [*self.states, *(identifier(name) + "_u" for name in equations.signal_names)]
        if len(set(names)) < len(names) or len(set(every[: len(self.states)])) < len(self.states):
            raise ArgumentError(f"names {', '.join(every)} are not different once they are written as identifiers")
        self._constants = _constants(equations, inputs)
        self._names = names

    def form(self, row: Matrix) -> str:
        """One row over (states, signals, 1) as text."""
        constant = float(row[-1])
        terms = []
        for i, factor in enumerate(row[:-1]):
            signal = i - len(self.states)
            if signal in self._constants:
                constant += float(factor) * self._constants[signal]
            elif factor != 0.0:
                terms.append(f"{float(factor)!r}*{self._names[i]}")
        if constant != 0.0 or not terms:
            terms.append(repr(constant))
        return " + ".join(f"({term})" if term.startswith("-") else term for term in terms)


def identifier(name: str) -> str:
    """A name of the language: letters, digits and underscores."""
    return re.sub(r"\W", "_", name if name[:1].isalpha() else f"x{name}")


def _constants(equations: Equations, inputs: Sequence[str]) -> dict[int, float]:
    """Values of the signals that are no inputs; a normal force below zero is none."""
    found = {}
    pressures = np.any(equations.gains.pressure != 0, axis=0)
    for i, (name, signal) in enumerate(zip(equations.signal_names, equations.signals, strict=True)):
        if name not in inputs:
            value = _constant(name, signal)
            found[i] = max(value, 0.0) if pressures[i] else value
    return found


def _constant(name: str, signal: object) -> float:
    if not isinstance(signal, PiecewiseLinear) or np.ptp(signal.values) != 0.0:
        raise ArgumentError(f"signal {name} is not constant: give its range to make it an input")
    return float(signal.values[0])


def _lines(
    equations: Equations,
    writer: _Writer,
    step: Sampled,
    branches: Sequence[Branch],
    ranges: Ranges,
    inputs: Sequence[str],
    name: str,
    scheme: Moreau | Karnopp,
) -> Iterator[str]:
    contacts = [identifier(contact) for contact in equations.names.contacts]
    modes = [f"mode_{branch.word}" for branch in branches]
    parts = [f"P_{contact}_{branch.word}" for branch in branches for contact in contacts]
    events = [f"ok_{branch.word}_{k}" for branch in branches[:-1] for k in range(len(branch.conditions))]
    yield f"/* One step of {type(scheme).__name__} with dt = {scheme.dt!r} s, written by hysdel_py. */"
    yield f"SYSTEM {identifier(name)} {{ INTERFACE {{ STATE {{"
    for state in (*equations.names.coordinates, *equations.names.springs):
        yield f"REAL {identifier(state)} [{ranges[state][0]!r}, {ranges[state][1]!r}];"
    yield "}"
    if writer.inputs:
        yield "INPUT {"
        for signal in inputs:
            yield f"REAL {identifier(signal)}_u [{ranges[signal][0]!r}, {ranges[signal][1]!r}];"
        yield "}"
    yield from _block("OUTPUT", [f"REAL {c}_slip, {c}_torque;" for c in contacts])
    yield "} IMPLEMENTATION {"
    if contacts:
        yield f"AUX {{ BOOL {', '.join([*events, *modes])}; REAL {', '.join(parts)}; }}"
        yield from _block("AD", list(_event_lines(writer, branches)))
        yield from _block("LOGIC", list(_mode_lines(branches)))
        yield from _block("DA", list(_impulse_lines(writer, branches, contacts)))
    yield from _block("CONTINUOUS", list(_update_lines(writer, step, branches, contacts)))
    rows = [(f"{c}_slip", writer.form(step.now[i])) for i, c in enumerate(contacts)]
    rows += [(f"{c}_torque", f"{-1.0 / step.per_torque!r}*({_sum(c, branches)})") for c in contacts]
    yield from _block("OUTPUT", [f"{left} = {right};" for left, right in rows])
    yield "} }"


def _block(keyword: str, lines: list[str]) -> list[str]:
    return [f"{keyword} {{", *lines, "}"] if lines else []


def _event_lines(writer: _Writer, branches: Sequence[Branch]) -> Iterator[str]:
    for branch in branches[:-1]:
        for k, condition in enumerate(branch.conditions):
            yield f"ok_{branch.word}_{k} = {writer.form(condition)} <= 0;"


def _mode_lines(branches: Sequence[Branch]) -> Iterator[str]:
    """The first mode whose conditions hold; the last one where none does."""
    for i, branch in enumerate(branches):
        holds = [f"ok_{branch.word}_{k}" for k in range(len(branch.conditions))] if i < len(branches) - 1 else []
        others = [f"~mode_{earlier.word}" for earlier in branches[:i]]
        yield f"mode_{branch.word} = {' & '.join([*holds, *others]) or 'TRUE'};"


def _impulse_lines(writer: _Writer, branches: Sequence[Branch], contacts: Sequence[str]) -> Iterator[str]:
    for branch in branches:
        for i, contact in enumerate(contacts):
            yield f"P_{contact}_{branch.word} = {{IF mode_{branch.word} THEN {writer.form(branch.P[i])} ELSE 0}};"


def _sum(contact: str, branches: Sequence[Branch]) -> str:
    return " + ".join(f"P_{contact}_{branch.word}" for branch in branches)


def _update_lines(writer: _Writer, step: Sampled, branches: Sequence[Branch], contacts: Sequence[str]) -> Iterator[str]:
    rows = [*zip(step.speeds, step.speed_gain, strict=True), *zip(step.twists, step.twist_gain, strict=True)]
    for state, (row, gains) in zip(writer.states, rows, strict=True):
        terms = [f"({float(g)!r})*({_sum(c, branches)})" for c, g in zip(contacts, gains, strict=True) if g != 0.0]
        yield f"{state} = {' + '.join([writer.form(row), *terms])};"
