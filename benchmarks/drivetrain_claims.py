"""The source document's claims about its methods, each beside numbers; docs/drivetrain-claims.md judges them.

Every function measures one claim and says what it found in one line; its docstring is the claim, in our words, with the
section. Times are processor times of single runs, of which ratios alone mean something.

    python benchmarks/drivetrain_claims.py [--only 3,12]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from math import inf
from time import process_time
from typing import Any

import numpy as np
from chains import DT, chain, drivetrain
from scipy.optimize import linprog

import hysdel_py as hys
from hysdel_py.drivetrain.comparison import FIXED, mean_error
from hysdel_py.drivetrain.decomposition import friction_lcp
from hysdel_py.drivetrain.dual_clutch import START, UNTIL, dual_clutch
from hysdel_py.drivetrain.trajectory import DrivetrainTrajectory
from hysdel_py.optimize.lcp.solve import solve_lcp

SAMPLE = 1e-3
EXACT = {case: dual_clutch(case).simulate(START, UNTIL, hys.Exact(), sample=SAMPLE) for case in "ab"}


def dual(scheme: Any, case: str = "a", dt: float | None = None) -> DrivetrainTrajectory:
    """The Dual-clutch by a scheme, or by the method of that name in the comparison."""
    chosen = FIXED[scheme] if isinstance(scheme, str) else scheme
    if dt is not None:
        chosen = replace(chosen, dt=dt)
    return dual_clutch(case).simulate(START, UNTIL, chosen, sample=SAMPLE)


def error(scheme: Any, case: str = "a", dt: float | None = None) -> float:
    """Mean error against the exact solution [rad/s]."""
    return mean_error(dual(scheme, case, dt), EXACT[case])


def seconds(run: Callable[[], Any]) -> float:
    """Processor time of a run, once it has been done before."""
    run()
    begin = process_time()
    run()
    return process_time() - begin


def pair(friction: Any = 1.0, force: Any = 50.0) -> hys.Drivetrain:
    """Two inertias and a clutch that is driven and loaded."""
    return hys.Drivetrain(
        hys.Inertia("a", 0.2), hys.Inertia("b", 0.8), hys.Clutch("clutch", "a", "b", force, friction),
        hys.TorqueSource("T1", "a", 30), hys.TorqueSource("T2", "b", -20),
    )  # fmt: skip


def belt(friction: Any) -> DrivetrainTrajectory:
    """A mass on a spring that a belt drags along, 100 s."""
    line = hys.Drivetrain(
        hys.Inertia("m", 1), hys.SpringDamper("x", "m", hys.GROUND, 1), hys.SpeedSource("belt", 0.2),
        hys.Clutch("contact", "belt", "m", 1, friction),
    )  # fmt: skip
    return line.simulate({"m": 0.0, "x": 0.0}, 100.0, hys.EventDriven(rtol=1e-8, atol=1e-8), sample=0.1)


def on_chain(n: int, scheme: Any, until: float = 0.1) -> DrivetrainTrajectory:
    """The chain of n contacts by a scheme."""
    data = chain(n)
    return drivetrain(data).simulate(data.start, until, scheme, sample=until)


def per_step(n: int, scheme: Any) -> float:
    """Processor time of one step on a chain; setting up does not count."""
    data = chain(n)
    line = drivetrain(data)
    short, long = (seconds(lambda t=t: line.simulate(data.start, t, scheme, sample=t)) for t in (DT, 0.1))
    return max(long - short, 1e-9) / (0.1 / DT - 1)


def stick_slip() -> str:
    """1.1: static friction above dynamic friction can make stick-slip vibrations."""
    swings = [
        np.ptp(belt(law)["x"][500:]) for law in (hys.Coulomb(1, 0.5), hys.Coulomb(1, 1), hys.Stribeck(1, 0.5, 0.1))
    ]
    return "swing of the twist after 50 s: mu_d/mu_s = 0.5 {:.2f}, 1 {:.1e}, Stribeck {:.2f} rad".format(*swings)


def smoothing_is_direct() -> str:
    """1.3: smooth friction needs no event detection and no mode selection; standard integrators do."""
    run = dual(hys.Smoothing(steepness=1e3))
    off = mean_error(run, EXACT["a"])
    return f"Radau, steepness 1e3, case a: mean error {off:.1e}, {run.info['evaluations']} evaluations"


def smoothing_is_dear() -> str:
    """1.3: accuracy needs stiff laws, which are dear to integrate."""
    words = []
    for steepness in (1e1, 1e2, 1e3, 1e4):
        run = dual(hys.Smoothing(steepness=steepness))
        words.append(f"{steepness:.0e}: {mean_error(run, EXACT['a']):.1e}, {run.info['evaluations']}")
    G = float(np.linalg.eigvalsh(dual_clutch().equations.G)[-1])
    limit = np.pi / (G * 100 * 1e4)
    return (
        f"Radau, error and evaluations by steepness {'; '.join(words)}; explicit Euler at 1e4 needs dt < {limit:.0e} s"
    )


def held(scheme: Any) -> tuple[float, float]:
    """Slip at the end [rad/s] and relative angle gathered while a clutch sticks for 100 s [rad]."""
    run = pair().simulate({"a": 50.0, "b": 49.0}, 100.0, scheme, sample=0.01)
    return abs(float(run["clutch.slip"][-1])), abs(float(np.sum(run["clutch.slip"][100:]) * 0.01))


def karnopp_drifts() -> str:
    """2: the slip that the Karnopp model leaves in its band makes it drift off; the Switch Model does not."""
    words = []
    for name, scheme in (("Karnopp", hys.Karnopp(band=0.1)), ("Switch Model", hys.SwitchModel(band=0.1, tau=0.01))):
        words.append("{}: slip {:.1e} rad/s, angle {:.1e} rad".format(name, *held(scheme)))
    return f"stuck for 100 s, {'; '.join(words)}"


def karnopp_is_unstable() -> str:
    """2: that offset can make the integration unstable."""
    slips = [held(hys.Karnopp(dt=dt, band=0.5, integrator="euler"))[0] for dt in (1e-2, 1e-3)]
    return "slip after 100 s, band 0.5, Euler: dt 1e-2 {:.3f}, 1e-3 {:.3f} rad/s (it stays in the band)".format(*slips)


def switch_is_not_stiff() -> str:
    """2, 7.1: the Switch Model's differential equations are not stiff."""
    slips = {
        tau: held(hys.SwitchModel(dt=1e-3, band=0.1, tau=tau, integrator="euler"))[0] for tau in (1e-2, 1e-3, 4e-4)
    }
    return "slip of a stuck clutch, Euler at 1e-3 s: " + ", ".join(f"tau {tau:g} {s:.1e}" for tau, s in slips.items())


def thin_band() -> str:
    """2: the band should be so narrow that it has no influence."""
    runs = {band: dual(replace(FIXED["SWITCH"], band=band), "b") for band in (1e-3, 1e-2, 1e-1, 1.0, 10.0)}
    words = [f"{band:g}: {mean_error(run, EXACT['b']):.2f}, {len(run.events)}" for band, run in runs.items()]
    tied = dual(hys.SwitchModel(integrator="euler"), "b")
    words.append(f"tied to the step: {mean_error(tied, EXACT['b']):.2f}, {len(tied.events)}")
    return f"case b, Euler at 1e-3 s, error and mode changes (4 true ones) by band {'; '.join(words)}"


def switch_grows_exponentially() -> str:
    """2, 7.1: its logic grows exponentially with the contacts, so that it is unfit for many."""
    return growth_line(hys.SwitchModel(dt=DT))


def growth_line(scheme: Any) -> str:
    """Time of a step on chains of three lengths."""
    cost = {n: per_step(n, scheme) for n in (10, 100, 1000)}
    exponent = np.log10(cost[1000] / cost[100])
    words = ", ".join(f"n = {n} {1e6 * t:.0f} us" for n, t in cost.items())
    return f"a step on a chain: {words} (exponent {exponent:.1f} behind 100)"


def events_are_dear() -> str:
    """3, 7.1: watching indicators and finding events takes time, above all with many contacts."""
    words = []
    for n in (2, 10, 40):
        runs = [hys.EventDriven(solver="active-set", rtol=1e-6, atol=1e-6), hys.Moreau(dt=DT)]
        slow, fast = (seconds(lambda s=scheme, n=n: on_chain(n, s)) for scheme in runs)
        words.append(f"n = {n} {len(on_chain(n, runs[0]).events)} events, {slow / fast:.0f} x")
    few = seconds(lambda: dual(hys.EventDriven("rk45", rtol=1e-6, atol=1e-6, solver="active-set"), "b"))
    base = seconds(lambda: dual("SWITCH", "b"))
    return f"against theta = 1/2 at 1e-3 s on chains: {', '.join(words)}; Dual-clutch b {few / base:.1f} x SWITCH"


def acceleration_modes(q: float) -> int:
    """How many of the sixteen modes of the four-fold decomposition of one contact solve its LCP (M = 1, limit 1)."""
    one = np.ones(1)
    M, b = friction_lcp("pfeiffer-glocker", np.eye(1), np.array([q]), -one, one)
    return sum(solves(M, b, np.array(basic)) for basic in product((False, True), repeat=4))


def solves(M: np.ndarray, q: np.ndarray, basic: np.ndarray) -> bool:
    """Whether the LCP has a solution with these entries of z free, the others zero."""
    none, rest = np.zeros(int(basic.sum())), ~basic
    equal, above = M[np.ix_(basic, basic)], M[np.ix_(rest, basic)]
    if not len(none):
        return bool(np.all(q >= 0))
    return bool(linprog(none, A_ub=-above, b_ub=q[rest], A_eq=equal, b_eq=-q[basic]).status == 0)


def abundant_modes() -> str:
    """3.3.1, C: four unknowns per contact have modes that are superfluous."""
    counts = [acceleration_modes(q) for q in (0.5, 2.0, 0.0)]
    return "modes of 16 that solve one contact: stick {}, slip {}, no acceleration at all {}".format(*counts)


def dimension_costs() -> str:
    """3.3.2: two unknowns per contact halve the LCP and save time, the more the more contacts there are."""
    words = []
    for n in (2, 10, 40):
        a, b = (
            seconds(lambda d=d, n=n: on_chain(n, hys.Moreau(dt=DT, theta=None, solver="lemke", decomposition=d), 0.03))
            for d in ("pfeiffer-glocker", "leine-nijmeijer")
        )
        words.append(f"n = {n} {a / b:.1f}")
    return f"time with four unknowns over that with two, Lemke's method: {', '.join(words)}"


def enumeration_explodes() -> str:
    """3.4: trying all modes is for small systems only."""
    words = []
    for n in (1, 2, 3, 4):
        G, c = np.eye(n) + 0.2, np.linspace(-1, 1, n)
        answer = solve_lcp(*friction_lcp("leine-nijmeijer", G, c, -0.4 * np.ones(n), 0.4 * np.ones(n)), "enumerative")
        words.append(f"{n}: {answer.iterations} of {4**n}")
    try:
        on_chain(50, hys.Moreau(dt=DT, solver="enumerative"), DT)
    except hys.ArgumentError as refusal:
        words.append(f"50 are refused ({refusal})")
    return f"modes tried from a cold start, by number of contacts {', '.join(words)}"


def inverse_exists() -> str:
    """3.4.1: the matrix H that a mode inverts always exists if all principal minors of A are positive."""
    words = []
    for name, unknowns in (("leine-nijmeijer", 2), ("pfeiffer-glocker", 4)):
        M, _ = friction_lcp(name, np.eye(1), np.zeros(1), -np.ones(1), np.ones(1))
        sets = [np.array(s) for s in product((False, True), repeat=unknowns) if any(s)]
        minors = [np.linalg.det(M[np.ix_(s, s)]) for s in sets]
        words.append(f"{name} {sum(abs(d) < 1e-12 for d in minors)} of {len(minors)} zero")
    return f"principal minors for one contact: {', '.join(words)}"


def last_mode_first() -> str:
    """3.4.1: modes change in few steps, so that the mode of the step before is the one to try first."""
    words = []
    for case in "ab":
        run = dual("LCPTS", case)
        changes = int(np.sum(np.any(np.diff(run.mode_codes, axis=0) != 0, axis=1)))
        words.append(f"case {case} {changes} of {len(run.t) - 1}")
    return f"steps with another mode than the one before: {', '.join(words)}"


def lemke_is_smarter() -> str:
    """3.5: Lemke's algorithm is a better choice than enumeration."""
    words = []
    for decomposition in ("leine-nijmeijer", "pfeiffer-glocker"):
        lemke, all_modes = (
            seconds(lambda s=s, d=decomposition: dual_clutch().simulate(
                START, 2.0, hys.Moreau(theta=None, solver=s, decomposition=d), sample=1.0))
            for s in ("lemke", "enumerative")
        )  # fmt: skip
        words.append(f"{decomposition} {all_modes / lemke:.2f}")
    return f"time of enumeration (last mode first) over that of Lemke's method, Dual-clutch: {', '.join(words)}"


def several_events_in_a_step() -> str:
    """4: time-stepping needs no event detection; several events in one step are no trouble."""
    line = hys.Drivetrain(
        *(hys.Inertia(name, 1) for name in "abc"), hys.Clutch("ab", "a", "b", 6), hys.Clutch("bc", "b", "c", 2)
    )
    run = line.simulate({"a": 10, "b": 0, "c": 0}, 2.0, hys.Moreau(dt=2.0))
    return f"two lock-ups (t = 1 and 5/3) in one step of 2 s: error {np.abs(run.speeds[-1] - 10 / 3).max():.1e} rad/s"


def many_contacts() -> str:
    """4: time-stepping is above all of use with many contacts and events."""
    data = chain(20)
    line = drivetrain(data)
    precise, plain = hys.EventDriven(solver="active-set"), hys.Moreau(dt=DT)
    a, b = (line.simulate(data.start, 0.1, scheme, sample=0.1) for scheme in (precise, plain))
    slow, fast = (seconds(lambda s=s: line.simulate(data.start, 0.1, s, sample=0.1)) for s in (precise, plain))
    off = np.abs(a.speeds[-1] - b.speeds[-1]).max() / np.abs(a.speeds[-1]).max()
    return f"chain of 20, {len(a.events)} events in 0.1 s: {slow / fast:.0f} x faster, {off:.0e} off (relative)"


def order_of(name: str, case: str) -> float:
    """Order of convergence of a method of the comparison."""
    steps = (4e-3, 2e-3, 1e-3, 5e-4)
    exact = dual_clutch(case).simulate(START, UNTIL, hys.Exact(), sample=max(steps))
    errors = []
    for dt in steps:
        run = dual_clutch(case).simulate(START, UNTIL, replace(FIXED[name], dt=dt), sample=max(steps))
        errors.append(mean_error(run, exact))
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def midpoint_scheme() -> str:
    """4.1: the scheme is a midpoint rule, with a trapezoidal rule for the speeds."""
    names = ("LCPTS", "Moreau, inputs in the middle", "Moreau theta=1/2")
    words = [f"{name} {order_of(name, 'a'):.2f} | {order_of(name, 'b'):.2f}" for name in names]
    return f"orders, a | b: {', '.join(words)}"


def same_solution() -> str:
    """4.3: the augmented Lagrangian method solves the same problem as the LCP."""
    base = dual("LCPTS")
    words = [f"tolerance {t:g} {mean_error(base, dual(replace(FIXED['AUGLAGR p=1 tol=1e-4'], tolerance=t))):.0e}"
             for t in (1e-4, 1e-6, 1e-8)]  # fmt: skip
    return f"mean difference, case a: {', '.join(words)} rad/s"


def fixed_point_converges() -> str:
    """4.3: a fixed-point iteration solves it, with any steepness above zero."""
    G = float(np.linalg.eigvalsh(dual_clutch().equations.G)[-1])
    words = []
    for p in (1.0, 10.0, 18.0, 30.0):
        scheme = hys.AugmentedLagrangian(steepness=p, tolerance=1e-4, iterations=2000, theta=None, inputs="start")
        run = dual(scheme)
        words.append(
            f"p = {p:g} {run.info['solves'] / run.info['steps']:.0f} iterations a step, {run.info['failures']} failures"
        )
    return f"2/(dt lambda_max) = {2 / (DT * G):.1f}; case a: {'; '.join(words)}"


def exchange() -> str:
    """6: steepness and tolerance exchange time for accuracy."""
    words = []
    for name in ("AUGLAGR p=1 tol=1e-4", "AUGLAGR p=1 tol=1e-8", "AUGLAGR p=10 tol=1e-4"):
        time = seconds(lambda name=name: dual(name)) / seconds(lambda: dual("LCPTS"))
        words.append(f"{name[8:]} {error(name):.2e}, {time:.1f}")
    return f"mean error (LCPTS {error('LCPTS'):.2e}) and time over LCPTS, case a: {'; '.join(words)}"


def switch_is_fastest() -> str:
    """6, table 6.1: the Switch Model is by far the fastest, event-driven behind it, time-stepping last."""
    base = seconds(lambda: dual("SWITCH"))
    names = ("LCPEV", "LCPTS", "AUGLAGR p=1 tol=1e-4", "AUGLAGR p=10 tol=1e-4", "SIMDRV")
    words = [f"{name} {seconds(lambda name=name: dual(name)) / base:.1f}" for name in names]
    explicit = seconds(lambda: dual(replace(FIXED["LCPTS"], solver="auto"))) / base
    return f"times over SWITCH, all compiled: {', '.join(words)}; LCPTS with an LCP in Python {explicit:.0f}"


def acceleration_level_agrees() -> str:
    """6, H: Switch Model and event-driven method agree to 1e-10."""
    same = mean_error(dual(hys.FixedStepLcp(band=0.1)), dual(hys.SwitchModel(band=0.1, tau=inf, integrator="euler")))
    words = [f"{dt:g} s {mean_error(dual('LCPEV', dt=dt), dual('SWITCH', dt=dt)):.1e}" for dt in (1e-3, 1e-4)]
    return f"same band, not driven {same:.0e}; options of the document at {', at '.join(words)} rad/s"


def accuracy_order() -> str:
    """6, table 6.1: Switch Model and event-driven method are more accurate than time-stepping."""
    words = []
    for name in ("SWITCH", "LCPEV", "LCPTS", "AUGLAGR p=1 tol=1e-4", "SIMDRV"):
        words.append(f"{name} {error(name):.1e} | {error(name, 'b'):.1e}")
    return f"mean errors at 1e-3 s, a | b: {', '.join(words)}"


def distance_is_constant() -> str:
    """H: time-stepping differs from the Switch Model by 1e-1 at both steps."""
    words = [f"{dt:g} s {mean_error(dual('LCPTS', dt=dt), dual('SWITCH', dt=dt)):.1e}" for dt in (1e-3, 1e-4)]
    return f"mean difference, case a: {', '.join(words)}"


def variable_steps() -> str:
    """7.2: variable steps would make time-stepping more efficient."""
    words = []
    for case, dt in (("a", 1e-4), ("b", 2.5e-4)):
        run, fixed = dual(hys.VariableStepMoreau(), case), dual(hys.Moreau(dt=dt), case)
        time = seconds(lambda case=case: dual(hys.VariableStepMoreau(), case)) / seconds(
            lambda case=case, dt=dt: dual(hys.Moreau(dt=dt), case)
        )
        words.append(
            f"case {case} error {mean_error(run, EXACT[case]):.1e} by {run.info['solves']} solves against "
            f"{mean_error(fixed, EXACT[case]):.1e} by {fixed.info['solves']}, time {time:.1f} x"
        )
    return "; ".join(words)


def large_systems() -> str:
    """7.1: time-stepping with LCPs has unsolved problems with large systems."""
    run = on_chain(1000, hys.Moreau(dt=DT))
    outcome = f"residual {run.residuals.max():.0e} rad/s, {run.info['failures']} failures"
    return f"chain of 1000: {outcome}; {growth_line(hys.Moreau(dt=DT))}"


CLAIMS: tuple[Callable[[], str], ...] = (
    stick_slip, smoothing_is_direct, smoothing_is_dear, karnopp_drifts, karnopp_is_unstable, switch_is_not_stiff,
    thin_band, switch_grows_exponentially, events_are_dear, abundant_modes, dimension_costs, enumeration_explodes,
    inverse_exists, last_mode_first, lemke_is_smarter, several_events_in_a_step, many_contacts, midpoint_scheme,
    same_solution, fixed_point_converges, exchange, switch_is_fastest, acceleration_level_agrees, accuracy_order,
    distance_is_constant, variable_steps, large_systems,
)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", help="numbers of claims, with commas")
    options = parser.parse_args()
    chosen = range(1, len(CLAIMS) + 1) if options.only is None else [int(k) for k in options.only.split(",")]
    for k in chosen:
        claim = CLAIMS[k - 1]
        print(f"{k:>2}  {(claim.__doc__ or '').strip()}\n      {claim()}", flush=True)


if __name__ == "__main__":
    main()
