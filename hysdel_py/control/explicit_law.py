"""An explicit control law: affine pieces over polyhedra in the parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import ArgumentError
from hysdel_py.geometry.polyhedron import Polyhedron

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hysdel_py.control.explicit_certificate import LawCertificate
    from hysdel_py.control.explicit_tree import LawTree
    from hysdel_py.control.law_signals import LawSignals
    from hysdel_py.control.move import Move
    from hysdel_py.export.law_c import LawCode
    from hysdel_py.optimize.mpqp import ParametricSolution
    from hysdel_py.optimize.parametric.objective import ParametricObjective
    from hysdel_py.optimize.parametric.problem import MpQp

__all__ = ["ExplicitLaw"]

Vector = NDArray[np.float64]
Array = NDArray[np.float64]
OUTSIDE = -1


@dataclass(frozen=True, eq=False, repr=False)
class ExplicitLaw:
    """``z = K_i zeta + k_i`` and value ``1/2 zeta'P_i zeta + q_i'zeta + r_i`` where ``A_i zeta <= b_i``.

    The rows of all regions are stacked; those of region i are ``starts[i]`` up to ``starts[i + 1]``. All arrays are
    read-only.

    Attributes
    ----------
    A : array of shape (r, p)
        Rows of length one, irredundant in their region.
    b : array of shape (r,)
    starts : int array of shape (count + 1,)
    K, k : arrays of shapes (count, n, p), (count, n)
    P, q, r : arrays of shapes (count, p, p), (count, p), (count,); of length 0 in a law without value function
    active : tuple of tuple of int
        Rows that hold with equality in each region.
    domain : Polyhedron
        Parameters that were asked for.
    moves : int
        The first so many entries of z are the move.
    names : tuple of str
        Of the parameters.
    complete : bool
        Whether the regions are known to be all there are.
    tolerance : float
        Distance up to which a point on the boundary belongs to a region.
    signals : LawSignals, optional
        What the parameters and the moves stand for, in the law of a controller.
    objective : ParametricObjective, optional
        What the law minimises. Where it is known, values are computed from it and z: the coefficients P, q, r of a very
        thin region are so large that their sum loses digits.
    """

    A: Array
    b: Vector
    starts: NDArray[np.int64]
    K: Array
    k: Array
    P: Array
    q: Array
    r: Vector
    active: tuple[tuple[int, ...], ...]
    domain: Polyhedron
    moves: int
    names: tuple[str, ...]
    complete: bool
    tolerance: float = 1e-8
    signals: LawSignals | None = None
    objective: ParametricObjective | None = None

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if isinstance(value, np.ndarray):
                value.setflags(write=False)
        if not 1 <= self.moves <= self.K.shape[1]:
            raise ArgumentError(f"moves is {self.moves}: a number from 1 to {self.K.shape[1]} was expected")
        if len(self.names) != self.p:
            raise ArgumentError(f"{len(self.names)} names were given for {self.p} parameters")

    def __repr__(self) -> str:
        state = "complete" if self.complete else "incomplete"
        return f"<ExplicitLaw of {', '.join(self.names)}: {self.count} regions, {self.moves} moves, {state}>"

    def _repr_html_(self) -> str:
        from hysdel_py.markup.cards import law_card

        return law_card(self)

    @classmethod
    def of(
        cls, solution: ParametricSolution, moves: int | None = None, names: tuple[str, ...] | None = None
    ) -> ExplicitLaw:
        """The law of a solved multi-parametric program.

        Parameters
        ----------
        solution : ParametricSolution
        moves : int, optional
            The first so many variables are the move; all of them by default.
        names : tuple of str, optional
            Of the parameters; ``p0, p1, ...`` by default.
        """
        problem, regions = solution.problem, solution.regions
        n, p = problem.n, problem.p
        return cls(
            A=np.vstack([np.zeros((0, p)), *(region.A for region in regions)]),
            b=np.concatenate([np.zeros(0), *(region.b for region in regions)]),
            starts=np.cumsum([0, *(len(region.b) for region in regions)]),
            K=np.array([region.K for region in regions]).reshape(-1, n, p),
            k=np.array([region.k for region in regions]).reshape(-1, n),
            P=np.array([region.P for region in regions]).reshape(-1, p, p),
            q=np.array([region.q for region in regions]).reshape(-1, p),
            r=np.array([region.r for region in regions], dtype=float),
            active=tuple(region.active for region in regions),
            domain=problem.theta,
            moves=n if moves is None else moves,
            names=tuple(f"p{j}" for j in range(p)) if names is None else tuple(names),
            complete=solution.complete,
            objective=problem.objective,
        )

    @property
    def count(self) -> int:
        """Number of regions."""
        return len(self.K)

    @property
    def p(self) -> int:
        """Number of parameters."""
        return int(self.A.shape[1])

    @property
    def has_value(self) -> bool:
        """Whether the value function is known."""
        return len(self.r) == self.count

    def rows(self, region: int) -> tuple[Array, Vector]:
        """Rows of one region."""
        part = slice(int(self.starts[region]), int(self.starts[region + 1]))
        return self.A[part], self.b[part]

    def polyhedron(self, region: int) -> Polyhedron:
        """One region."""
        return Polyhedron(*self.rows(region))

    def excess(self, zeta: ArrayLike) -> Vector:
        """By how much each region's worst row is exceeded; not positive inside."""
        return np.asarray(np.maximum.reduceat(self.A @ self._point(zeta) - self.b, self.starts[:-1]))

    def locate(self, zeta: ArrayLike, last: int | None = None, *, tree: bool = False) -> int:
        """Number of the region that holds a point, or -1.

        Parameters
        ----------
        zeta : array_like of shape (p,)
        last : int, optional
            Region of the step before: it is kept while it holds the point up to the tolerance, so that a state on a
            boundary does not switch to and fro.
        tree : bool
            Whether to walk the search tree, which is built at the first call, before the regions are tried in turn.
        """
        if not self.count:
            return OUTSIDE
        point = self._point(zeta)
        if last is not None and 0 <= last < self.count and self._holds(last, point):
            return last
        if tree:
            region = self.tree.locate(point)
            if region != OUTSIDE and self._holds(region, point):
                return region
        excess = self.excess(point)
        region = int(np.argmin(excess))
        return region if excess[region] <= self.tolerance else OUTSIDE

    def __call__(self, zeta: ArrayLike, last: int | None = None, *, tree: bool = False) -> Vector | None:
        """The move at a point, or None where no region holds it; arguments as for :meth:`locate`."""
        z = self.solution(zeta, last, tree=tree)
        return None if z is None else z[: self.moves]

    def solution(self, zeta: ArrayLike, last: int | None = None, *, tree: bool = False) -> Vector | None:
        """All variables at a point, or None."""
        region = self.locate(zeta, last, tree=tree)
        return None if region == OUTSIDE else np.asarray(self.K[region] @ self._point(zeta) + self.k[region])

    def value(self, zeta: ArrayLike) -> float:
        """Optimal value at a point; infinite where no region holds it.

        Raises
        ------
        ArgumentError
            The law has no value function, as after merging.
        """
        if not self.has_value:
            raise ArgumentError("this law has no value function: ask the law from before it was merged")
        region = self.locate(zeta)
        if region == OUTSIDE:
            return float("inf")
        point = self._point(zeta)
        if self.objective is not None:
            return self.objective.value(self.K[region] @ point + self.k[region], point)
        return float(0.5 * point @ self.P[region] @ point + self.q[region] @ point + self.r[region])

    @property
    def uses_last_input(self) -> bool:
        """Whether the input applied last is a parameter."""
        return self.signals is not None and self.signals.previous

    @property
    def sample_time(self) -> float:
        """Sample time of the controller, 1 where there is none."""
        return 1.0 if self.signals is None else self.signals.sample_time

    def solve(
        self,
        x: ArrayLike | Mapping[str, float],
        ref: ArrayLike | Mapping[str, float] | None = None,
        last_input: ArrayLike | Mapping[str, float] | None = None,
    ) -> Move:
        """The first input, in the place of the controller that the law comes from (:func:`law_controller.answer`)."""
        from hysdel_py.control.law_controller import answer

        return answer(self, x, ref, last_input)

    @cached_property
    def tree(self) -> LawTree:
        """Search tree over the regions."""
        from hysdel_py.control.explicit_tree import build_tree

        return build_tree(self)

    def merged(self) -> ExplicitLaw:
        """A law with the same moves over fewer regions, without value function."""
        from hysdel_py.control.explicit_merge import merge

        return merge(self)

    def fixed(self, values: Mapping[str | int, float]) -> ExplicitLaw:
        """The law over the other parameters, with some of them set to numbers (a slice)."""
        from hysdel_py.control.explicit_slice import fix

        return fix(self, values)

    def section(self, values: Mapping[str | int, float], window: Polyhedron) -> ExplicitLaw:
        """The law in a window of the other parameters, its regions continued (:mod:`explicit_slice`)."""
        from hysdel_py.control.explicit_slice import section

        return section(self, values, window)

    def certificate(self, problem: MpQp, samples: int = 200, seed: int = 0) -> LawCertificate:
        """Comparison with the problem solved online, and continuity; see :func:`certify`."""
        from hysdel_py.control.explicit_certificate import certify

        return certify(self, problem, samples, seed)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the law as an .npz file."""
        from hysdel_py.control.explicit_file import save_law

        save_law(self, path)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> ExplicitLaw:
        """Read a law from an .npz file."""
        from hysdel_py.control.explicit_file import load_law

        return load_law(path)

    def to_json(self, path: str | PathLike[str]) -> None:
        """Write the law as JSON."""
        from hysdel_py.export.law_json import write_law_json

        write_law_json(self, path)

    @classmethod
    def from_json(cls, path: str | PathLike[str]) -> ExplicitLaw:
        """Read a law from a JSON file; it equals the one that was written."""
        from hysdel_py.export.law_json import read_law_json

        return read_law_json(path)

    def to_c(self, path: str | PathLike[str], **options: Any) -> LawCode:
        """Write the law as C99, a source and a header beside it; options as for :func:`law_to_c`."""
        from hysdel_py.export.law_c import law_to_c

        return law_to_c(self, path, **options)

    def to_python(self, path: str | PathLike[str], *, method: str = "auto") -> Path:
        """Write the law as a Python module with ``law(zeta)`` that needs nothing but Python."""
        from hysdel_py.export.law_python import law_to_python

        return law_to_python(self, path, method=method)

    def to_latex(self, path: str | PathLike[str] | None = None, **options: Any) -> str:
        """The law as a LaTeX table; options as for :func:`law_to_latex`."""
        from hysdel_py.export.law_latex import law_to_latex

        return law_to_latex(self, path, **options)

    def plot(self, what: str = "partition", **options: Any) -> Figure:
        """Draw the law over one or two parameters; options as for :func:`plot_law`."""
        from hysdel_py.plotting.law import plot_law

        return plot_law(self, what, **options)

    def describe(self) -> str:
        """The law as text: sizes, then rows and moves of each region."""
        from hysdel_py.control.explicit_text import describe_law

        return describe_law(self)

    def without_value(self) -> ExplicitLaw:
        """The same law with its moves only."""
        p, K, k = self.p, self.K[:, : self.moves].copy(), self.k[:, : self.moves].copy()
        return replace(self, K=K, k=k, P=np.zeros((0, p, p)), q=np.zeros((0, p)), r=np.zeros(0), objective=None)

    def _holds(self, region: int, point: Vector) -> bool:
        A, b = self.rows(region)
        return bool(np.all(A @ point <= b + self.tolerance))

    def _point(self, zeta: ArrayLike) -> Vector:
        try:
            point = np.asarray(zeta, dtype=float)
        except (TypeError, ValueError):
            raise ArgumentError(f"zeta is {zeta!r}: {self.p} numbers were expected, {', '.join(self.names)}") from None
        if point.shape != (self.p,):
            raise ArgumentError(f"zeta has shape {point.shape}: {(self.p,)} was expected, {', '.join(self.names)}")
        if not np.isfinite(point).all():
            raise ArgumentError(f"{self.names[int(np.argmin(np.isfinite(point)))]} is not a finite number")
        return point
