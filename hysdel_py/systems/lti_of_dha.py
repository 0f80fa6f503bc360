"""From a discrete hybrid automaton without logic to a linear system: auxiliaries are put in where they are used."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, Dha
from hysdel_py.systems.lti import Lti
from hysdel_py.systems.signals import Variable

__all__ = ["lti_of_dha"]

Matrix = NDArray[np.float64]


def lti_of_dha(dha: Dha, ts: float) -> Lti:
    """The linear system that a model without logic describes.

    Names, units and ranges stay. Ranges of auxiliaries are promises for big-M constants, which are not needed here.

    Parameters
    ----------
    dha : Dha
    ts : float

    Raises
    ------
    ArgumentError
        The model has Booleans, switches, events or requirements; each is named with its line.
    """
    obstacles = _obstacles(dha)
    if obstacles:
        raise ArgumentError(
            f"{dha.name} is no linear system: {'; '.join(obstacles)}; HybridMpc takes such models, or leave these out"
        )
    forms = _auxiliary_forms(dha)
    A, B, f = _matrices([_right_side(dha, v.name, forms) for v in dha.x], dha)
    C, D, g = _matrices([_right_side(dha, v.name, forms) for v in dha.y], dha)
    return Lti(A, B, C, D, ts=ts, x=dha.x, u=dha.u, y=dha.y, f=f, g=g, name=dha.name, tolerances=dha.tolerances)


def _obstacles(dha: Dha) -> list[str]:
    """What a linear system cannot hold, in the words of the source."""
    booleans = [f"{v.name} is Boolean" for v in (*dha.x, *dha.u, *dha.y, *dha.d) if v.is_bool and not v.generated]
    items = dict.fromkeys(str(item.origin) for item in dha.items if not isinstance(item, AffineEquation))
    loop = [f"{' -> '.join(dha.algebraic_loop)} is an algebraic loop"] if dha.algebraic_loop else []
    undefined = [f"{name} is never defined" for name in dha.undefined_but_used]
    return [*booleans, *items, *loop, *undefined]


def _auxiliary_forms(dha: Dha) -> dict[str, Affine]:
    """Each auxiliary as an affine form of states and inputs."""
    forms: dict[str, Affine] = {}
    for name in dha.evaluation_order:
        forms[name] = _right_side(dha, name, forms)
    return forms


def _right_side(dha: Dha, name: str, forms: dict[str, Affine]) -> Affine:
    """What defines a variable, with auxiliaries put in; zero where nothing does, as in the MLD form."""
    definition = dha.definitions.get(name)
    if not isinstance(definition, AffineEquation):
        return Affine()
    parts = [forms.get(other, Affine(0.0, ((other, 1.0),))) * factor for other, factor in definition.value.terms]
    return sum(parts, Affine(definition.value.constant))


def _matrices(forms: list[Affine], dha: Dha) -> tuple[Matrix, Matrix, Matrix]:
    """Coefficients of the states, of the inputs, and constants."""
    rows = [dict(form.terms) for form in forms]
    return _coefficients(rows, dha.x), _coefficients(rows, dha.u), np.array([form.constant for form in forms])


def _coefficients(rows: list[dict[str, float]], variables: tuple[Variable, ...]) -> Matrix:
    entries = [[row.get(v.name, 0.0) for v in variables] for row in rows]
    return np.array(entries, dtype=float).reshape(len(rows), len(variables))
