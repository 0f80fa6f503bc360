"""Tolerances of the searches over several steps in one frozen object."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["DEFAULT_SEARCH_TOLERANCES", "SearchTolerances"]


@dataclass(frozen=True, slots=True)
class SearchTolerances:
    """Numerical tolerances of searches over mixed-integer rows.

    Attributes
    ----------
    rows : float
        What HiGHS keeps rows and bounds to, for rows whose greatest coefficient is 1.
    duals : float
        Dual values below this are zero.
    borderline : float
        A contradiction that vanishes when requirements, limits and ranges give by less than this, relative to their
        ends and at least absolute, is within a few times the tolerance of the solver.
    margin : float
        Distance that a point is moved away from its inequalities, at most, before it is simulated.
    apart : float
        Distance of an event from its threshold on the false side, relative to the size of its rows, in the second
        search where the simulator does not confirm the point of the first; some times `rows`.
    """

    rows: float = 1e-6
    duals: float = 1e-7
    borderline: float = 1e-5
    margin: float = 1e-3
    apart: float = 1e-5


DEFAULT_SEARCH_TOLERANCES = SearchTolerances()
