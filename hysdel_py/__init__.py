"""Modelling language, compiler and control toolbox for hybrid systems.

Everything public is reachable from here and loaded when it is first used, so that importing the package stays fast.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from hysdel_py.version import __version__

if TYPE_CHECKING:
    from hysdel_py.analysis.certificate import PredictiveCertificate, Premise
    from hysdel_py.analysis.closed_form import closed_loop_pwa
    from hysdel_py.analysis.cycles import Cycles, limit_cycles
    from hysdel_py.analysis.diff import diff
    from hysdel_py.analysis.diff_report import Difference
    from hysdel_py.analysis.hybrid_set import HybridSet
    from hysdel_py.analysis.invariance import Invariant, feasible_states, invariant_set
    from hysdel_py.analysis.lyapunov import Lyapunov, lyapunov
    from hysdel_py.analysis.margins import Margins
    from hysdel_py.analysis.reach import Reach, reach, reach_backward
    from hysdel_py.analysis.report import Verification
    from hysdel_py.analysis.verify import verify
    from hysdel_py.analysis.well_posed import WellPosedness, well_posed
    from hysdel_py.bridges.iosystem import to_iosystem
    from hysdel_py.bridges.toolboxes import from_iosystem, to_scipy
    from hysdel_py.control.closed_loop import closed_loop
    from hysdel_py.control.costs import Cost
    from hysdel_py.control.disturbance import with_disturbances
    from hysdel_py.control.dynamic_programming.affine_feedback import AffineFeedback
    from hysdel_py.control.dynamic_programming.analytical import AnalyticalDp
    from hysdel_py.control.dynamic_programming.grids import Axis
    from hysdel_py.control.dynamic_programming.problem import DynamicProgram
    from hysdel_py.control.dynamic_programming.settings import DpSettings
    from hysdel_py.control.dynamic_programming.table import FeedbackTable
    from hysdel_py.control.explicit import explicit
    from hysdel_py.control.explicit_law import ExplicitLaw
    from hysdel_py.control.hybrid_law import HybridLaw
    from hysdel_py.control.hybrid_mpc import HybridMpc, Move, MoveStatus
    from hysdel_py.control.limits import Limits
    from hysdel_py.control.linear_cost import LinearCost
    from hysdel_py.control.linear_limits import LinearLimits
    from hysdel_py.control.linear_mpc import LinearMpc
    from hysdel_py.control.moving_horizon import Estimate, MovingHorizonEstimator
    from hysdel_py.control.observer import KalmanObserver
    from hysdel_py.drivetrain.components import (
        GROUND,
        Brake,
        Clutch,
        EngineMap,
        Gear,
        Inertia,
        Load,
        OneWayClutch,
        PlanetaryGear,
        SpeedSource,
        SpringDamper,
        TorqueSource,
        VehicleLoad,
    )
    from hysdel_py.drivetrain.drivetrain import Drivetrain
    from hysdel_py.drivetrain.laws import Coulomb, Stribeck
    from hysdel_py.drivetrain.schemes.options import (
        AugmentedLagrangian,
        EventDriven,
        Exact,
        FixedStepLcp,
        Karnopp,
        Moreau,
        Smoothing,
        SwitchModel,
        VariableStepMoreau,
        WaitState,
    )
    from hysdel_py.drivetrain.signals import PiecewiseLinear
    from hysdel_py.drivetrain.trajectory import ContactMode, DrivetrainTrajectory
    from hysdel_py.errors import ArgumentError, CompileError, HysdelError, Interrupted, SimulationError
    from hysdel_py.export.fmu import to_fmu
    from hysdel_py.export.json_file import read_json
    from hysdel_py.export.plant_c import to_c
    from hysdel_py.geometry.polyhedron import Polyhedron
    from hysdel_py.geometry.relations import minkowski_sum, pontryagin_difference
    from hysdel_py.geometry.union import PolyhedralUnion
    from hysdel_py.model import Model, audit, load, to_dha, to_mld, to_pwa, to_symbolic_mld
    from hysdel_py.optimize.case_file import CaseFile, read_case
    from hysdel_py.optimize.lcp.solve import LcpResult, LcpSettings, LcpStatus, solve_boxed_lcp, solve_lcp
    from hysdel_py.optimize.mpmiqp import MpMiqp, MpMiqpSettings, solve_mpmiqp
    from hysdel_py.optimize.mpqp import MpQp, MpQpSettings, ParametricSolution, solve_mpqp
    from hysdel_py.optimize.node_log import NodeLog
    from hysdel_py.optimize.warm_up import warm_up
    from hysdel_py.reports.explain_infeasible import explain_infeasible
    from hysdel_py.reports.explanation import Explanation
    from hysdel_py.reports.observability import observability
    from hysdel_py.reports.observability_answer import Observability
    from hysdel_py.reports.page import html_report
    from hysdel_py.reports.plan_steps import plans_never
    from hysdel_py.reports.predictive import predictive_certificate
    from hysdel_py.reports.queries import QueryAnswer, answer_queries
    from hysdel_py.reports.safety import can_reach, must_reach
    from hysdel_py.reports.safety_answer import SafetyAnswer
    from hysdel_py.shipped import shipped_models
    from hysdel_py.sweeps.record import Sweep, SweepRecord
    from hysdel_py.sweeps.sweep import sweep
    from hysdel_py.systems.dha import Dha
    from hysdel_py.systems.lti import Lti
    from hysdel_py.systems.mld import Mld
    from hysdel_py.systems.pwa import Pwa
    from hysdel_py.systems.simulation import simulate
    from hysdel_py.systems.trajectory import Trajectory

__all__ = [
    "GROUND",
    "AffineFeedback",
    "AnalyticalDp",
    "ArgumentError",
    "AugmentedLagrangian",
    "Axis",
    "Brake",
    "CaseFile",
    "Clutch",
    "CompileError",
    "ContactMode",
    "Cost",
    "Coulomb",
    "Cycles",
    "Dha",
    "Difference",
    "DpSettings",
    "Drivetrain",
    "DrivetrainTrajectory",
    "DynamicProgram",
    "EngineMap",
    "Estimate",
    "EventDriven",
    "Exact",
    "Explanation",
    "ExplicitLaw",
    "FeedbackTable",
    "FixedStepLcp",
    "Gear",
    "HybridLaw",
    "HybridMpc",
    "HybridSet",
    "HysdelError",
    "Inertia",
    "Interrupted",
    "Invariant",
    "KalmanObserver",
    "Karnopp",
    "LcpResult",
    "LcpSettings",
    "LcpStatus",
    "Limits",
    "LinearCost",
    "LinearLimits",
    "LinearMpc",
    "Load",
    "Lti",
    "Lyapunov",
    "Margins",
    "Mld",
    "Model",
    "Moreau",
    "Move",
    "MoveStatus",
    "MovingHorizonEstimator",
    "MpMiqp",
    "MpMiqpSettings",
    "MpQp",
    "MpQpSettings",
    "NodeLog",
    "Observability",
    "OneWayClutch",
    "ParametricSolution",
    "PiecewiseLinear",
    "PlanetaryGear",
    "PolyhedralUnion",
    "Polyhedron",
    "PredictiveCertificate",
    "Premise",
    "Pwa",
    "QueryAnswer",
    "Reach",
    "SafetyAnswer",
    "SimulationError",
    "Smoothing",
    "SpeedSource",
    "SpringDamper",
    "Stribeck",
    "Sweep",
    "SweepRecord",
    "SwitchModel",
    "TorqueSource",
    "Trajectory",
    "VariableStepMoreau",
    "VehicleLoad",
    "Verification",
    "WaitState",
    "WellPosedness",
    "__version__",
    "answer_queries",
    "audit",
    "can_reach",
    "closed_loop",
    "closed_loop_pwa",
    "diff",
    "explain_infeasible",
    "explicit",
    "feasible_states",
    "from_iosystem",
    "html_report",
    "invariant_set",
    "limit_cycles",
    "load",
    "lyapunov",
    "minkowski_sum",
    "must_reach",
    "observability",
    "plans_never",
    "pontryagin_difference",
    "predictive_certificate",
    "reach",
    "reach_backward",
    "read_case",
    "read_json",
    "shipped_models",
    "simulate",
    "solve_boxed_lcp",
    "solve_lcp",
    "solve_mpmiqp",
    "solve_mpqp",
    "sweep",
    "to_c",
    "to_dha",
    "to_fmu",
    "to_iosystem",
    "to_mld",
    "to_pwa",
    "to_scipy",
    "to_symbolic_mld",
    "verify",
    "warm_up",
    "well_posed",
    "with_disturbances",
]  # fmt: skip

_HOME = {
    "AffineFeedback": "control.dynamic_programming.affine_feedback",
    "AnalyticalDp": "control.dynamic_programming.analytical",
    "ArgumentError": "errors",
    "AugmentedLagrangian": "drivetrain.schemes.options",
    "Axis": "control.dynamic_programming.grids",
    "Brake": "drivetrain.components",
    "CaseFile": "optimize.case_file",
    "Clutch": "drivetrain.components",
    "CompileError": "errors",
    "ContactMode": "drivetrain.trajectory",
    "Cost": "control.costs",
    "Coulomb": "drivetrain.laws",
    "Cycles": "analysis.cycles",
    "Dha": "systems.dha",
    "Difference": "analysis.diff_report",
    "DpSettings": "control.dynamic_programming.settings",
    "Drivetrain": "drivetrain.drivetrain",
    "DrivetrainTrajectory": "drivetrain.trajectory",
    "DynamicProgram": "control.dynamic_programming.problem",
    "EngineMap": "drivetrain.components",
    "Estimate": "control.moving_horizon",
    "EventDriven": "drivetrain.schemes.options",
    "Exact": "drivetrain.schemes.options",
    "Explanation": "reports.explanation",
    "ExplicitLaw": "control.explicit_law",
    "FeedbackTable": "control.dynamic_programming.table",
    "FixedStepLcp": "drivetrain.schemes.options",
    "GROUND": "drivetrain.components",
    "Gear": "drivetrain.components",
    "HybridLaw": "control.hybrid_law",
    "HybridMpc": "control.hybrid_mpc",
    "HybridSet": "analysis.hybrid_set",
    "HysdelError": "errors",
    "Inertia": "drivetrain.components",
    "Interrupted": "errors",
    "Invariant": "analysis.invariance",
    "KalmanObserver": "control.observer",
    "Karnopp": "drivetrain.schemes.options",
    "LcpResult": "optimize.lcp.solve",
    "LcpSettings": "optimize.lcp.solve",
    "LcpStatus": "optimize.lcp.solve",
    "Limits": "control.limits",
    "LinearCost": "control.linear_cost",
    "LinearLimits": "control.linear_limits",
    "LinearMpc": "control.linear_mpc",
    "Load": "drivetrain.components",
    "Lti": "systems.lti",
    "Lyapunov": "analysis.lyapunov",
    "Margins": "analysis.margins",
    "Mld": "systems.mld",
    "Model": "model",
    "Moreau": "drivetrain.schemes.options",
    "Move": "control.hybrid_mpc",
    "MoveStatus": "control.hybrid_mpc",
    "MovingHorizonEstimator": "control.moving_horizon",
    "MpMiqp": "optimize.mpmiqp",
    "MpMiqpSettings": "optimize.mpmiqp",
    "MpQp": "optimize.mpqp",
    "MpQpSettings": "optimize.mpqp",
    "NodeLog": "optimize.node_log",
    "Observability": "reports.observability_answer",
    "OneWayClutch": "drivetrain.components",
    "ParametricSolution": "optimize.mpqp",
    "PiecewiseLinear": "drivetrain.signals",
    "PlanetaryGear": "drivetrain.components",
    "PolyhedralUnion": "geometry.union",
    "Polyhedron": "geometry.polyhedron",
    "PredictiveCertificate": "analysis.certificate",
    "Premise": "analysis.certificate",
    "Pwa": "systems.pwa",
    "QueryAnswer": "reports.queries",
    "Reach": "analysis.reach",
    "SafetyAnswer": "reports.safety_answer",
    "SimulationError": "errors",
    "Smoothing": "drivetrain.schemes.options",
    "SpeedSource": "drivetrain.components",
    "SpringDamper": "drivetrain.components",
    "Stribeck": "drivetrain.laws",
    "Sweep": "sweeps.record",
    "SweepRecord": "sweeps.record",
    "SwitchModel": "drivetrain.schemes.options",
    "TorqueSource": "drivetrain.components",
    "Trajectory": "systems.trajectory",
    "VariableStepMoreau": "drivetrain.schemes.options",
    "VehicleLoad": "drivetrain.components",
    "Verification": "analysis.report",
    "WaitState": "drivetrain.schemes.options",
    "WellPosedness": "analysis.well_posed",
    "answer_queries": "reports.queries",
    "audit": "model",
    "can_reach": "reports.safety",
    "closed_loop": "control.closed_loop",
    "closed_loop_pwa": "analysis.closed_form",
    "diff": "analysis.diff",
    "explain_infeasible": "reports.explain_infeasible",
    "explicit": "control.explicit",
    "feasible_states": "analysis.invariance",
    "from_iosystem": "bridges.toolboxes",
    "html_report": "reports.page",
    "invariant_set": "analysis.invariance",
    "limit_cycles": "analysis.cycles",
    "load": "model",
    "lyapunov": "analysis.lyapunov",
    "minkowski_sum": "geometry.relations",
    "must_reach": "reports.safety",
    "observability": "reports.observability",
    "plans_never": "reports.plan_steps",
    "pontryagin_difference": "geometry.relations",
    "predictive_certificate": "reports.predictive",
    "reach": "analysis.reach",
    "reach_backward": "analysis.reach",
    "read_case": "optimize.case_file",
    "read_json": "export.json_file",
    "shipped_models": "shipped",
    "simulate": "systems.simulation",
    "solve_boxed_lcp": "optimize.lcp.solve",
    "solve_lcp": "optimize.lcp.solve",
    "solve_mpmiqp": "optimize.mpmiqp",
    "solve_mpqp": "optimize.mpqp",
    "sweep": "sweeps.sweep",
    "to_c": "export.plant_c",
    "to_dha": "model",
    "to_fmu": "export.fmu",
    "to_iosystem": "bridges.iosystem",
    "to_mld": "model",
    "to_pwa": "model",
    "to_scipy": "bridges.toolboxes",
    "to_symbolic_mld": "model",
    "verify": "analysis.verify",
    "warm_up": "optimize.warm_up",
    "well_posed": "analysis.well_posed",
    "with_disturbances": "control.disturbance",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'hysdel_py' has no attribute {name!r}")
    value = getattr(import_module(f"hysdel_py.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def load_ipython_extension(shell: object) -> None:
    """Make the cell magic ``%%hysdel`` known to IPython; what ``%load_ext hysdel_py`` calls."""
    from hysdel_py.notebook.magic import register

    register(shell)


def __dir__() -> list[str]:
    return sorted(__all__)
