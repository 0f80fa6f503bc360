"""Written C against Python at many random points: laws of tests/data/mpqp, hybrid laws, and all shipped models.

    python benchmarks/c_code.py [--points 1000000] [--seed 0] [NAME ...]

A point counts as near a border if it is closer to a facet of its region, or to another region, than rounding in the
number type reaches; there the status may differ, and another law may be taken. The largest difference of the moves is
over all points that both sides hold, borders included. Everywhere else status and moves must agree up to the bound
that is printed; `wrong` counts points where they do not. Plants agree where status and all values do (relative 1e-12);
points within 1e-9 of a threshold are left out and counted. The program ends with 1 if anything is wrong.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
from c_driver import CompiledHybrid, CompiledLaw, CompiledPlant
from explicit_hybrid import CASES
from mpqp import problem
from numpy.typing import NDArray

import hysdel_py as hys
from hysdel_py.control.explicit_hybrid import explicit_hybrid
from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.export.hybrid_points import answers, random_zeta
from hysdel_py.export.hybrid_table import hybrid_table
from hysdel_py.export.law_number import Number
from hysdel_py.export.plant_c import STATUS
from hysdel_py.export.plant_points import violated
from hysdel_py.optimize.mpqp import solve_mpqp
from hysdel_py.systems.affine import Affine
from hysdel_py.systems.dha import AffineEquation, AffineRequirement, Dha, Event, LogicRequirement, Switch
from hysdel_py.systems.formula import Connective, Formula
from hysdel_py.systems.signals import Variable

LAWS = ("a_di_N3", "a_di_N10", "f_thesis", "c_pend_N3", "b_ms2_N3", "d_afti_N2")
HYBRIDS = ("two_tanks_N2", "two_tanks_N2_n1", "two_rooms_N1", "clutch_N1")
CHUNK = 20_000
Array = NDArray[np.float64]


def drawn(law: ExplicitLaw, count: int, rng: np.random.Generator) -> Array:
    """Points of a box a tenth larger than the domain."""
    low, high = law.domain.bounding_box
    room = 0.05 * (high - low)
    return rng.uniform(low - room, high + room, (count, law.p))


def reference(law: ExplicitLaw, points: Array) -> tuple[Array, Array, Array]:
    """Excess of the region that a point is deepest in, excess of the next one, and move there."""
    first, second, moves = [], [], []
    for part in np.array_split(points, max(1, len(points) // CHUNK)):
        excess = np.maximum.reduceat(law.A @ part.T - law.b[:, None], law.starts[:-1], axis=0)
        region = np.argmin(excess, axis=0)
        least = np.partition(excess, 1, axis=0)
        first.append(least[0])
        second.append(least[1])
        moves.append(np.einsum("nij,nj->ni", law.K[region, : law.moves], part) + law.k[region, : law.moves])
    return np.concatenate(first), np.concatenate(second), np.concatenate(moves)


def law_line(name: str, law: ExplicitLaw, method: str, number: str, points: Array, folder: Path) -> tuple[str, int]:
    code = law.to_c(folder / f"{name}_{method}_{number}.c", method=method, number=number)
    compiled = CompiledLaw(law, code)
    status, u, _ = compiled(points)
    first, second, moves = reference(law, points)
    margin = max(1e-6, 2 * compiled.scaling.margin(law.A, -law.b))
    near = (np.abs(first) < margin) | (second < margin)
    held = first <= law.tolerance
    both = held & (status == 0)
    error = np.where(both, np.abs(u - moves).max(axis=1), 0.0)
    allowed = float((2 * compiled.scaling.move_error(law.K[:, : law.moves], law.k[:, : law.moves])).max())
    wrong = int(np.sum(~near & ((held != (status == 0)) | (error > allowed))))
    other = int(np.sum(near & (held != (status == 0))))
    text = f"| {name} | {method} | {number} | {held.mean():.2f} | {near.sum()} | {other} | {wrong} "
    return text + f"| {error[~near].max(initial=0.0):.1e} | {allowed:.1e} | {error.max():.1e} |", wrong


def hybrid_law(name: str) -> HybridLaw:
    """The explicit law of a case of explicit_hybrid.py."""
    make, horizon, norm = CASES[name]
    mpc, box, fixed = make(horizon, norm)
    return explicit_hybrid(mpc, box, fixed=fixed)


def hybrid_line(name: str, law: HybridLaw, number: str, count: int, seed: int, folder: Path) -> tuple[str, int]:
    """The vectorised reference is itself compared with the law at some points."""
    table = hybrid_table(law, Number(number))
    zeta = random_zeta(law, count, np.random.default_rng(seed))
    status, u, seconds = CompiledHybrid(law, folder / f"{name}_{number}.c", number)(zeta)
    found = answers(table, zeta)
    for point, inside, move in zip(zeta[:300], found.inside, found.u, strict=False):
        expected = law(point)
        assert (expected is not None) == inside
        assert not inside or np.allclose(move, expected, atol=1e-9) or number == "float"
    allowed = 2 * table.table.scaling.move_error(table.law.K[:, : len(law.u)], table.law.k[:, : len(law.u)]).max()
    error = np.where(found.inside & (status == 0), np.abs(u - found.u).max(axis=1), 0.0)
    wrong = int(np.sum(found.is_clear & (((status == 0) != found.inside) | (error > allowed))))
    text = f"| {name} | {number} | {law.count} | {'no' if law.partition else 'yes'} | {found.inside.mean():.2f} "
    text += f"| {np.sum(~found.is_clear)} | {wrong} | {error[found.is_clear].max(initial=0.0):.1e} | {allowed:.1e} "
    return text + f"| {1e9 * seconds:.0f} |", wrong


def values_of(form: Affine, values: dict[str, Array]) -> Array:
    return np.asarray(form.constant + sum((c * values[n] for n, c in form.terms), start=np.zeros(1)))


def truth(formula: Formula, values: dict[str, Array]) -> NDArray[np.bool_]:
    stack: list[NDArray[np.bool_]] = []
    for entry in formula.postfix:
        if isinstance(entry, str):
            stack.append(values[entry] > 0.5)
        elif isinstance(entry, bool):
            stack.append(np.array([entry]))
        elif entry is Connective.NOT:
            stack.append(~stack.pop())
        else:
            right, left = stack.pop(), stack.pop()
            stack.append({Connective.AND: left & right, Connective.OR: left | right, Connective.IMPLIES: ~left | right,
                          Connective.IMPLIED_BY: left | ~right, Connective.IFF: left == right}[entry])  # fmt: skip
    return stack[0]


def defined(dha: Dha, name: str, values: dict[str, Array]) -> Array:
    match dha.definitions.get(name):
        case None:
            return np.zeros(1)
        case Event(form=form):
            return (values_of(form, values) <= 0).astype(float)
        case AffineEquation(value=form):
            return values_of(form, values)
        case Switch(condition=condition, then=then, otherwise=otherwise):
            holds = (values[condition.name] > 0.5) == condition.positive
            return np.where(holds, values_of(then, values), values_of(otherwise, values))
        case equation:
            return truth(equation.value, values).astype(float)


def plant_reference(dha: Dha, x: Array, u: Array) -> tuple[list[Array], NDArray[np.bool_]]:
    """Status, x+, y, d, z of all steps, and which are clear of thresholds."""
    values = {v.name: column for v, column in zip((*dha.x, *dha.u), np.hstack([x, u]).T, strict=True)}
    for name in dha.evaluation_order:
        values[name] = defined(dha, name, values)
    ones = np.ones(len(x))
    groups = [[defined(dha, v.name, values) * ones for v in group] for group in (dha.x, dha.y)]
    groups += [[values[v.name] * ones for v in group] for group in (dha.d, dha.z)]
    status = np.zeros(len(x), dtype=int)
    for bit, data, group in (("STATE_RANGE", x, dha.x), ("INPUT_RANGE", u, dha.u)):
        status |= STATUS[bit] * outside(data, group, dha.tolerances.range)
    for item in dha.requirements:
        if isinstance(item, LogicRequirement):
            holds = truth(item.value, values)
        else:
            holds = values_of(item.value, values) <= dha.tolerances.row
        status |= STATUS["MUST"] * ~holds
    clear = np.ones(len(x), dtype=bool)
    forms = [item.form for item in dha.items if isinstance(item, Event)]
    forms += [item.value for item in dha.items if isinstance(item, AffineRequirement)]
    for form in forms:
        size = abs(form.constant) + sum((abs(c) * np.abs(values[n]) for n, c in form.terms), start=np.zeros(1))
        clear &= np.abs(values_of(form, values)) > dha.tolerances.row + 1e-9 * size
    return [status, *(np.array(g).T.reshape(len(x), -1) for g in groups)], clear


def outside(data: Array, group: tuple[Variable, ...], slack: float) -> NDArray[np.bool_]:
    low, high = np.array([v.low for v in group]), np.array([v.high for v in group])
    below = data < low - slack * np.maximum(1.0, np.where(np.isfinite(low), np.abs(low), 0.0))
    above = data > high + slack * np.maximum(1.0, np.where(np.isfinite(high), np.abs(high), 0.0))
    return np.asarray((below | above).any(axis=1))


def random_points(group: tuple[Variable, ...], count: int, rng: np.random.Generator) -> Array:
    columns = []
    for v in group:
        low, high = max(v.low, -1e3), min(v.high, 1e3)
        room = 0.02 * (high - low)
        columns.append(rng.integers(0, 2, count) if v.is_bool else rng.uniform(low - room, high + room, count))
    return np.array(columns, dtype=float).T.reshape(count, len(group))


def plant_line(name: str, count: int, seed: int, folder: Path) -> tuple[str, int]:
    model, rng = hys.load(name), np.random.default_rng(seed)
    dha = model.dha
    x, u = random_points(dha.x, count, rng), random_points(dha.u, count, rng)
    found, seconds = CompiledPlant(model, folder / f"{name}.c")(x, u)
    expected, clear = plant_reference(dha, x, u)
    spot_check(dha, x[:500], u[:500], expected, clear)
    different = found[0] != expected[0]
    error = np.zeros(count)
    for ours, theirs in zip(found[1:], expected[1:], strict=True):
        error = np.maximum(error, (np.abs(ours - theirs) / np.maximum(1.0, np.abs(theirs))).max(axis=1, initial=0.0))
    wrong = int(np.sum(clear & (different | (error > 1e-12))))
    allowed = (expected[0] == 0).mean()
    text = f"| {name} | {count} | {allowed:.2f} | {np.sum(~clear)} | {wrong} | {error[clear].max():.1e} "
    return text + f"| {1e9 * seconds:.0f} |", wrong


def spot_check(dha: Dha, x: Array, u: Array, expected: list[Array], clear: NDArray[np.bool_]) -> None:
    """The vectorised reference is the step itself."""
    for k in np.flatnonzero(clear[: len(x)]).tolist():
        for ours, theirs in zip(dha.step(x[k], u[k], check=False), expected[1:], strict=True):
            assert np.allclose(ours, theirs[k], rtol=1e-12, atol=1e-12)
        assert sum(STATUS[bit] for bit in violated(dha, x[k], u[k])) == expected[0][k]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="laws, hybrid laws or models; by default all")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    if shutil.which("gcc") is None:
        print("gcc is not installed: nothing was compared")
        return 0
    models = [name for name in options.names or hys.shipped_models() if name in hys.shipped_models()]
    laws = [name for name in options.names or LAWS if name not in models]
    hybrids = [name for name in options.names or HYBRIDS if name in CASES]
    laws = [name for name in laws if name not in hybrids]
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        if models:
            print("| plant | points | allowed share | at thresholds | wrong | largest difference | ns per step |")
            print("|---" * 7 + "|")
        for name in models:
            text, bad = plant_line(name, options.points, options.seed, Path(folder))
            wrong += bad
            print(text, flush=True)
        if laws:
            print("\n| law | method | number | inside share | near borders | other status there | wrong "
                  "| largest difference away from borders | bound | anywhere |")  # fmt: skip
            print("|---" * 10 + "|")
        for name in laws:
            mpqp, moves = problem(name)
            law = ExplicitLaw.of(solve_mpqp(mpqp), moves)
            points = drawn(law, options.points, np.random.default_rng(options.seed))
            for method in ("tree", "sequential"):
                for number in ("double", "float", "int32", "int16"):
                    text, bad = law_line(name, law, method, number, points, Path(folder))
                    wrong += bad
                    print(text, flush=True)
        if hybrids:
            print("\n| hybrid law | number | regions | compared by value | inside share | near borders or ties | wrong "
                  "| largest difference | bound | ns |")  # fmt: skip
            print("|---" * 10 + "|")
        for name in hybrids:
            law = hybrid_law(name)
            for number in ("double", "float"):
                text, bad = hybrid_line(name, law, number, options.points, options.seed, Path(folder))
                wrong += bad
                print(text, flush=True)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
