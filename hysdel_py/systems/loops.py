"""Auxiliary variables that are defined in a circle: their values where exactly one choice fits.

A circle is legal in a model, and the MLD form has the same solutions. The definitions are grouped into the strongly
connected components of their dependencies and settled one component after the other: within one, every combination of
its Booleans leaves a linear system in its reals, and a combination counts if it then follows from itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import product

import numpy as np

from hysdel_py.errors import SimulationError
from hysdel_py.systems.affine import Affine

__all__ = ["MAX_LOOP_BOOLEANS", "settle_loops"]

MAX_LOOP_BOOLEANS = 12
"""A circle through more Booleans than this is not searched."""

Values = dict[str, float]


def settle_loops(
    dependencies: Mapping[str, tuple[str, ...]],
    is_boolean: Callable[[str], bool],
    evaluate: Callable[[str, Values], float],
    active_form: Callable[[str, Values], Affine],
    values: Values,
) -> Values:
    """Values of all auxiliaries.

    Parameters
    ----------
    dependencies : mapping
        For each auxiliary the auxiliaries on its right side.
    is_boolean : callable
    evaluate : callable
        Value of a definition when all that it reads is known.
    active_form : callable
        Affine form that defines a real auxiliary when all Booleans that it reads are known.
    values : dict
        States and inputs.

    Raises
    ------
    SimulationError
        A circle has no solution, or several.
    """
    import networkx as nx

    graph = nx.DiGraph()
    graph.add_nodes_from(dependencies)
    graph.add_edges_from((needed, name) for name, needs in dependencies.items() for needed in needs)
    components = nx.condensation(graph)
    settled = dict(values)
    for number in nx.lexicographical_topological_sort(components):
        members = sorted(components.nodes[number]["members"], key=list(dependencies).index)
        if len(members) == 1 and members[0] not in dependencies[members[0]]:
            settled[members[0]] = evaluate(members[0], settled)
        else:
            settled = _settle_circle(members, is_boolean, evaluate, active_form, settled)
    return settled


def _settle_circle(
    members: list[str],
    is_boolean: Callable[[str], bool],
    evaluate: Callable[[str, Values], float],
    active_form: Callable[[str, Values], Affine],
    values: Values,
) -> Values:
    booleans = [name for name in members if is_boolean(name)]
    reals = [name for name in members if not is_boolean(name)]
    if len(booleans) > MAX_LOOP_BOOLEANS:
        raise SimulationError((f"the algebraic loop through {_listed(members)} has too many Booleans to be settled",))
    found = []
    for word in product((0.0, 1.0), repeat=len(booleans)):
        trial = values | dict(zip(booleans, word, strict=True))
        solution = _solve_reals(reals, active_form, trial)
        if solution is not None and all(evaluate(name, solution) == solution[name] for name in booleans):
            found.append(solution)
    if len(found) != 1:
        count = "several solutions" if found else "no solution"
        raise SimulationError((f"the algebraic loop through {_listed(members)} has {count} at this state and input",))
    return found[0]


def _solve_reals(reals: list[str], active_form: Callable[[str, Values], Affine], values: Values) -> Values | None:
    """Solve the linear system that is left of the real auxiliaries; None if it is singular."""
    if not reals:
        return values
    forms = [active_form(name, values) for name in reals]
    column = {name: index for index, name in enumerate(reals)}
    matrix, right = np.eye(len(reals)), np.zeros(len(reals))
    for row, form in enumerate(forms):
        right[row] = form.constant
        for name, coefficient in form.terms:
            if name in column:
                matrix[row, column[name]] -= coefficient
            else:
                right[row] += coefficient * values[name]
    if np.linalg.cond(matrix) > 1.0 / np.finfo(float).eps:
        return None
    return values | dict(zip(reals, np.linalg.solve(matrix, right).tolist(), strict=True))


def _listed(names: list[str]) -> str:
    return ", ".join(names)
