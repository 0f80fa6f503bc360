"""Modelling language, compiler and control toolbox for hybrid systems.

Everything public is reachable from here and loaded when it is first used, so that importing the package stays fast.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from hysdel_py.version import __version__

if TYPE_CHECKING:
    from hysdel_py.analysis.diff import diff
    from hysdel_py.analysis.diff_report import Difference
    from hysdel_py.analysis.margins import Margins
    from hysdel_py.analysis.report import Verification
    from hysdel_py.analysis.verify import verify
    from hysdel_py.analysis.well_posed import WellPosedness, well_posed
    from hysdel_py.control.closed_loop import closed_loop
    from hysdel_py.control.costs import Cost
    from hysdel_py.control.disturbance import with_disturbances
    from hysdel_py.control.hybrid_mpc import HybridMpc, Move, MoveStatus
    from hysdel_py.control.limits import Limits
    from hysdel_py.control.moving_horizon import Estimate, MovingHorizonEstimator
    from hysdel_py.control.observer import KalmanObserver
    from hysdel_py.errors import ArgumentError, CompileError, HysdelError, SimulationError
    from hysdel_py.export.reading import read_json
    from hysdel_py.model import Model, audit, load, to_dha, to_mld, to_pwa, to_symbolic_mld
    from hysdel_py.optimize.case_file import CaseFile, read_case
    from hysdel_py.optimize.node_log import NodeLog
    from hysdel_py.reports.explain_infeasible import explain_infeasible
    from hysdel_py.reports.explanation import Explanation
    from hysdel_py.shipped import shipped_models
    from hysdel_py.systems.dha import Dha
    from hysdel_py.systems.mld import Mld
    from hysdel_py.systems.pwa import Pwa
    from hysdel_py.systems.simulation import simulate
    from hysdel_py.systems.trajectory import Trajectory

__all__ = [
    "ArgumentError", "CaseFile", "CompileError", "Cost", "Dha", "Difference", "Estimate", "Explanation",
    "HybridMpc", "HysdelError", "KalmanObserver", "Limits", "Margins", "Mld", "Model", "Move", "MoveStatus",
    "MovingHorizonEstimator", "NodeLog", "Pwa", "SimulationError", "Trajectory", "Verification", "WellPosedness",
    "__version__", "audit", "closed_loop", "diff", "explain_infeasible", "load", "read_case", "read_json",
    "shipped_models", "simulate", "to_dha", "to_mld", "to_pwa", "to_symbolic_mld", "verify", "well_posed",
    "with_disturbances",
]  # fmt: skip

_HOME = {
    "ArgumentError": "errors", "CompileError": "errors", "HysdelError": "errors", "SimulationError": "errors",
    "Model": "model", "audit": "model", "load": "model", "to_dha": "model", "to_mld": "model", "to_symbolic_mld":
    "model", "read_json": "export.reading", "shipped_models": "shipped", "Dha": "systems.dha", "Mld": "systems.mld",
    "Trajectory": "systems.trajectory", "to_pwa": "model", "Pwa": "systems.pwa",
    "simulate": "systems.simulation", "Cost": "control.costs", "Limits": "control.limits",
    "HybridMpc": "control.hybrid_mpc", "Move": "control.hybrid_mpc", "MoveStatus": "control.hybrid_mpc",
    "closed_loop": "control.closed_loop", "Margins": "analysis.margins", "Verification": "analysis.report",
    "verify": "analysis.verify", "Difference": "analysis.diff_report", "diff": "analysis.diff", "WellPosedness":
    "analysis.well_posed", "well_posed": "analysis.well_posed", "Estimate": "control.moving_horizon",
    "MovingHorizonEstimator": "control.moving_horizon", "KalmanObserver": "control.observer", "with_disturbances":
    "control.disturbance", "CaseFile": "optimize.case_file", "read_case": "optimize.case_file", "NodeLog":
    "optimize.node_log",
    "explain_infeasible": "reports.explain_infeasible", "Explanation": "reports.explanation",
}  # fmt: skip


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'hysdel_py' has no attribute {name!r}")
    value = getattr(import_module(f"hysdel_py.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
