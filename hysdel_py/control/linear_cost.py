"""What a linear controller minimises: weights, the cost of the last state, and the gain after the last free input."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.control.lqr import closed_loop_cost, lqr
from hysdel_py.control.settings import DEFAULT_CONTROL_TOLERANCES, ControlTolerances
from hysdel_py.control.weights import Norm, group_weight
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.lti import Lti
from hysdel_py.systems.signals import Variable

__all__ = ["LinearCost", "LinearWeights"]

Matrix = NDArray[np.float64]
StageWeight: TypeAlias = Mapping[str, float] | ArrayLike

DEFAULT_INPUT_WEIGHT = 0.1
"""Weight of inputs and of their increments where none is given; outputs and states have 1."""
WORDS = ("lqr", "lyap")


@dataclass(frozen=True, slots=True)
class LinearCost:
    """Cost of a plan of :class:`LinearMpc`.

    ::

        regulator: x_N' P x_N + sum_{k=0}^{N-1} x_k' Q x_k + u_k' R u_k,   u_k = K x_k for k >= Nu
        track:     sum_{k=0}^{N-1} (y_k - r_k)' S (y_k - r_k) + du_k' T du_k,   du_k = 0 for k >= Nu

    Attributes
    ----------
    x, u : number, mapping of name to number, vector, matrix or stack of matrices, optional
        Q and R of a regulator: the identity and a tenth of it where they are left out. A stack of shape (N, n, n) has
        one matrix per stage.
    y, du : the same, optional
        S and T of a tracking controller: the identity and a tenth of it where they are left out.
    terminal : "lqr", "lyap" or matrix
        P: the cost of the optimal gain for the rest of time; that of the gain K (zero unless one is given); or a
        weight.
    gain : "lqr", "lyap" or matrix of shape (nu, nx), optional
        K, with u = K x: the optimal gain; zero; or a matrix. By default ``"lyap"`` if `terminal` is, else ``"lqr"``.
        It is worked out only where the plan uses it.

    Raises
    ------
    ArgumentError
        When a controller is built: wrong shapes or names, a weight that is not positive semidefinite, ``"lqr"`` for a
        system that no gain stabilises, ``"lyap"`` for one that is not stable.
    """

    x: StageWeight | None = None
    u: StageWeight | None = None
    y: StageWeight | None = None
    du: StageWeight | None = None
    terminal: str | StageWeight = "lqr"
    gain: str | ArrayLike | None = None

    def resolve(
        self, models: Sequence[Lti], tracks: bool, tolerances: ControlTolerances = DEFAULT_CONTROL_TOLERANCES
    ) -> LinearWeights:
        """Check the cost against a model and return it as matrices.

        Parameters
        ----------
        models : sequence of Lti
            One per stage.
        tracks : bool
            Whether it is the cost of a tracking controller.
        tolerances : ControlTolerances
        """
        self._check_kind(tracks)
        lti, stages = models[0], len(models)

        def group(value: StageWeight | None, variables: tuple[Variable, ...], what: str, default: float) -> Matrix:
            return _stack(default if value is None else value, variables, what, stages, tolerances.definite)

        if tracks:
            return LinearWeights.tracking(
                group(self.y, lti.y, "y", 1.0), group(self.du, lti.u, "du", DEFAULT_INPUT_WEIGHT)
            )
        if not (self.gain is None or isinstance(self.gain, str)):
            _gain_matrix(self.gain, lti)  # a wrong one is an error also where no plan uses it
        Q, R = group(self.x, lti.x, "x", 1.0), group(self.u, lti.u, "u", DEFAULT_INPUT_WEIGHT)
        P = self._terminal(models[-1], Q[-1], R[-1], tolerances)
        return LinearWeights(
            Q, R, P, np.zeros((0, 0, 0)), np.zeros((0, 0, 0)), lambda: self._gain(models[-1], Q[-1], R[-1])
        )

    def _check_kind(self, tracks: bool) -> None:
        wrong = ("x", "u") if tracks else ("y", "du")
        given = [name for name in wrong if getattr(self, name) is not None]
        given += ["gain"] if tracks and self.gain is not None else []
        given += ["terminal"] if tracks and not (isinstance(self.terminal, str) and self.terminal == "lqr") else []
        if given:
            kind, weighs = ("track", "y and du") if tracks else ("regulator", "x, u and terminal")
            raise ArgumentError(
                f"the cost gives {', '.join(given)}, which a controller of the kind {kind!r} does not use: it weighs "
                f"{weighs}"
            )

    def _terminal(self, lti: Lti, Q: Matrix, R: Matrix, tolerances: ControlTolerances) -> Matrix:
        if not isinstance(self.terminal, str):
            given: Matrix = _stack(self.terminal, lti.x, "terminal", 1, tolerances.definite)[0]
            return given
        _check_word(self.terminal, "terminal")
        _check_rest_point(lti, f"terminal is {self.terminal!r}", "terminal")
        if self.terminal == "lqr":
            return lqr(lti.A, lti.B, Q, R)[1]
        return closed_loop_cost(lti.A, lti.B, self._gain(lti, Q, R), Q, R)

    def _gain(self, lti: Lti, Q: Matrix, R: Matrix) -> Matrix:
        word = self.gain
        if word is None:
            word = "lyap" if isinstance(self.terminal, str) and self.terminal == "lyap" else "lqr"
        if not isinstance(word, str):
            return _gain_matrix(word, lti)
        _check_word(word, "gain")
        _check_rest_point(lti, f"the gain is {word!r}", "gain")
        return np.zeros((lti.nu, lti.nx)) if word == "lyap" else lqr(lti.A, lti.B, Q, R)[0]


@dataclass(frozen=True, slots=True, eq=False)
class LinearWeights:
    """Matrices of a cost, one per stage.

    Attributes
    ----------
    Q, R, P
        Of a regulator: stacks of shapes (N, nx, nx), (N, nu, nu) and an array of shape (nx, nx).
    S, T
        Of a tracking controller: stacks of shapes (N, ny, ny), (N, nu, nu).
    gain : callable
        The gain after the last free input, worked out when asked for.
    """

    Q: Matrix
    R: Matrix
    P: Matrix
    S: Matrix
    T: Matrix
    gain: Callable[[], Matrix]

    @classmethod
    def tracking(cls, S: Matrix, T: Matrix) -> LinearWeights:
        """The weights of a tracking controller, which needs no gain."""
        none, gainless = np.zeros((0, 0, 0)), np.zeros((0, 0))
        return cls(none, none, gainless, S, T, lambda: gainless)

    @property
    def tracked(self) -> tuple[int, ...]:
        """Outputs with a weight at some stage, which are those that have a reference."""
        return tuple(np.flatnonzero(self.S.any(axis=(0, 1))).tolist())


def _stack(value: Any, variables: tuple[Variable, ...], what: str, stages: int, tolerance: float) -> Matrix:
    """One matrix per stage from whatever form a weight has."""
    n = len(variables)
    array = None if isinstance(value, Mapping) else _array(value, what)
    if array is not None and array.ndim == 3:
        if len(array) != stages:
            raise ArgumentError(f"weight {what} has {len(array)} matrices: {stages} were expected, one per stage")
        return np.array([_one(entry, variables, f"{what} at stage {k}", tolerance) for k, entry in enumerate(array)])
    if array is not None and array.ndim == 0:
        value = np.full(n, float(array))
    return np.repeat(_one(value, variables, what, tolerance)[None], stages, axis=0)


def _one(value: Any, variables: tuple[Variable, ...], what: str, tolerance: float) -> Matrix:
    return group_weight(value, variables, what, Norm.SQUARES, tolerance).matrix


def _array(value: Any, what: str) -> Matrix:
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise ArgumentError(f"weight {what} is {value!r}: numbers were expected") from None


def _gain_matrix(value: Any, lti: Lti) -> Matrix:
    gain = _array(value, "gain")
    if gain.shape == (lti.nx,) and lti.nu == 1:
        gain = gain.reshape(1, -1)
    if gain.shape != (lti.nu, lti.nx) or not np.isfinite(gain).all():
        raise ArgumentError(
            f"gain has shape {gain.shape}: finite numbers of the shape {(lti.nu, lti.nx)} were expected, for u = K x"
        )
    return gain


def _check_word(word: str, what: str) -> None:
    if word not in WORDS:
        raise ArgumentError(f"{what} is {word!r}: 'lqr', 'lyap' or a matrix was expected")


def _check_rest_point(lti: Lti, what: str, name: str) -> None:
    if lti.f.any():
        raise ArgumentError(
            f"{what}, but the model has constant terms in its update, so that it does not rest at the origin: give "
            f"{name} as a matrix, move the origin to a rest point, or track references"
        )
