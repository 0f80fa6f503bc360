"""How large the big-M constants of a model are, how loose, and where that comes from."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.diagnostic import Diagnostic
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.lowering.big_m import Ranges, Rule
from hysdel_py.lowering.mld import assemble
from hysdel_py.lowering.redundancy import RemovedRow, remove_redundant_rows
from hysdel_py.lowering.sharing import share
from hysdel_py.lowering.tightening import tighten
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, Dha, Event, Switch
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.origin import RowOrigin
from hysdel_py.systems.signals import Variable

__all__ = ["Audit", "AuditRow", "Contribution", "Scaling", "audit_dha"]

_DECIDED = (Code.NEVER_SWITCHES, Code.DEAD_BRANCH)


@dataclass(frozen=True, slots=True)
class Contribution:
    """What the range of one variable adds to a constant.

    Attributes
    ----------
    variable : Variable
        A variable of the form, with the range that counts.
    size : float
        Its coefficient times the width of that range.
    declared : Variable
        The variable itself, or the one with a declared range that makes it as wide as it is.
    """

    variable: Variable
    size: float
    declared: Variable


@dataclass(frozen=True, slots=True)
class AuditRow:
    """One row with a big-M constant.

    Attributes
    ----------
    index : int
        Number of the row in E, from 0.
    origin : RowOrigin
    interval, lp : float
        What the row allows when it is switched off, by each of the two rules.
    largest, smallest : float
        Absolute values of the coefficients of the row with the LP constant.
    epsilon : float or None
        Gap of a threshold.
    sources : tuple of Contribution
        The variables whose ranges make the constant, the one that matters most first.
    """

    index: int
    origin: RowOrigin
    interval: float
    lp: float
    largest: float
    smallest: float
    epsilon: float | None
    sources: tuple[Contribution, ...]

    @property
    def looseness(self) -> float:
        """How many times larger the interval constant is than the LP constant; infinite where the latter is 0."""
        if self.interval == self.lp:
            return 1.0
        return self.interval / self.lp if self.lp > 0 else math.inf

    @property
    def condition(self) -> float:
        """Largest over smallest coefficient of the row."""
        return self.largest / self.smallest if self.smallest else 1.0

    @property
    def resolution(self) -> float | None:
        """Gap of a threshold relative to the largest coefficient of its row: solvers must be finer than that."""
        return None if self.epsilon is None or not self.largest else self.epsilon / self.largest

    @property
    def advice(self) -> str:
        """Which declared range makes the constant what it is, and what to do."""
        total = sum(source.size for source in self.sources)
        if not total:
            return ""
        first = self.sources[0]
        v = first.declared
        line = f", line {v.line}" if v.line else ""
        through = "" if v is first.variable else f" through {first.variable.name}"
        return (
            f"{first.size:.4g} of {total:.4g} comes{through} from the range [{v.low:g}, {v.high:g}] of {v.name}{line}"
        )


@dataclass(frozen=True, slots=True)
class Scaling:
    """Largest and smallest absolute coefficient of one variable over all rows."""

    variable: Variable
    largest: float
    smallest: float


@dataclass(frozen=True, eq=False, slots=True)
class Audit:
    """Result of :func:`audit_dha`.

    Attributes
    ----------
    name, source : str
    rows : tuple of AuditRow
        Rows of AD and DA, the loosest first.
    scalings : tuple of Scaling
        Variables in rows, the worst scaled first.
    decided : tuple of Diagnostic
        Thresholds that never switch and branches that are never used.
    merged : mapping of name to name
        Generated Booleans that ``share=True`` would replace, and by which.
    redundant : tuple of RemovedRow
        Rows that ``compact=True`` would leave out.
    programs : int
        Linear programs behind the constants.
    """

    name: str
    source: str
    rows: tuple[AuditRow, ...]
    scalings: tuple[Scaling, ...]
    decided: tuple[Diagnostic, ...]
    merged: Mapping[str, str]
    redundant: tuple[RemovedRow, ...]
    programs: int

    @property
    def tighter(self) -> int:
        """Number of constants that linear programs make smaller."""
        return sum(row.lp < row.interval for row in self.rows)

    @property
    def summary(self) -> str:
        """The audit in one sentence."""
        largest = max((row.lp for row in self.rows), default=0.0)
        return (
            f"{len(self.rows)} big-M constants, {self.tighter} of them smaller by linear programs than by intervals; "
            f"the largest is {largest:.6g}; {len(self.merged)} generated Booleans could be shared, "
            f"{len(self.redundant)} rows left out"
        )


def audit_dha(dha: Dha, diagnostics: Iterable[Diagnostic] = ()) -> Audit:
    """Audit a Dha that can be lowered without an error.

    Parameters
    ----------
    diagnostics : iterable of Diagnostic
        What the lowering has found; thresholds and branches that never change are taken from it.
    """
    ranges = Ranges(dha, Sink())
    tight = tighten(dha, ranges, Sink())
    mld = assemble(dha, tight, Sink())
    rows = _audit_rows(dha, mld, ranges, tight)
    return Audit(
        dha.name,
        dha.source,
        tuple(sorted(rows, key=lambda row: (-row.looseness, -row.lp, row.index))),
        tuple(sorted(_scalings(mld), key=lambda s: (-s.largest / s.smallest, s.variable.name))),
        tuple(dict.fromkeys(found for found in diagnostics if found.code in _DECIDED)),
        share(dha).merged,
        remove_redundant_rows(mld).removed,
        tight.programs,
    )


def _audit_rows(dha: Dha, mld: Mld, ranges: Rule, tight: Rule) -> Iterator[AuditRow]:
    origins = _Origins(dha, mld)
    coefficients = _coefficients(mld)
    for index, origin in enumerate(mld.rows):
        item = dha.definitions.get(origin.defines)
        if not isinstance(item, Event | Switch):
            continue
        sizes = np.abs(coefficients[index])
        yield AuditRow(
            index,
            origin,
            _allowances(item, ranges)[origin.subindex - 1],
            _allowances(item, tight)[origin.subindex - 1],
            float(sizes.max(initial=0.0)),
            float(sizes.min(initial=np.inf)) if sizes.size else 0.0,
            item.epsilon if isinstance(item, Event) else None,
            origins.of(_form(item)),
        )


def _allowances(item: Event | Switch, rule: Rule) -> tuple[float, ...]:
    """What each row of an item allows when it is switched off."""
    if isinstance(item, Event):
        constants = rule.event(item)
        return item.epsilon - constants.low, constants.high
    return rule.switch(item).bounds


def _form(item: Event | Switch) -> Affine:
    """The form whose range the constants bound."""
    return item.form if isinstance(item, Event) else item.then - item.otherwise


class _Origins:
    """Which declared ranges a form owes its own range to."""

    def __init__(self, dha: Dha, mld: Mld) -> None:
        self._dha = dha
        self._variables = {v.name: v for v in (*mld.x, *mld.u, *mld.d, *mld.z)}
        self._undeclared = {v.name for v in (*dha.x, *dha.z) if not math.isfinite(v.high - v.low)}

    def of(self, form: Affine) -> tuple[Contribution, ...]:
        """Contributions of the variables of a form, the greatest first."""
        found = [Contribution(self._variables[n], self._width(n, c), self._declared(n)) for n, c in form.terms if c]
        return tuple(sorted(found, key=lambda source: (-source.size, source.variable.name)))

    def _width(self, name: str, coefficient: float) -> float:
        return abs(coefficient) * (self._variables[name].high - self._variables[name].low)

    def _declared(self, name: str) -> Variable:
        """Follow the widest term of each definition until a range is declared."""
        seen = {name}
        while name in self._undeclared:
            terms = [(n, c) for form in self._forms(name) for n, c in form.terms if c and n not in seen]
            if not terms:
                break
            name = max(terms, key=lambda term: self._width(*term))[0]
            seen.add(name)
        return self._variables[name]

    def _forms(self, name: str) -> tuple[Affine, ...]:
        match self._dha.definitions.get(name):
            case Switch(then=then, otherwise=otherwise):
                return then, otherwise
            case AffineEquation(value=value):
                return (value,)
            case _:
                return ()


def _coefficients(mld: Mld) -> list[np.ndarray[tuple[int], np.dtype[np.float64]]]:
    """Nonzero coefficients of each row."""
    from scipy.sparse import hstack

    matrix = hstack([mld.E2, mld.E3, mld.E1, mld.E4], format="csr")
    matrix.eliminate_zeros()
    return [matrix.data[a:b] for a, b in pairwise(matrix.indptr)]


def _scalings(mld: Mld) -> Iterator[Scaling]:
    from scipy.sparse import csc_array, hstack

    matrix = csc_array(hstack([mld.E2, mld.E3, mld.E1, mld.E4]))
    matrix.eliminate_zeros()
    columns = (matrix.data[a:b] for a, b in pairwise(matrix.indptr))
    for variable, column in zip((*mld.d, *mld.z, *mld.u, *mld.x), columns, strict=True):
        if column.size:
            sizes = np.abs(column)
            yield Scaling(variable, float(sizes.max()), float(sizes.min()))
