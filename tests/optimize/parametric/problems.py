"""Multi-parametric problems of the tests: benchmark files, facts from other toolboxes, random ones."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from hysdel_py.geometry.polyhedron import Polyhedron
from hysdel_py.optimize.mpqp import MpQp

DATA = Path(__file__).parents[2] / "data" / "mpqp"
FACTS = json.loads((DATA / "facts.json").read_text(encoding="utf-8"))
EXPECTED = json.loads((DATA / "expected.json").read_text(encoding="utf-8"))


def benchmark(name):
    """A benchmark problem and its number of moves."""
    data = np.load(DATA / f"{name}.npz")
    theta = Polyhedron.box(data["lb"], data["ub"])
    fields = (data[key] for key in ("H", "f", "F_theta", "G", "w", "S"))
    return MpQp(*fields, theta), int(data["nu"])


def fact(name):
    """A problem published by another toolbox."""
    data = FACTS[name]
    G = np.array(data["G"])
    n, p = G.shape[1], len(data["xA"][0])
    H, f, F = (np.array(data.get(key, blank)) for key, blank in
               (("H", np.zeros((n, n))), ("f", np.zeros(n)), ("F", np.zeros((n, p)))))  # fmt: skip
    theta = Polyhedron(np.array(data["xA"]), np.array(data["xb"]))
    return MpQp(H, f, F, G, np.array(data["W"]), np.array(data["E"]), theta, Y=data.get("Y"))


def boxed(H, F, G, w, S=None, size=3.0, f=None, **more):
    """A problem over a box of parameters."""
    F, G = np.array(F, dtype=float), np.array(G, dtype=float)
    n, p = F.shape
    S = np.zeros((len(G), p)) if S is None else np.array(S, dtype=float)
    theta = Polyhedron.box([-size] * p, [size] * p)
    f = np.zeros(n) if f is None else np.array(f, dtype=float)
    return MpQp(np.array(H, dtype=float), f, F, G, np.array(w, dtype=float), S, theta, **more)


def of_small_integers(seed, kind):
    """A random problem full of coincidences: equal angles, rows through common points, vanishing costs."""
    rng = np.random.default_rng(seed)
    n, p = int(rng.integers(1, 4)), int(rng.integers(1, 4))
    m = int(rng.integers(n, 7 + n))
    L = rng.integers(-1, 2, (n, n))
    H = {"definite": np.eye(n) + L @ L.T, "semidefinite": np.diag([1.0] * (n - 1) + [0.0]), "linear": np.zeros((n, n))}
    G = np.vstack([rng.integers(-1, 2, (m, n)), np.eye(n), -np.eye(n)])
    S = np.vstack([rng.integers(-1, 2, (m, p)), np.zeros((2 * n, p))])
    w = np.concatenate([rng.integers(0, 3, m), np.full(2 * n, 3)])
    return boxed(H[kind], rng.integers(-2, 3, (n, p)), G, w, S, size=2.0, f=rng.integers(-1, 2, n))


def of_random_numbers(seed, n=3, p=2, m=6):
    """A random problem without coincidences."""
    rng = np.random.default_rng(seed)
    L = rng.normal(size=(n, n))
    H = L @ L.T + 0.5 * np.eye(n)
    return boxed(H, rng.normal(size=(n, p)), rng.normal(size=(m, n)), rng.uniform(0.5, 1.5, m), rng.normal(size=(m, p)))
