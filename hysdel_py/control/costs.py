"""What a hybrid controller minimises: weights on the signals of the model, and the norm that adds them up."""

from __future__ import annotations

from dataclasses import dataclass

from hysdel_py.control.settings import DEFAULT_CONTROL_TOLERANCES, ControlTolerances
from hysdel_py.control.weights import GroupWeight, Norm, Weight, Weights, group_weight
from hysdel_py.errors import ArgumentError
from hysdel_py.systems.mld import Mld
from hysdel_py.systems.signals import Variable

__all__ = ["Cost"]


@dataclass(frozen=True, slots=True)
class Cost:
    """Cost of a plan, in the formulation of the HYBCON controllers of the Hybrid Toolbox.

    ::

        |x_N - rx|_terminal
          + sum_{k=0}^{N-1} |y_k - ry|_y + |u_k - ru|_u + |u_k - u_{k-1}|_du + |d_k - rd|_d + |z_k - rz|_z
          + sum_{k=1}^{N-1} |x_k - rx|_x

    where ``|v|_Q`` is ``v' Q v`` for norm 2 (no factor one half), ``|Q v|_1`` for norm 1 and ``|Q v|_inf`` for the
    norm infinity. Slacks of softened limits are added by :class:`~hysdel_py.control.limits.Limits`.

    Attributes
    ----------
    y, x, u, d, z : mapping of name to number, vector, or matrix, optional
        Weight of the outputs, states, inputs, Boolean auxiliaries and real auxiliaries: a number per name (signals
        that are not named have no weight), a vector with one number per signal of the group, or a matrix: symmetric
        positive semidefinite for norm 2, any matrix with one column per signal for the others. What is left out has
        no weight: a cost without any weight accepts every plan that the model and the limits allow.
    du : as `u`, optional
        Weight of the change of the inputs from one step to the next, at time 0 from the input that was applied last,
        which :meth:`HybridMpc.solve` then asks for.
    terminal : as `x`, optional
        Weight of the last state; the weight `x` where it is left out. Give ``{}`` for a last state without weight.
    norm : 1, 2 or inf
        Also ``"inf"`` for infinity. With 1 and infinity the program is a mixed-integer linear one.

    Raises
    ------
    ArgumentError
        If `norm` is none of these. Weights are checked when a controller is built, because only then is the model
        known.

    Examples
    --------
    >>> Cost(y={"speed": 1.0, "torque": 0.1}, u={"brake": 0.01}).norm
    2
    """

    y: Weight | None = None
    x: Weight | None = None
    u: Weight | None = None
    d: Weight | None = None
    z: Weight | None = None
    terminal: Weight | None = None
    du: Weight | None = None
    norm: float | str = 2

    def __post_init__(self) -> None:
        _norm(self.norm)

    def resolve(self, mld: Mld, tolerances: ControlTolerances = DEFAULT_CONTROL_TOLERANCES) -> Weights:
        """Check the weights against a model and return them as matrices.

        Raises
        ------
        ArgumentError
            Unknown name, wrong shape, not a number, negative weight, or for norm 2 a matrix that is not symmetric
            positive semidefinite.
        """
        norm = _norm(self.norm)

        def group(weight: Weight | None, variables: tuple[Variable, ...], what: str) -> GroupWeight:
            return group_weight(weight, variables, what, norm, tolerances.definite)

        x = group(self.x, mld.x, "x")
        return Weights(
            y=group(self.y, mld.y, "y"),
            x=x,
            u=group(self.u, mld.u, "u"),
            du=group(self.du, mld.u, "du"),
            d=group(self.d, mld.d, "d"),
            z=group(self.z, mld.z, "z"),
            terminal=x if self.terminal is None else group(self.terminal, mld.x, "terminal"),
            norm=norm,
        )


def _norm(norm: float | str) -> Norm:
    try:
        return Norm(float("nan") if isinstance(norm, bool) else float(norm))
    except (TypeError, ValueError):
        raise ArgumentError(f"norm is {norm!r}: norm=1, norm=2 or norm=inf was expected") from None
