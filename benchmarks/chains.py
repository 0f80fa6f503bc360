"""Chains of 2 to 1,000 dry contacts: cost of every simulation method, how it grows, and whether the methods agree.

A chain has n + 1 inertias in series. A clutch stands between each two neighbours, beside it in every third place a
spring and damper; torques drive every tenth inertia to and fro. Clutches are strong and weak in turn, so that blocks
stick and slip against each other. Everything is reproducible from the number n alone.

Cost is processor time per millisecond of motion, setting up left out: a run less a run of one step. Each method goes up
to the length at which one simulation has taken more than the budget, or at which it refuses; the table says which. The
difference is the greatest of any final speed from that of the reference, relative to the greatest speed: the reference
is `Moreau` with theta = 1/2 and a sixteenth of the step, whose own error the line of `exact` shows. The methods of
scipy integrate smooth friction, written down anew here with whole-array operations and a sparse Jacobian.

    python benchmarks/chains.py [--sizes 2,5,10] [--budget 6] [--methods NAMES] [--plot FILE]
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from time import process_time

import numpy as np

import hysdel_py as hys
from hysdel_py.errors import HysdelError

SIZES = (2, 5, 10, 20, 50, 100, 200, 500, 1000)
UNTIL, DT = 0.1, 1e-3
STEEPNESS = 1e3


@dataclass(frozen=True)
class Chain:
    """Numbers of a chain with n contacts: inertias, clutch limits, springs and dampers, torques as tables over time."""

    inertia: np.ndarray
    limit: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    drives: dict[int, tuple[tuple[float, float], ...]]
    start: np.ndarray


def chain(n: int) -> Chain:
    """The chain with n contacts."""
    i = np.arange(n)
    spring = i % 3 == 1
    limit = np.where(i % 2 == 0, 12.0, 3.0) * (1.0 + 0.3 * np.sin(1.7 * i))
    drives = {int(k): _drive(int(k)) for k in range(0, n + 1, 10)}
    start = np.where(np.arange(n + 1) % 7 < 2, 10.0, 0.0)
    inertia = 0.1 * (1.0 + 0.8 * np.sin(np.arange(n + 1)))
    return Chain(inertia, limit, np.where(spring, 400.0, 0.0), np.where(spring, 0.2, 0.0), drives, start)


def _drive(k: int) -> tuple[tuple[float, float], ...]:
    """A torque that goes to and fro, with another phase at each inertia."""
    height = 15.0 * math.cos(0.3 * k)
    return ((0.0, height), (0.04, -height), (UNTIL, height))


def drivetrain(data: Chain) -> hys.Drivetrain:
    """The chain as components."""
    parts: list[object] = [hys.Inertia(f"J{i}", J) for i, J in enumerate(data.inertia.tolist())]
    for i, limit in enumerate(data.limit.tolist()):
        parts.append(hys.Clutch(f"clutch{i}", f"J{i}", f"J{i + 1}", limit))
        if data.stiffness[i]:
            spring, damper = float(data.stiffness[i]), float(data.damping[i])
            parts.append(hys.SpringDamper(f"spring{i}", f"J{i}", f"J{i + 1}", spring, damper))
    parts += [hys.TorqueSource(f"drive{i}", f"J{i}", table) for i, table in data.drives.items()]
    return hys.Drivetrain(*parts)  # type: ignore[arg-type]


SCHEMES: dict[str, Callable[[float], object]] = {
    "theta=1/2": lambda dt: hys.Moreau(dt=dt),
    "Moreau": lambda dt: hys.Moreau(dt=dt, theta=None),
    "aug. Lagr.": lambda dt: hys.AugmentedLagrangian(dt=dt),
    "aug. Lagr. p=0.5": lambda dt: hys.AugmentedLagrangian(dt=dt, steepness=0.5, tolerance=1e-4),
    "Moreau by newton": lambda dt: hys.Moreau(dt=dt, theta=None, solver="newton", decomposition="boxed"),
    "Moreau by Lemke L-N": lambda dt: hys.Moreau(dt=dt, theta=None, solver="lemke"),
    "Moreau by Lemke P-G": lambda dt: hys.Moreau(dt=dt, theta=None, solver="lemke", decomposition="pfeiffer-glocker"),
    "Moreau by enumeration": lambda dt: hys.Moreau(dt=dt, theta=None, solver="enumerative", decomposition="boxed"),
    "variable step": lambda _: hys.VariableStepMoreau(tolerance=1e-2),
    "wait state": lambda dt: hys.WaitState(dt=dt),
    "Switch Model": lambda dt: hys.SwitchModel(dt=dt),
    "Karnopp": lambda dt: hys.Karnopp(dt=dt),
    "fixed-step LCP": lambda dt: hys.FixedStepLcp(dt=dt, solver="active-set"),
    "smoothing Radau": lambda _: hys.Smoothing(steepness=STEEPNESS, rtol=1e-6, atol=1e-8),
    "event-driven": lambda _: hys.EventDriven(solver="active-set", rtol=1e-6, atol=1e-6),
    "exact": lambda _: hys.Exact(),
}

PEERS = ("Radau", "BDF", "LSODA")


@dataclass(frozen=True)
class Entry:
    """One method at one length: seconds per millisecond of motion, difference from the reference, and what ended it."""

    seconds: float
    difference: float
    note: str = ""


def timed(run: Callable[[float], np.ndarray], budget: float) -> tuple[np.ndarray, float, float]:
    """Final speeds, time per millisecond without setting up, and time of the whole.

    Raises
    ------
    HysdelError
        By its first steps the run would take several times the budget.
    """
    run(DT)
    marks = [process_time()]
    for until in (DT, 3 * DT):
        run(until)
        marks.append(process_time())
    step = (marks[2] - 2 * marks[1] + marks[0]) / 2
    if step * UNTIL / DT > 3 * budget:
        raise HysdelError(f"about {step:.2g} s for a millisecond of motion: left out")
    speeds = run(UNTIL)
    whole = process_time() - marks[2]
    return speeds, max(whole - (marks[1] - marks[0]), 1e-9) / (UNTIL - DT) * 1e-3, whole


def simulated(line: hys.Drivetrain, start: np.ndarray, scheme: object) -> Callable[[float], np.ndarray]:
    """Final speeds after a time, by a scheme."""

    def run(until: float) -> np.ndarray:
        found = line.simulate(start, until, scheme, sample=until)  # type: ignore[arg-type]
        if found.t[-1] < until or (found.info.get("failures") or 0):
            raise HysdelError(found.messages[0])
        return np.array(found.speeds[-1])

    return run


def smooth(data: Chain, method: str) -> Callable[[float], np.ndarray]:
    """Final speeds by scipy's integrators on smooth friction; the state is speeds, then all twists."""
    from scipy.integrate import solve_ivp
    from scipy.sparse import bmat, csc_matrix, diags, identity

    n = len(data.limit)
    W = diags([np.ones(n), -np.ones(n)], [0, -1], shape=(n + 1, n)).tocsc()
    inverse = 1.0 / data.inertia
    across = identity(n).tocsc()

    def force(t: float) -> np.ndarray:
        total = np.zeros(n + 1)
        for k, table in data.drives.items():
            total[k] = np.interp(t, *np.transpose(table))
        return total

    def rates(t: float, z: np.ndarray) -> np.ndarray:
        slip = z[:n] - z[1 : n + 1]
        torque = data.limit * (2 / np.pi) * np.arctan(STEEPNESS * slip) + data.damping * slip
        torque += data.stiffness * z[n + 1 :]
        change = force(t)
        change[:n] -= torque
        change[1:] += torque
        return np.concatenate([inverse * change, slip])

    def jacobian(_: float, z: np.ndarray) -> csc_matrix:
        slip = z[:n] - z[1 : n + 1]
        slope = data.limit * (2 / np.pi) * STEEPNESS / (1 + (STEEPNESS * slip) ** 2) + data.damping
        weighted = diags(inverse) @ W
        return bmat(
            [[-(weighted @ diags(slope) @ W.T), -(weighted @ diags(data.stiffness))], [across @ W.T, None]], "csc"
        )

    def run(until: float) -> np.ndarray:
        z, kinks = np.concatenate([data.start, np.zeros(n)]), [0.0, 0.04, UNTIL]
        edges = sorted({min(kink, until) for kink in kinks})
        for a, b in pairwise(edges):
            options = {} if method == "LSODA" else {"jac": jacobian}
            found = solve_ivp(rates, (a, b), z, method=method, rtol=1e-6, atol=1e-8, **options)
            if not found.success:
                raise HysdelError(found.message)
            z = found.y[:, -1]
        return z[: n + 1]

    return run


def siconos(data: Chain) -> Callable[[float], np.ndarray]:
    """Final speeds by Siconos: Moreau-Jean with theta = 1/2, all contacts in one relay problem.

    Raises
    ------
    ImportError
        Siconos is not installed; its Debian packages are siconos and python3-siconos.
    """
    import siconos.kernel as kernel  # type: ignore[import-not-found]

    n = len(data.limit)
    W = np.eye(n + 1, n) - np.eye(n + 1, n, -1)

    def run(until: float) -> np.ndarray:
        body = kernel.LagrangianLinearTIDS(
            np.zeros(n + 1), data.start.copy(), np.diag(data.inertia), W * data.stiffness @ W.T, W * data.damping @ W.T
        )
        law = kernel.RelayNSL(n, -data.limit * DT, data.limit * DT)
        contact = kernel.Interaction(law, kernel.LagrangianLinearTIR(W.T, np.full(n, -1e9)))  # far below: always active
        system = kernel.NonSmoothDynamicalSystem(0.0, until)
        system.insertDynamicalSystem(body)
        system.link(contact, body)
        steps = kernel.TimeStepping(
            system, kernel.TimeDiscretisation(0.0, DT), kernel.MoreauJeanOSI(0.5), kernel.Relay()
        )
        while steps.hasNextEvent():
            force, middle = np.zeros(n + 1), steps.startingTime() + 0.5 * DT
            for k, table in data.drives.items():
                force[k] = np.interp(middle, *np.transpose(table))
            body.setFExtPtr(force)
            steps.computeOneStep()
            steps.nextStep()
        return np.array(body.velocity())

    return run


def entries(sizes: tuple[int, ...], budget: float, with_siconos: bool, chosen: str) -> dict[str, dict[int, Entry]]:
    """All methods at all lengths up to their ends."""
    table: dict[str, dict[int, Entry]] = {}
    ended: set[str] = set()
    for n in sizes:
        data = chain(n)
        begin = process_time()
        line = drivetrain(data)
        print(f"n = {n}: put together in {process_time() - begin:.2f} s", flush=True)
        reference = simulated(line, data.start, hys.Moreau(dt=DT / 16))(UNTIL)
        jobs = {name: simulated(line, data.start, make(DT)) for name, make in SCHEMES.items()}
        jobs |= {f"scipy {method}": smooth(data, method) for method in PEERS}
        if with_siconos:
            jobs["Siconos"] = siconos(data)
        for name, job in jobs.items():
            if name not in ended and (not chosen or name in chosen.split(",")):
                table.setdefault(name, {})[n] = found = entry(job, reference, budget)
                ended |= {name} if found.note else set()
                print(line_of(name, n, found), flush=True)
    return table


def entry(job: Callable[[float], np.ndarray], reference: np.ndarray, budget: float) -> Entry:
    """One method at one length; the note says why there is no longer one."""
    try:
        speeds, seconds, whole = timed(job, budget)
    except HysdelError as error:
        return Entry(math.nan, math.nan, str(error))
    difference = float(np.abs(speeds - reference).max() / np.abs(reference).max())
    return Entry(seconds, difference, f"took {whole:.0f} s, longer ones left out" if whole > budget else "")


def line_of(name: str, n: int, found: Entry) -> str:
    """One line of the report."""
    note = f"  {found.note}" if found.note else ""
    return f"{name:<20}{n:>6}{1e6 * found.seconds:>12.1f} us/ms{found.difference:>10.1e}{note}"


def growth(column: dict[int, Entry]) -> float:
    """Exponent of the cost over the length, fitted to its last three lengths."""
    known = [(n, found.seconds) for n, found in column.items() if math.isfinite(found.seconds)][-3:]
    if len(known) < 2:
        return math.nan
    return float(np.polyfit(*np.log(np.transpose(known)), 1)[0])


def report(table: dict[str, dict[int, Entry]], sizes: tuple[int, ...]) -> list[str]:
    """Tables in Markdown: cost and growth, then differences, then what ended each method."""
    head = [f"| method | {' | '.join(map(str, sizes))} |", "|---" * (len(sizes) + 1) + "|"]
    cost = [f"{head[0]} growth |", f"{head[1]}---|"]
    for name, column in table.items():
        cells = [f"{1e6 * column[n].seconds:.3g}" if n in column else "" for n in sizes]
        cost.append(f"| {name} | {' | '.join(cell.replace('nan', '-') for cell in cells)} | {growth(column):.1f} |")
    for name, column in table.items():
        cells = [f"{column[n].difference:.0e}" if n in column else "" for n in sizes]
        head.append(f"| {name} | {' | '.join(cell.replace('nan', '-') for cell in cells)} |")
    ends = [
        f"* {name}, n = {n}: {found.note}"
        for name, column in table.items()
        for n, found in column.items()
        if found.note
    ]
    return [
        "microseconds per millisecond of motion, and exponent of the last three lengths", "", *cost, "",
        "greatest difference of a final speed, relative", "", *head, "", *ends,
    ]  # fmt: skip


def plot(table: dict[str, dict[int, Entry]], path: str) -> None:
    """Cost over length, both logarithmic."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    axes = figure.subplots()
    for i, (name, column) in enumerate(table.items()):
        known = {n: found.seconds for n, found in column.items() if math.isfinite(found.seconds)}
        style = {"linestyle": ("-", "--", ":")[i // 10 % 3], "color": f"C{i % 10}", "marker": "os^Dv"[i % 5]}
        axes.plot(known.keys(), [1e6 * s for s in known.values()], label=name, markersize=4, linewidth=1.1, **style)
    axes.set(xscale="log", yscale="log", xlabel="number of dry contacts in the chain")
    axes.set_ylabel("processor time per millisecond of motion [microseconds]")
    axes.grid(True, which="major", alpha=0.4)
    figure.legend(loc="outside right upper", fontsize="small")
    figure.savefig(path, dpi=120)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", default=",".join(map(str, SIZES)), help="numbers of contacts")
    parser.add_argument("--budget", type=float, default=6.0, help="seconds of one simulation after which a method ends")
    parser.add_argument("--methods", default="", help="names of methods with commas between, all by default")
    parser.add_argument("--plot", metavar="FILE", help="write a picture of cost over length")
    options = parser.parse_args()
    try:
        import siconos.kernel  # type: ignore[import-not-found]  # noqa: F401

        with_siconos = True
    except ImportError:
        with_siconos = False
        print("Siconos is not installed: left out")
    sizes = tuple(int(n) for n in options.sizes.split(","))
    table = entries(sizes, options.budget, with_siconos, options.methods)
    print("", *report(table, sizes), sep="\n")
    if options.plot:
        plot(table, options.plot)


if __name__ == "__main__":
    main()
