"""Do inputs and outputs tell where a run started, and in which mode? Two runs that they do not tell, or a proof."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from numbers import Real

from hysdel_py.analysis.clock import Clock, Watch
from hysdel_py.analysis.counts import counted
from hysdel_py.analysis.encoding import ranges_by_definition
from hysdel_py.analysis.hybrid_set import Span
from hysdel_py.analysis.safety import Found, Question, Searcher, Verdict
from hysdel_py.analysis.twins import COPIES, differ, equal, of_copy, twins
from hysdel_py.errors import ArgumentError
from hysdel_py.model import Model
from hysdel_py.reports.observability_answer import Observability, ObservabilityVerdict
from hysdel_py.reports.safety import check_model
from hysdel_py.systems.dha import AffineEquation, Dha
from hysdel_py.systems.signals import Variable
from hysdel_py.systems.trajectory import Trajectory

__all__ = ["observability"]

Share = float | Mapping[str, float]


def observability(
    model: Model,
    steps: int,
    *,
    of: str | Sequence[str] = "states",
    apart: Share = 0.05,
    resolution: Share = 1e-3,
    x0: Mapping[str, Span] | None = None,
    inputs: Mapping[str, Span] | None = None,
    seconds: float = 300.0,
    progress: Watch | None = None,
) -> Observability:
    """Do the outputs of some steps tell the first state, or the mode of the first step, whatever the inputs are?

    Parameters
    ----------
    model : Model
    steps : int
        How many outputs are seen, at the times 0 to ``steps - 1``.
    of : {"states", "modes"} or sequence of str
        All states; the mode of the first step, that is all its Boolean auxiliaries; or some states or Boolean
        auxiliaries by name, of which one at least has to differ.
    apart : float or mapping of name to float
        By how much two real states differ that should be told apart: a share of each range, or distances by name.
        Boolean ones differ or do not.
    resolution : float or mapping of name to float
        Real outputs that differ by no more are the same: a share of each range, or distances by name.
    x0 : mapping of name to value or (low, high), optional
        First states of both runs; those that are not named may have any value of their range.
    inputs : mapping of name to value or (low, high), optional
        Inputs that are not named may have any value of their range, another one at each step.
    seconds : float
        Time limit.
    progress : callable, optional
        Told the number of searches begun; a true answer ends the work as if its time were over.

    Returns
    -------
    Observability
        ``observable``, proven to the tolerance of the solver; ``indistinguishable`` with two runs under the same
        inputs; ``no run``, or ``not settled``. ``print`` shows it.

    Raises
    ------
    ArgumentError
        Wrong arguments, a model without outputs, or a range that is missing.

    Notes
    -----
    Two copies of the model under the same inputs are searched for a pair of runs (A. Bemporad, G. Ferrari-Trecate and
    M. Morari, "Observability and controllability of piecewise affine and hybrid systems", IEEE Trans. Automatic Control
    45, 2000). Observability so holds for every input; that some inputs tell states apart is another question.

    Examples
    --------
    >>> from hysdel_py import load
    >>> text = ("SYSTEM cart { INTERFACE { STATE { REAL p [-9, 9]; REAL v [-1, 1]; } OUTPUT { REAL y; } }"
    ...         " IMPLEMENTATION { CONTINUOUS { p = p + v; v = v; } OUTPUT { y = p; } } }")
    >>> observability(load(text), 2).verdict
    'observable'
    >>> observability(load(text), 1, of=["v"]).verdict
    'indistinguishable'
    """
    check_model(model, seconds)
    dha, count = model.dha, counted(steps, 1, "steps")
    if not dha.y:
        raise ArgumentError(f"{model.name} has no outputs: nothing is seen of its states")
    vector, variables = _asked(of, dha)
    distances = _distances(apart, [v for v in variables if not v.is_bool], dha, "apart")
    finest = _distances(resolution, [v for v in dha.y if not v.is_bool], dha, "resolution")
    pair = twins(dha)
    question = Question(
        pair, _doubled(x0 or {}), differ(variables, vector, distances), inputs or {}, equal(dha.y, "y", finest), count,
        model.sample_time,
    )  # fmt: skip
    searcher = Searcher(question, Clock(seconds, progress))
    found = searcher.run(count, range(count), meets=True)
    outcome = _outcome(found, searcher)
    first, second = (None, None) if found.run is None else _runs(model, found.run)
    names = tuple(v.name for v in variables)
    return Observability(
        model.name, names, outcome, count, distances, finest, first, second, found.borderline, found.message,
        searcher.calls, searcher.clock.elapsed,
    )  # fmt: skip


def _asked(of: str | Sequence[str], dha: Dha) -> tuple[str, tuple[Variable, ...]]:
    """The letter of a vector and the variables of it that have to be told."""
    if isinstance(of, str) and of in ("states", "modes"):
        vector, found = ("x", dha.x) if of == "states" else ("d", dha.d)
        if not found:
            raise ArgumentError(f"{dha.name} has no {'states' if of == 'states' else 'Boolean auxiliaries'}")
        return vector, found
    names = (of,) if isinstance(of, str) else tuple(of) if isinstance(of, Sequence) else ()
    for vector, variables in (("x", dha.x), ("d", dha.d)):
        known = {v.name: v for v in variables}
        if names and all(name in known for name in names):
            return vector, tuple(known[name] for name in names)
    raise ArgumentError(
        f"of is {of!r}: 'states', 'modes', names of states ({', '.join(v.name for v in dha.x)}) or names of Boolean "
        f"auxiliaries ({', '.join(v.name for v in dha.d if not v.generated) or 'there are none'}) were expected"
    )


def _distances(given: Share, variables: Sequence[Variable], dha: Dha, what: str) -> dict[str, float]:
    """A distance for each real variable."""
    if isinstance(given, Mapping):
        unknown = [name for name in given if name not in {v.name for v in variables}]
        missing = [v.name for v in variables if v.name not in given]
        if unknown or missing:
            raise ArgumentError(f"{what}: a distance for each of {', '.join(v.name for v in variables)} was expected")
        found = {name: _number(value, what) for name, value in given.items()}
    else:
        found = {v.name: _number(given, what) * _width(v, dha, what) for v in variables}
    wrong = [f"{name} has {value:g}" for name, value in found.items() if not 0 < value < float("inf")]
    if wrong:
        raise ArgumentError(f"{what}: a positive distance was expected, {wrong[0]}")
    return found


def _number(value: object, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise ArgumentError(f"{what}: a number was expected, found {value!r}")
    return float(value)


def _width(variable: Variable, dha: Dha, what: str) -> float:
    """Width of the range of a state or output; that of a constant is 1."""
    low, high = variable.low, variable.high
    definition = dha.definitions.get(variable.name)
    if variable in dha.y and isinstance(definition, AffineEquation):
        ranges = ranges_by_definition(dha)
        low, high = definition.value.range(ranges.__getitem__)
    if high - low == float("inf"):
        raise ArgumentError(f"{what}: {variable.name} has no finite range, so give distances by name")
    return high - low or 1.0


def _doubled(x0: Mapping[str, Span]) -> dict[str, Span]:
    if not isinstance(x0, Mapping):
        raise ArgumentError(f"x0: expected names with values or (low, high), found {type(x0).__name__}")
    return {of_copy(copy, name): ends for copy in COPIES for name, ends in x0.items()}


def _outcome(found: Found, searcher: Searcher) -> ObservabilityVerdict:
    """What no pair of runs shows is worth something only if there are runs."""
    if found.verdict is Verdict.RUN:
        return ObservabilityVerdict.INDISTINGUISHABLE
    if found.verdict is Verdict.NOT_SETTLED:
        return ObservabilityVerdict.NOT_SETTLED
    anything = Searcher(replace(searcher.question, start=None), searcher.clock)
    some = anything.run(searcher.question.steps, (), meets=True)
    return ObservabilityVerdict.NO_RUN if some.verdict is Verdict.NONE else ObservabilityVerdict.OBSERVABLE


def _runs(model: Model, pair: Trajectory) -> tuple[Trajectory, Trajectory]:
    """Both runs, simulated by the model itself; the ranges were checked as a pair."""
    starts = ([float(pair[f"x.{of_copy(copy, v.name)}"][0]) for v in model.dha.x] for copy in COPIES)
    inputs = pair.u if model.dha.u else pair.steps
    first, second = (model.simulate(start, inputs, check=False) for start in starts)
    return first, second
