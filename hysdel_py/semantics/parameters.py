"""Values of the parameters of a model: from the file, and from the caller, who wins."""

from __future__ import annotations

import math
from collections.abc import Mapping
from graphlib import CycleError, TopologicalSorter

from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.semantics.arithmetic import evaluate
from hysdel_py.semantics.expressions import leaves
from hysdel_py.semantics.symbols import BIG_M_BOUND, EPSILON, Symbol
from hysdel_py.semantics.typed_model import Threshold, TypedModel

__all__ = ["bind_parameters", "missing_parameters"]


def bind_parameters(model: TypedModel, given: Mapping[str, object], sink: Sink) -> dict[str, float]:
    """Values of all parameters that have one.

    Parameters
    ----------
    given : mapping of name to number (or bool, for a BOOL parameter)
        Overrides what the file says.
    sink : Sink
        Receives errors for unknown names, wrong values and parameters that are defined in a circle.
    """
    parameters = {symbol.name: symbol for symbol in model.parameters}
    values = _given_values(parameters, given, sink)
    for name in _evaluation_order(parameters, sink):
        symbol = parameters[name]
        if name not in values and symbol.value is not None and _known(symbol, values):
            values[name] = evaluate(symbol.value, values)
            _warn_of_nan(symbol, values[name], sink)
    for symbol in parameters.values():
        _check_bounds(symbol, values, sink)
    _check_epsilon(parameters, values, sink)
    _check_big_m_bound(parameters, values, sink)
    return values


def missing_parameters(model: TypedModel, values: Mapping[str, float]) -> tuple[Symbol, ...]:
    """Parameters without a value that something in the model needs, in the order of declaration."""
    needed = {symbol.name for item in model.items for expression in item.expressions() for symbol in leaves(expression)}
    if any(isinstance(item.body, Threshold) and item.target is not None for item in model.items):
        needed.add(EPSILON)
    needed.add(BIG_M_BOUND)  # whether a range needs it is not known before the rows are made
    for symbol in model.symbols:
        bounds = () if symbol.is_parameter else symbol.bounds or ()
        for expression in (*bounds, *((symbol.value,) if symbol.value else ())):
            needed |= {leaf.name for leaf in leaves(expression)}
    return tuple(s for s in model.parameters if s.name in needed and s.name not in values and s.value is None)


def _given_values(parameters: Mapping[str, Symbol], given: Mapping[str, object], sink: Sink) -> dict[str, float]:
    values = {}
    for name, value in given.items():
        symbol = parameters.get(name)
        if symbol is None:
            known = ", ".join(n for n, s in parameters.items() if s.line) or "(none)"
            sink.error(
                Code.PARAMETER_UNKNOWN,
                f"there is no parameter {name}",
                help=f"the parameters of this model are {known}",
            )
        else:
            number = _as_number(symbol, value, sink)
            if number is not None:
                values[name] = number
    return values


def _as_number(symbol: Symbol, value: object, sink: Sink) -> float | None:
    expected = "a number" if symbol.is_real else "True or False"
    try:
        number = math.nan if isinstance(value, str) else float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if math.isnan(number) or (not symbol.is_real and number not in (0.0, 1.0)):
        sink.error(
            Code.PARAMETER_VALUE,
            f"the parameter {symbol.name} was given {value!r}: {expected} was expected",
            symbol.span,
        )
        return None
    return number


def _evaluation_order(parameters: Mapping[str, Symbol], sink: Sink) -> tuple[str, ...]:
    graph = {
        name: {leaf.name for leaf in leaves(symbol.value)} if symbol.value is not None else set()
        for name, symbol in parameters.items()
    }
    try:
        return tuple(TopologicalSorter(graph).static_order())
    except CycleError as error:
        circle = list(reversed(error.args[1]))
        sink.error(
            Code.PARAMETER_CYCLE,
            f"parameters are defined in a circle: {' -> '.join(circle)}",
            parameters[circle[0]].span,
            help="give one of them a number",
        )
        return ()


def _known(symbol: Symbol, values: Mapping[str, float]) -> bool:
    return symbol.value is not None and all(leaf.name in values for leaf in leaves(symbol.value))


def _warn_of_nan(symbol: Symbol, value: float, sink: Sink) -> None:
    """What is not a number does no harm as long as nothing uses it; where something does, that is an error."""
    if math.isnan(value):
        sink.warning(Code.NOT_A_NUMBER, f"the value of the parameter {symbol.name} is not a number", symbol.span)


def _check_bounds(symbol: Symbol, values: Mapping[str, float], sink: Sink) -> None:
    """A value outside of the declared bounds is an error; nothing is said where one of them is not known yet."""
    if symbol.bounds is None or any(leaf.name not in values for bound in symbol.bounds for leaf in leaves(bound)):
        return
    low, high = (evaluate(bound, values) for bound in symbol.bounds)
    if math.isnan(low) or math.isnan(high):
        sink.error(Code.BAD_ARITHMETIC, f"a bound of the parameter {symbol.name} is not a number", symbol.span)
        return
    if low > high:
        sink.warning(
            Code.SWAPPED_BOUNDS,
            f"the lower bound {low:g} of {symbol.name} lies above its upper bound {high:g}: they are swapped",
            symbol.span,
        )
        low, high = high, low
    value = values.get(symbol.name, math.nan)
    if value < low or value > high:
        sink.error(
            Code.PARAMETER_VALUE,
            f"the parameter {symbol.name} is {value:.12g}, outside of its bounds [{low:.12g}, {high:.12g}]",
            symbol.span,
            help="give a value within the bounds, or declare wider ones",
        )


def _check_epsilon(parameters: Mapping[str, Symbol], values: Mapping[str, float], sink: Sink) -> None:
    symbol = parameters.get(EPSILON)
    if symbol is not None and EPSILON in values and not 0 < values[EPSILON] < math.inf:
        sink.error(
            Code.PARAMETER_VALUE, f"{EPSILON} is {values[EPSILON]:g}: a positive number was expected", symbol.span
        )


def _check_big_m_bound(parameters: Mapping[str, Symbol], values: Mapping[str, float], sink: Sink) -> None:
    symbol = parameters.get(BIG_M_BOUND)
    vector = next((s for name, s in parameters.items() if name.startswith(f"{BIG_M_BOUND}(")), None)
    if vector is not None:
        sink.error(Code.WRONG_TYPE, f"{BIG_M_BOUND} is a vector: it has to be one number", vector.span)
    if symbol is None:
        return
    if not symbol.is_real:
        sink.error(
            Code.WRONG_TYPE, f"{BIG_M_BOUND} is Boolean: it bounds real variables and has to be REAL", symbol.span
        )
    elif BIG_M_BOUND in values and not 0 < values[BIG_M_BOUND] < math.inf:
        sink.error(
            Code.PARAMETER_VALUE,
            f"{BIG_M_BOUND} is {values[BIG_M_BOUND]:g}: a positive finite number was expected, since variables without "
            f"a range are taken to lie between -{BIG_M_BOUND} and {BIG_M_BOUND}",
            symbol.span,
            help=f"write for example REAL {BIG_M_BOUND} = 1e4;",
        )
