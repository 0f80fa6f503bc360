"""A loaded model and its forms, each lowered when first asked for."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from numpy.typing import ArrayLike

from hysdel_py import compiler
from hysdel_py.errors import ArgumentError
from hysdel_py.lowering.big_m import BigM
from hysdel_py.lowering.constants import Constants
from hysdel_py.lowering.sharing import share as merge_equal
from hysdel_py.lowering.symbolic import symbolic_values

if TYPE_CHECKING:
    from hysdel_py.diagnostics.diagnostic import Diagnostic
    from hysdel_py.lowering.audit import Audit
    from hysdel_py.semantics.typed_model import TypedModel
    from hysdel_py.systems.dha import Dha
    from hysdel_py.systems.mld import Mld
    from hysdel_py.systems.pwa import Pwa
    from hysdel_py.systems.symbolic_mld import SymbolicMld
    from hysdel_py.systems.trajectory import Trajectory

__all__ = ["Model", "audit", "load", "to_dha", "to_mld", "to_pwa", "to_symbolic_mld"]

_E = TypeVar("_E", BigM, Constants)


class Model:
    """A checked model with the values of its parameters.

    Attributes
    ----------
    typed : TypedModel
        The model with symbolic parameters.
    parameters : dict of str to float
        Values from the file and from the call, as far as they are known.
    diagnostics : tuple of Diagnostic
        Warnings and notes.
    """

    def __init__(self, typed: TypedModel, parameters: Mapping[str, float], diagnostics: tuple[Diagnostic, ...]) -> None:
        self.typed = typed
        self.parameters = dict(parameters)
        self._diagnostics = diagnostics

    @property
    def name(self) -> str:
        """Name behind SYSTEM."""
        return self.typed.name

    @cached_property
    def _lowered(self) -> tuple[Dha, tuple[Diagnostic, ...]]:
        return compiler.lower_to_dha(self.typed, self.parameters, Constants.AFFINE)

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Warnings and notes of the stages that have run."""
        stages = (self.__dict__.get(name) for name in ("_lowered", "_lowered_to_mld"))
        found = [*self._diagnostics, *(d for stage in stages if stage for d in stage[1])]
        return tuple(dict.fromkeys(found))

    @property
    def dha(self) -> Dha:
        """The discrete hybrid automaton, which is the meaning of the model."""
        return self._lowered[0]

    @cached_property
    def _lowered_to_mld(self) -> tuple[Mld, tuple[Diagnostic, ...]]:
        return compiler.lower_to_mld(self.typed, self.dha, BigM.LP)

    @property
    def mld(self) -> Mld:
        """The mixed logical dynamical form with the default options."""
        return self._lowered_to_mld[0]

    @cached_property
    def pwa(self) -> Pwa:
        """The piecewise affine form with the default options."""
        from hysdel_py.lowering.modes import dha_to_pwa

        return dha_to_pwa(self.dha)

    def simulate(
        self, x0: ArrayLike | Mapping[str, float], inputs: ArrayLike, *, ts: float | None = None, check: bool = True
    ) -> Trajectory:
        """Simulate the Dha.

        Parameters
        ----------
        x0 : array_like of shape (nx,), or mapping
        inputs : array_like of shape (N, nu), or int
            One row per step; a number of steps for a model without inputs.
        ts : float, optional
            Sample time for the time axis; the parameter ``ts`` or ``Ts`` of the model where it has one, else 1.
        check : bool
            Whether leaving a declared range or violating MUST is an error.
        """
        return self.dha.simulate(x0, inputs, ts=self.sample_time if ts is None else ts, check=check)

    @property
    def sample_time(self) -> float:
        """Value of the parameter ``ts``, ``Ts`` or ``T_s``, else 1."""
        return next((self.parameters[name] for name in ("ts", "Ts", "T_s") if name in self.parameters), 1.0)

    def __repr__(self) -> str:
        counts = {"states": "STATE", "inputs": "INPUT", "outputs": "OUTPUT"}
        sizes = ", ".join(
            f"{sum(s.role.name == role for s in self.typed.symbols)} {word}" for word, role in counts.items()
        )
        return f"<Model {self.name}: {sizes}, {len(self.typed.items)} items>"

    def _repr_html_(self) -> str:
        from hysdel_py.markup.cards import model_card

        return model_card(self)


def load(
    path_or_text: str | os.PathLike[str],
    /,
    *,
    search_path: Sequence[str | os.PathLike[str]] = (),
    **parameters: ArrayLike,
) -> Model:
    """Load a model.

    Parameters
    ----------
    path_or_text : str or path
        A ``.hys`` file, the name of a shipped model (see ``models/README.md``), or the text of a model.
    search_path : sequence of paths
        Folders for the files of modules, besides the folder of the file that names them.
    **parameters : float or array_like
        Values for parameters; they win over the values in the file. A matrix parameter takes a list of rows or an
        array, one of a module ``t1`` its full name: ``**{"t1.area": 2.0}``.

    Raises
    ------
    CompileError
        With every mistake that was found, each with its place and what to do.

    Examples
    --------
    >>> model = load("SYSTEM leak { INTERFACE { STATE { REAL x [0, 1]; } PARAMETER { REAL a; } }"
    ...              " IMPLEMENTATION { CONTINUOUS { x = a*x; } } }", a=0.5)
    >>> model.dha.step([1.0])[0]
    array([0.5])
    """
    from hysdel_py.shipped import locate

    return Model(*compiler.analyse(locate(path_or_text), parameters, _folders(search_path)))


def _folders(search_path: Sequence[str | os.PathLike[str]]) -> tuple[Path, ...]:
    if isinstance(search_path, str) or not all(isinstance(folder, str | os.PathLike) for folder in search_path):
        raise ArgumentError(f"search_path is {search_path!r}: a sequence of folders was expected")
    return tuple(Path(folder) for folder in search_path)


def to_dha(model: Model, *, constants: str = "affine") -> Dha:
    """Lower a model to a Dha with options.

    Parameters
    ----------
    constants : {"affine", "aux", "forbid"}
        Constant terms of updates and outputs go to B5 and D5, to auxiliaries, or are errors.
    """
    _check_model(model)
    return compiler.lower_to_dha(model.typed, model.parameters, _option(Constants, constants, "constants"))[0]


def to_mld(
    model: Model | Pwa, *, big_m: str = "lp", constants: str = "affine", share: bool = False, compact: bool = False
) -> Mld:
    """Lower a model to the MLD form with options.

    Parameters
    ----------
    model : Model or Pwa
        A piecewise affine form becomes one Boolean for each hyperplane and each mode, and one real auxiliary for each
        affine piece.
    big_m : {"interval", "lp"}
        Rule for the big-M constants: interval arithmetic over the declared ranges, as the original compiler does, or
        the least that linear programs over the rows of the model prove (``docs/tight-models.md``).
    constants : {"affine", "aux", "forbid"}
        Constant terms of updates and outputs go to B5 and D5, to auxiliaries, or are errors.
    share : bool
        Merge generated Booleans of equal definition; `d` is then shorter than that of the Dha.
    compact : bool
        Leave out rows that the others imply.
    """
    rule = _option(BigM, big_m, "big_m")
    mld = _lowered_to_mld(model, rule, constants=constants, share=share)
    if not compact:
        return mld
    from hysdel_py.lowering.redundancy import remove_redundant_rows  # scipy is loaded with it

    return remove_redundant_rows(mld).mld


def _lowered_to_mld(model: Model | Pwa, rule: BigM, *, constants: str, share: bool) -> Mld:
    from hysdel_py.systems.pwa import Pwa

    if isinstance(model, Pwa):
        from hysdel_py.lowering.modes_to_dha import pwa_to_dha

        dha = pwa_to_dha(model)
        return compiler.lower_dha_to_mld(merge_equal(dha).dha if share else dha, rule)
    _check_model(model)
    dha = to_dha(model, constants=constants)
    return compiler.lower_to_mld(model.typed, merge_equal(dha).dha if share else dha, rule)[0]


def audit(model: Model, *, constants: str = "affine") -> Audit:
    """Say how large and how loose the big-M constants of a model are, and which ranges make them so.

    Parameters
    ----------
    constants : {"affine", "aux", "forbid"}
        As in :func:`to_mld`.

    Raises
    ------
    CompileError
    """
    from hysdel_py.lowering.audit import audit_dha

    _check_model(model)
    dha = to_dha(model, constants=constants)
    found = compiler.lower_to_mld(model.typed, dha, BigM.LP)[1]
    return audit_dha(dha, (*model.diagnostics, *found))


def to_pwa(
    system: Model | Dha | Mld,
    *,
    split_booleans: bool = False,
    max_modes: int | None = None,
    progress: Callable[[int, int, int], None] | None = None,
) -> Pwa:
    """Find the modes of a system.

    Parameters
    ----------
    system : Model, Dha or Mld
        A model is explored through its Dha; an Mld, also one that was read from a file, through its rows alone.
    split_booleans : bool
        Give a value to every Boolean state and input in each mode, also to those that no region depends on.
    max_modes : int, optional
        Stop at this number of modes, 100 000 by default; ``is_complete`` of the result says whether that happened.
    progress : callable, optional
        Called at each mode with the modes so far, the cells that wait, and the linear programs so far.

    Raises
    ------
    SimulationError
        An auxiliary is used but never defined, an algebraic loop is singular, or the rows of an Mld leave a real
        auxiliary open.
    """
    from hysdel_py.lowering.modes import MAX_MODES, dha_to_pwa
    from hysdel_py.lowering.modes_of_mld import mld_to_pwa
    from hysdel_py.systems.dha import Dha
    from hysdel_py.systems.mld import Mld

    most = MAX_MODES if max_modes is None else max_modes
    if not isinstance(most, int) or most < 1:
        raise ArgumentError(f"max_modes is {max_modes!r}: a positive whole number was expected")
    match system:
        case Model():
            return dha_to_pwa(system.dha, split_booleans=split_booleans, max_modes=most, progress=progress)
        case Dha():
            return dha_to_pwa(system, split_booleans=split_booleans, max_modes=most, progress=progress)
        case Mld():
            return mld_to_pwa(system, split_booleans=split_booleans, max_modes=most, progress=progress)
        case _:
            raise ArgumentError(f"system is a {type(system).__name__}: a Model, Dha or Mld was expected")


def _check_model(model: object) -> None:
    if not isinstance(model, Model):
        raise ArgumentError(f"model is a {type(model).__name__}: a Model was expected, as load() returns it")


def to_symbolic_mld(model: Model, *, every: bool = False, constants: str = "affine") -> SymbolicMld:
    """Lower a model whose real parameters may lack values to a form over these parameters.

    Rows and their order are those of :func:`to_mld`, and ``to_symbolic_mld(model).bind({"a": 1.0})`` is the form of the
    model loaded with ``a=1.0``.

    Parameters
    ----------
    every : bool
        Keep all REAL parameters of the file open, those with a value too.
    constants : {"affine", "aux", "forbid"}
        As in :func:`to_mld`.
    """
    numbers = symbolic_values(model.typed, model.parameters, every=every)
    dha = compiler.lower_to_dha(model.typed, numbers, _option(Constants, constants, "constants"))[0]
    return compiler.lower_to_symbolic_mld(model.typed, dha)[0]


def _option(enum: type[_E], value: str, name: str) -> _E:
    for member in enum:
        if value in (member.value, member):
            return member
    choices = ", ".join(repr(member.value) for member in enum)
    raise ArgumentError(f"{name} is {value!r}: one of {choices} was expected")
