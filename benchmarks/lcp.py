"""Success by kind of problem and time by size of the methods for linear complementarity problems."""

from __future__ import annotations

import argparse
from collections import Counter
from time import perf_counter

import numpy as np
from scipy.sparse import diags_array

from hysdel_py.optimize.lcp.solve import solve_boxed_lcp, solve_lcp

METHODS = ("enumerative", "lemke", "pgs", "newton", "auto")


def matrices(rng, n):
    root = rng.normal(size=(n, n))
    thin = root[:, : (n + 1) // 2]
    return {
        "positive definite": root @ root.T + 0.01 * np.eye(n),
        "semidefinite, singular": thin @ thin.T,
        "monotone, not symmetric": root @ root.T + 5 * (root - root.T),
        "any": root,
    }


def success(count: int) -> None:
    print("| matrix | " + " | ".join(METHODS) + " |\n|---|" + "---|" * len(METHODS))
    for kind in matrices(np.random.default_rng(0), 1):
        cells = []
        for method in METHODS:
            found = Counter()
            for seed in range(count):
                rng = np.random.default_rng(seed)
                n = int(rng.integers(1, 7))
                answer = solve_lcp(matrices(rng, n)[kind], 1e-7 * rng.normal(size=n), method)
                found[answer.status.value] += 1
            cells.append(", ".join(f"{found[key]} {key}" for key in sorted(found, reverse=True)))
        print(f"| {kind} | " + " | ".join(cells) + " |")


def chain(n: int, share: float):
    """A chain of unit masses with friction between neighbours; `share` scales the friction limits."""
    e = np.ones(n)
    G = diags_array([2 * e, -e[1:], -e[1:]], offsets=[0, 1, -1]).tocsr()
    return G, np.random.default_rng(0).normal(size=n), np.full(n, share)


def times(repeats: int) -> None:
    print("\n| contacts | limits | newton, banded | pgs | lemke | (ms; sweeps of pgs) |\n|---|---|---|---|---|---|")
    for n in (2, 10, 100, 1000):
        for share in (0.3, 3.0):
            G, c, limit = chain(n, share)
            row, sweeps = [], 0
            for method in ("newton", "pgs", "lemke"):
                if (method == "lemke" and n > 100) or (method == "pgs" and n > 100 and share > 1):
                    row.append("-")
                    continue
                solve_boxed_lcp(G, c, -limit, limit, method)
                best = np.inf
                for _ in range(repeats):
                    begin = perf_counter()
                    answer = solve_boxed_lcp(G, c, -limit, limit, method)
                    best = min(best, perf_counter() - begin)
                sweeps = answer.iterations if method == "pgs" else sweeps
                row.append(f"{1e3 * best:.2f}" + ("" if answer.solved else f" ({answer.status.value})"))
            print(f"| {n} | {share} | " + " | ".join(row) + f" | {sweeps} |")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100, help="problems of each kind")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    success(options.count)
    times(options.repeats)
