"""The slipping clutch as a linear system, its tracking controller, and the parameters of its explicit law.

A clutch that never sticks is linear in engine speed, relative speed, engine torque and normal force. Numbers are those
of section 10.6.2 and appendix L.1 of J.R.P. Kusters, "Modelling and coordinated control of advanced automotive
transmissions", TU/e, DCT 2005-58, which reports an explicit law of 21 regions and prints six of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.linear_cost import LinearCost
from hysdel_py.control.linear_limits import LinearLimits
from hysdel_py.control.linear_mpc import LinearMpc
from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.systems.lti import Lti

__all__ = [
    "BOX", "SAMPLE_TIME", "SECTION", "ClutchParameters", "linear_clutch", "linear_clutch_controller", "published_price",
    "published_section",
]  # fmt: skip

SAMPLE_TIME = 0.01
BOX = {"x": ([80.0, 0.0, 50.0], [150.0, 150.0, 150.0]), "u": (0.0, 180.0), "r": ([90.0, 0.0], [140.0, 1.0])}
"""Parameters of the explicit law: states, normal force applied last, references."""
SECTION: dict[str | int, float] = {"Te": 120.0, "Fn(-1)": 0.0, "r(we)": 120.0, "r(dw)": 0.0}
"""The section of the published picture, over engine speed and relative speed."""
NORMALISED_PRICE = 1e4
"""Price of the slack where the Hessian of the increment is 1."""


@dataclass(frozen=True, slots=True)
class ClutchParameters:
    """Physical parameters.

    Attributes
    ----------
    Je, Jv : float
        Inertias of the engine and of the vehicle side [kg m^2].
    be, bv : float
        Friction of the engine and of the vehicle side [Nm s/rad].
    mu : float
        Torque per normal force [m].
    """

    Je: float = 0.2
    Jv: float = 0.8
    be: float = 0.03
    bv: float = 0.67
    mu: float = 1.0


def linear_clutch(p: ClutchParameters | None = None, ts: float = SAMPLE_TIME) -> Lti:
    """The clutch while it slips: ``Je dwe = Te - be we - mu Fn``, ``Jv dwv = mu Fn - bv wv``, with dw = we - wv.

    Parameters
    ----------
    p : ClutchParameters, optional
    ts : float
        Sample time, over which torque and force are held [s].
    """
    p = ClutchParameters() if p is None else p
    A = [
        [-p.be / p.Je, 0.0, 1 / p.Je],
        [-p.be / p.Je + p.bv / p.Jv, -p.bv / p.Jv, 1 / p.Je],
        [0.0, 0.0, 0.0],
    ]
    B = [[-p.mu / p.Je], [-p.mu * (1 / p.Jv + 1 / p.Je)], [0.0]]
    return Lti.sampled(
        A, B, [[1, 0, 0], [0, 1, 0]], ts=ts,
        x=("we [rad/s]", "dw [rad/s]", "Te [Nm]"), u=("Fn [N]",), y=("we [rad/s]", "dw [rad/s]"), name="linear clutch",
    )  # fmt: skip


def linear_clutch_controller(lti: Lti | None = None, rho: float | None = None) -> LinearMpc:
    """Follow engine speed and relative speed with one free increment of the normal force.

    Parameters
    ----------
    lti : Lti, optional
        The clutch with the parameters of the document by default.
    rho : float, optional
        Price of the limits of the outputs; that of the document by default.
    """
    lti = linear_clutch() if lti is None else lti
    rho = published_price(lti) if rho is None else rho
    limits = LinearLimits(du=(-8.0, 8.0), u=(0.0, 180.0), y=([80.0, 0.0], [150.0, 150.0]), rho=rho)
    return LinearMpc(
        lti, "track", 10, LinearCost(y=[1.0, 20.0], du=0.0), limits,
        control_horizon=1, output_constraint_horizon=2, input_constraint_horizon=1,
    )  # fmt: skip


def published_price(lti: Lti) -> float:
    """The price with which the published laws were computed: 1e4 after the cost is scaled to a Hessian of 1 for du."""
    return NORMALISED_PRICE * float(linear_clutch_controller(lti, 1.0).program.H[0, 0]) / 2


def published_section(law: ExplicitLaw) -> ExplicitLaw:
    """The law over (we, dw) in the published window: engine speed in [75, 160], vehicle speed we - dw in [0, 160]."""
    rows = np.array([[1.0, 0.0], [-1.0, 0.0], [1.0, -1.0], [-1.0, 1.0]])
    return law.section(SECTION, Polyhedron(rows, np.array([160.0, -75.0, 160.0, 0.0])))
