"""Modelling language, compiler and control toolbox for hybrid systems.

Everything public is reachable from here and loaded when it is first used, so that importing the package stays fast.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from hysdel_py.version import __version__

if TYPE_CHECKING:
    from hysdel_py.control.closed_loop import closed_loop
    from hysdel_py.control.costs import Cost
    from hysdel_py.control.explicit_law import ExplicitLaw
    from hysdel_py.control.hybrid_mpc import HybridMpc, Move, MoveStatus
    from hysdel_py.control.limits import Limits
    from hysdel_py.errors import ArgumentError, CompileError, HysdelError, SimulationError
    from hysdel_py.export.reading import read_json
    from hysdel_py.model import Model, load, to_dha, to_mld, to_symbolic_mld
    from hysdel_py.optimize.mpqp import MpQp, MpQpSettings, ParametricSolution, solve_mpqp
    from hysdel_py.shipped import shipped_models
    from hysdel_py.systems.dha import Dha
    from hysdel_py.systems.mld import Mld
    from hysdel_py.systems.simulation import simulate
    from hysdel_py.systems.trajectory import Trajectory

__all__ = [
    "ArgumentError", "CompileError", "Cost", "Dha", "ExplicitLaw", "HybridMpc", "HysdelError", "Limits", "Mld",
    "Model", "Move", "MoveStatus", "MpQp", "MpQpSettings", "ParametricSolution", "SimulationError", "Trajectory",
    "__version__", "closed_loop", "load", "read_json", "shipped_models", "simulate", "solve_mpqp", "to_dha",
    "to_mld", "to_symbolic_mld",
]  # fmt: skip

_HOME = {
    "ArgumentError": "errors", "CompileError": "errors", "HysdelError": "errors", "SimulationError": "errors",
    "Model": "model", "load": "model", "to_dha": "model", "to_mld": "model", "to_symbolic_mld": "model",
    "read_json": "export.reading", "shipped_models": "shipped",
    "Dha": "systems.dha", "Mld": "systems.mld", "Trajectory": "systems.trajectory",
    "simulate": "systems.simulation", "Cost": "control.costs", "Limits": "control.limits",
    "HybridMpc": "control.hybrid_mpc", "Move": "control.hybrid_mpc", "MoveStatus": "control.hybrid_mpc",
    "closed_loop": "control.closed_loop", "ExplicitLaw": "control.explicit_law",
    "MpQp": "optimize.mpqp", "MpQpSettings": "optimize.mpqp", "ParametricSolution": "optimize.mpqp",
    "solve_mpqp": "optimize.mpqp",
}  # fmt: skip


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'hysdel_py' has no attribute {name!r}")
    value = getattr(import_module(f"hysdel_py.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
