"""Whether two models have the same steps: names first, then both whole steps over the same states and inputs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

from hysdel_py.analysis.clock import Clock, Watch
from hysdel_py.analysis.diff_report import DiffCheck, Difference, NameChange, Responsible
from hysdel_py.analysis.margins import Margins
from hysdel_py.analysis.pair import Pair, Side
from hysdel_py.analysis.report import CheckStatus
from hysdel_py.analysis.stepping import Witness
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.dha import AffineRequirement, Dha, DhaItem, LogicRequirement, read_by
from hysdel_py.systems.origin import Origin
from hysdel_py.systems.signals import Variable

if TYPE_CHECKING:
    from typing import Protocol

    class HasDha(Protocol):
        """A model."""

        @property
        def dha(self) -> Dha:
            """The automaton."""


__all__ = ["diff"]


def diff(
    old: HasDha,
    new: HasDha,
    *,
    margins: Margins | None = None,
    seconds: float = inf,
    progress: Watch | None = None,
) -> Difference:
    """Compare two models: a state and input at which they differ, or a proof that there is none.

    Variables belong together by name. A state or input that only one model has may take any value there.

    Parameters
    ----------
    old, new : Model
    margins : Margins, optional
        Band around thresholds and tolerance of the statement.
    seconds : float
        Time limit; what is not settled then is said to be.
    progress : callable, optional
        Told the number of searches begun; a true answer ends the work as if its time were over.

    Returns
    -------
    Difference

    Raises
    ------
    ArgumentError
        The models have no value of a variable in common, or a variable that the proof needs has no finite range.
    """
    if not seconds > 0:
        raise ArgumentError(f"seconds is {seconds:g}: a time above 0 was expected")
    chosen = Margins() if margins is None else margins
    changes = tuple(_name_changes(old.dha, new.dha))
    pair = Pair(_over_common(old.dha, new.dha), _over_common(new.dha, old.dha), chosen, Clock(seconds, progress))
    checks = tuple(_checks(pair))
    return Difference(
        old.dha.source or old.dha.name, new.dha.source or new.dha.name, changes, checks, chosen.band, chosen.tolerance
    )


# ---- names ----------------------------------------------------------------------------------------------------------


def _name_changes(old: Dha, new: Dha) -> Iterator[NameChange]:
    ours, theirs = ({v.name: v for v in (*d.x, *d.u, *d.y, *d.d, *d.z) if not v.generated} for d in (old, new))
    for name in dict.fromkeys([*ours, *theirs]):
        before, after = (_declaration(side.get(name)) for side in (ours, theirs))
        if before != after and not (_is_auxiliary(ours, name) and _is_auxiliary(theirs, name)):
            yield NameChange(name, before, after)


def _is_auxiliary(variables: Mapping[str, Variable], name: str) -> bool:
    """Whether a name stands for nothing but an auxiliary, which is a matter of how a model is written."""
    return name not in variables or variables[name].kind.value in "dz"


def _declaration(variable: Variable | None) -> str:
    if variable is None:
        return ""
    kind = {"x": "state", "u": "input", "y": "output"}.get(variable.kind.value, "auxiliary")
    ranged = not variable.is_bool and kind in ("state", "input")
    return f"{variable.type.value} {kind}" + (f" in [{variable.low:g}, {variable.high:g}]" if ranged else "")


def _over_common(dha: Dha, other: Dha) -> Dha:
    """A Dha over the ranges that the other one has as well."""
    theirs = {(v.name, v.kind, v.type): v for v in (*other.x, *other.u)}
    x, u = (tuple(_narrowed(v, theirs.get((v.name, v.kind, v.type))) for v in group) for group in (dha.x, dha.u))
    return replace(dha, x=x, u=u)


def _narrowed(variable: Variable, other: Variable | None) -> Variable:
    if other is None:
        return variable
    low, high = max(variable.low, other.low), min(variable.high, other.high)
    if low > high:
        raise ArgumentError(f"the ranges of {variable.name} in the two models have nothing in common")
    return replace(variable, low=low, high=high)


# ---- checks ---------------------------------------------------------------------------------------------------------


def _checks(pair: Pair) -> Iterator[DiffCheck]:
    for group, mark in (("x", "'"), ("y", "")):
        for name in pair.common(group):
            yield _value_check(pair, name, mark)
    for side in (pair.old, pair.new):
        for requirement in side.dha.requirements:
            yield _requirement_check(pair, side, requirement)


def _value_check(pair: Pair, name: str, mark: str) -> DiffCheck:
    if _same_items(pair, name):
        return DiffCheck(name + mark, CheckStatus.HOLDS, "items")
    status, witness = pair.differing_value(name, mark)
    responsible = () if witness is None else tuple(_responsible(pair, witness, name))
    return DiffCheck(name + mark, status, "model", witness, responsible)


def _requirement_check(pair: Pair, side: Side, requirement: AffineRequirement | LogicRequirement) -> DiffCheck:
    which = "old" if side is pair.old else "new"
    subject = f"MUST of the {which} model, {requirement.origin}"
    other = pair.new if side is pair.old else pair.old
    same = [twin for twin in other.dha.requirements if _bare(twin) == _bare(requirement)]
    if same and all(_same_items(pair, name) for name in read_by(requirement)):
        return DiffCheck(subject, CheckStatus.HOLDS, "items")
    status, witness = pair.violated_here_alone(side, requirement)
    if witness is None:
        return DiffCheck(subject, status, "model")
    first = tuple(_responsible(pair, witness, ""))
    twin = same[0].origin if same else None
    own = (requirement.origin, twin) if side is pair.old else (twin, requirement.origin)
    return DiffCheck(subject, status, "model", witness, first or (Responsible("MUST", *own),))


def _bare(item: DhaItem) -> DhaItem:
    return replace(item, origin=Origin())


def _same_items(pair: Pair, name: str) -> bool:
    """Whether both models define a variable by the same items, down to states and inputs that both have."""
    pending, seen = [name], set()
    while pending:
        current = pending.pop()
        if current in seen:
            continue
        seen.add(current)
        ours, theirs = (side.dha.definitions.get(current) for side in (pair.old, pair.new))
        is_given = current in pair.shared and current != name
        if is_given:
            continue
        if ours is None or theirs is None or _bare(ours) != _bare(theirs):
            return ours is None and theirs is None and current in pair.shared
        pending += read_by(ours)
    return True


def _responsible(pair: Pair, witness: Witness, subject: str) -> Iterator[Responsible]:
    """Auxiliaries whose values differ although the common ones that they read agree; else the subject."""
    values = pair.auxiliary_values(witness)
    concerned = pair.reads(subject) if subject else set(values[0])
    names = [name for name in values[0] if name in values[1] and name in concerned and not name.startswith("__")]
    apart = {name for name in names if abs(values[0][name] - values[1][name]) > pair.value_tolerance(name)}
    first = [name for name in names if name in apart and not apart & pair.reads(name)]
    for name in first or ([subject] if subject else []):
        yield Responsible(name, *(_origin(side.dha, name) for side in (pair.old, pair.new)))


def _origin(dha: Dha, name: str) -> Origin | None:
    definition = dha.definitions.get(name)
    return None if definition is None else definition.origin
