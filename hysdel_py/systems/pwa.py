"""The piecewise affine form: one affine map for each mode, and a tree of tests that finds the mode of a point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hysdel_py.errors import SimulationError
from hysdel_py.geometry.search_tree import Place, SearchTree
from hysdel_py.systems.mode import Auxiliaries, Condition, Mode, RowKind
from hysdel_py.systems.signals import Variable, as_vector, range_violations
from hysdel_py.systems.summary import counted, one_line
from hysdel_py.tolerances import DEFAULT_TOLERANCES, Tolerances

if TYPE_CHECKING:
    import networkx as nx

    from hysdel_py.systems.trajectory import Trajectory

__all__ = ["Effort", "Pwa"]

Vector = NDArray[np.float64]
PwaStep = tuple[Vector, Vector, int]


@dataclass(frozen=True, slots=True)
class Effort:
    """What finding the modes cost.

    Attributes
    ----------
    programs : int
        Linear programs that were solved.
    cells : int
        Partial assignments of the Booleans that were looked at.
    """

    programs: int = 0
    cells: int = 0


@dataclass(frozen=True, eq=False, repr=False)
class Pwa:
    """A piecewise affine system ``x+ = A x + B u + f, y = C x + D u + g`` for (x, u) in the region of a mode.

    Attributes
    ----------
    name : str
    x, u, y, d, z : tuple of Variable
        As in the form that the modes were found from.
    modes : tuple of Mode
    tree : SearchTree or None
        Finds a leaf; None where an algebraic loop leaves no order of tests, and regions are searched one by one.
    tests : tuple of Condition
        Source of each test of the tree.
    leaves : tuple of Auxiliaries
        d and z at each leaf; empty where they are not known.
    owner : tuple of int
        The mode of each leaf.
    dead_ends : tuple of Condition
        Why there is no mode at the ends of the tree that are numbered behind the leaves.
    source : str
        Name of the source file.
    is_complete : bool
        False if the search for modes was stopped by its limit.
    effort : Effort
    """

    name: str
    x: tuple[Variable, ...]
    u: tuple[Variable, ...]
    y: tuple[Variable, ...]
    d: tuple[Variable, ...]
    z: tuple[Variable, ...]
    modes: tuple[Mode, ...]
    tree: SearchTree | None
    tests: tuple[Condition, ...]
    leaves: tuple[Auxiliaries, ...]
    owner: tuple[int, ...]
    dead_ends: tuple[Condition, ...] = ()
    source: str = ""
    is_complete: bool = True
    effort: Effort = Effort()
    tolerances: Tolerances = field(default=DEFAULT_TOLERANCES)

    def __repr__(self) -> str:
        return one_line(self, counted(len(self.modes), "mode"))

    def _repr_html_(self) -> str:
        from hysdel_py.markup.cards import pwa_card

        return pwa_card(self)

    def step(
        self, x: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] = (), *, check: bool = True
    ) -> PwaStep:
        """One step of the system.

        Parameters
        ----------
        x : array_like of shape (nx,) or mapping
            State; Booleans are 0 or 1.
        u : array_like of shape (nu,) or mapping
            Input.
        check : bool
            Whether a state or input outside its range or outside the region of its mode is an error. Without the check
            the tests of the tree alone decide.

        Returns
        -------
        x1, y : arrays
        mode : int
            Index of the mode.

        Raises
        ------
        ArgumentError
            Wrong dimension, name, type or a value that is not finite.
        SimulationError
            The point lies in no mode; says which range or requirement fails, or in the gap of which threshold it lies.
        """
        state, control = as_vector(x, self.x, "state"), as_vector(u, self.u, "input")
        leaf = self._leaf(state, control, check=check)
        mode = self.modes[self.owner[leaf]]
        return (*mode.map(state, control), mode.index)

    def auxiliaries(
        self, x: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] = ()
    ) -> tuple[Vector, Vector]:
        """Values of d and z at a state and input.

        Raises
        ------
        ArgumentError, SimulationError
            As in :meth:`step`; also where joined modes have different values and there is no tree to tell them apart.
        """
        state, control = as_vector(x, self.x, "state"), as_vector(u, self.u, "input")
        return self._auxiliaries_of(self._leaf(state, control, check=True), np.concatenate([state, control]))

    def locate(self, x: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] = ()) -> int | None:
        """Index of the mode of a state and input, None if there is none."""
        state, control = as_vector(x, self.x, "state"), as_vector(u, self.u, "input")
        try:
            return self.owner[self._leaf(state, control, check=True)]
        except SimulationError:
            return None

    def _leaf(self, x: Vector, u: Vector, *, check: bool) -> int:
        tolerances = self.tolerances
        problems = check and (
            *range_violations(x, self.x, "state", tolerances.range),
            *range_violations(u, self.u, "input", tolerances.range),
        )
        if problems:
            raise SimulationError(problems)
        w = np.concatenate([x, u])
        if self.tree is None:
            return self._leaf_by_regions(w)
        place = self.tree.locate(w, absolute=tolerances.row, relative=tolerances.rounding)
        if 0 <= place.leaf < len(self.owner) and (not check or self._fits(place.leaf, w)):
            return place.leaf
        return self._leaf_of_hull(w, place)

    def _fits(self, leaf: int, w: Vector) -> bool:
        """Whether all thresholds and requirements of a leaf's mode hold; ranges have a tolerance of their own."""
        A, b = self._thresholds[self.owner[leaf]]
        size = np.abs(b) + np.abs(A) @ np.abs(w)
        return bool(np.all(b - A @ w >= -self.tolerances.row - self.tolerances.rounding * size))

    @cached_property
    def _thresholds(self) -> tuple[tuple[Vector, Vector], ...]:
        return tuple(_rows_to_check(mode) for mode in self.modes)

    def _leaf_by_regions(self, w: Vector) -> int:
        found = [leaf for leaf in range(len(self.owner)) if self._fits(leaf, w)]
        modes = tuple(dict.fromkeys(self.owner[leaf] for leaf in found))
        if len(modes) > 1:
            numbers = ", ".join(map(str, modes))
            raise SimulationError((f"the state and input lie in several modes: {numbers}",))
        if not found:
            raise SimulationError((self._reason(w, Place(-1, -1)),))
        return found[0]

    def _auxiliaries_of(self, leaf: int, w: Vector) -> tuple[Vector, Vector]:
        """Values of d and z at a leaf; without a tree nothing tells the leaves of a merged mode apart."""
        values = self.leaves[leaf].at(w)
        mode = self.owner[leaf]
        others = [k for k, owner in enumerate(self.owner) if owner == mode and k != leaf] if self.tree is None else []
        if all(np.array_equal(np.concatenate(values), np.concatenate(self.leaves[k].at(w))) for k in others):
            return values
        raise SimulationError(
            (f"mode {mode} joins modes that differ in their auxiliaries here: ask the Pwa before merge() for them",)
        )

    def _leaf_of_hull(self, w: Vector, place: Place) -> int:
        """The leaf of a point in a gap that merged modes have closed."""
        assert self.tree is not None  # the only caller has walked it
        for mode in self.modes if len(self.owner) > len(self.modes) else ():
            if self._fits(self.owner.index(mode.index), w):
                leaf = self.tree.locate(w, nearest=True).leaf
                return leaf if leaf >= 0 and self.owner[leaf] == mode.index else self.owner.index(mode.index)
        raise SimulationError((self._reason(w, place),))

    def _reason(self, w: Vector, place: Place) -> str:
        from hysdel_py.systems.pwa_reasons import reason_outside

        return reason_outside(self, w, place)

    @cached_property
    def dynamics(self) -> tuple[tuple[int, ...], ...]:
        """Groups of modes that share the map to the next state and output."""
        from hysdel_py.systems.pwa_merge import equal_dynamics

        return equal_dynamics(self)

    def merge(self) -> Pwa:
        """The same system with fewer modes: equal maps on regions whose union is convex are joined.

        Gaps of thresholds between joined modes belong to the joined mode.
        """
        from hysdel_py.systems.pwa_merge import merge

        return merge(self)

    def adjacency(self) -> nx.Graph:
        """Modes as nodes; an edge where two regions touch across the gap of a threshold."""
        from hysdel_py.systems.pwa_graph import adjacency

        return adjacency(self)

    def transitions(self) -> nx.DiGraph:
        """Modes as nodes; an edge where some (x, u) of one leads to a state for which the other has an input."""
        from hysdel_py.systems.pwa_graph import transitions

        return transitions(self)

    def describe(self) -> str:
        """Text with the variables and, for each mode, its word, conditions and map."""
        from hysdel_py.systems.describe_pwa import describe_pwa

        return describe_pwa(self)

    def simulate(
        self, x0: ArrayLike | Mapping[str, float], inputs: ArrayLike, *, ts: float = 1.0, check: bool = True
    ) -> Trajectory:
        """Run from a state under a sequence of inputs.

        Parameters and errors are those of :func:`hysdel_py.systems.simulation.simulate`; the signal ``mode`` of the
        trajectory holds the index of the mode of each step.
        """
        from hysdel_py.systems.simulation import simulate

        run = simulate(_WithAuxiliaries(self), x0, inputs, ts=ts, check=check)
        modes = [float(self.owner[self._leaf(x, u, check=check)]) for x, u in zip(run.x, run.u, strict=False)]
        return replace(run, info={"mode": np.array(modes)})


def _rows_to_check(mode: Mode) -> tuple[Vector, Vector]:
    rows = [i for i, source in enumerate(mode.sources) if source.kind is not RowKind.RANGE]
    return mode.region.A[rows], mode.region.b[rows]


@dataclass(frozen=True)
class _WithAuxiliaries:
    """A Pwa that steps like the other forms."""

    pwa: Pwa

    def __getattr__(self, name: str) -> tuple[Variable, ...]:
        variables: tuple[Variable, ...] = getattr(self.pwa, name)
        return variables

    def step(
        self, x: ArrayLike | Mapping[str, float], u: ArrayLike | Mapping[str, float] = (), *, check: bool = True
    ) -> tuple[Vector, Vector, Vector, Vector]:
        x1, y, _ = self.pwa.step(x, u, check=check)
        state, control = as_vector(x, self.pwa.x, "state"), as_vector(u, self.pwa.u, "input")
        leaf = self.pwa._leaf(state, control, check=check)
        return (x1, y, *self.pwa._auxiliaries_of(leaf, np.concatenate([state, control])))
