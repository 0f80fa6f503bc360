"""Compile many damaged models: nothing but a CompileError may come out, in bounded time and memory.

    python benchmarks/fuzz.py --inputs 20000 --seed 1

Damage is of two kinds: of the grammar (tokens dropped, doubled, exchanged, taken from another model, phrases of the
newer parts of the language put between items) and of the bytes. One input in ten is a module of a sound model.
Prints how the inputs ended; the exit status is 1 if any broke the rule. `--keep FOLDER` saves those.
"""

from __future__ import annotations

import argparse
import random
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from contextlib import contextmanager
from pathlib import Path

import hysdel_py as hys

ROOT = Path(__file__).parents[1]
TOKEN = re.compile(r"/\*.*?\*/|\s+|[A-Za-z_]\w*|[\d.]+(?:[eE][+-]?\d+)?|<->|->|<-|<=|>=|\|\||&&|.", re.DOTALL)
KEYWORDS = """SYSTEM INTERFACE IMPLEMENTATION STATE INPUT OUTPUT PARAMETER AUX AD DA LOGIC LINEAR CONTINUOUS AUTOMATA
    MUST IF THEN ELSE REAL BOOL TRUE FALSE FOR INDEX MODULE sin log sqrt exp MLD_epsilon pi MLD_bigMbound"""
MARKS = """{ } ( ) [ ] ; , : . = + - * / ^ & | ~ -> <- <-> <= >= 0 1 2 -1 1e308 1e-320 1e999 /* */ // # % . _ < > == x u
    b i n (1) (2) (i) (i+1) (1:2) (1,1) (3) (0) (n) (:) (1,:) (1:2:n) '
    [1;2] [1,2;3,4] x<=1 x==1 real Bool \u2212 \u00e9"""
PHRASES = (
    "FOR (i = 1:2) { x(i) = x(i); }",
    "FOR (i = 1:n) { FOR (j = i:n) { z(i) = A(i, j)*x(j); } }",
    "FOR (i = 1:3) {",
    "FOR (k = 1:1e9) { x <= 1; }",
    "INDEX i, j;",
    "REAL x(2) [0, 1; 2, 3];",
    "REAL A = [1, 2; 3, 4], n = 2;",
    "BOOL on(n);",
    "MODULE { part t; }",
    "MODULE { clutch c, d; two_tanks w; }",
    "d = x <= 1 & (0 < x | ~(x >= 2));",
    "d = on(1:2) & x <= [1; 2];",
    "z = {IF x > 0 THEN {IF b THEN x ELSE 2} ELSE {IF x <= -1 & b THEN 0}};",
    "z = A*x + [1; 2]*u;",
    "-1 <= x <= 1;",
    "x == u + 1;",
    "b -> x >= 0 & u < 1;",
    "y = (REAL x <= 1)*2 + (REAL 0 <= x <= 1);",
    "// dialect: hysdel 3\n",
    "/* dialect: hysdel 2 */",
    "REAL k [0, 2] = 1;",
    "REAL A(2,2) [0, 1; 0, 1; 0, 1; 0, 1];",
    "REAL MLD_bigMbound = 1e4;",
    "y = x(:)'*A'*x;",
    "FOR (i = n:-1:1) { x(i) = x(1:2:i)'*x(2:-1:1); }",
)
"""Of vectors, loops, modules, choices in choices and comparisons in logic; they fit the names of some seeds."""
WHOLE = """SYSTEM whole {
  INTERFACE { MODULE { part p, q; } STATE { REAL x [0, 1]; } }
  IMPLEMENTATION { CONTINUOUS { x = 0.5*x; } }
}
"""
WORDS = (*KEYWORDS.split(), *MARKS.split(), "\x00", "\x0c", "\u2028")


class TimeOverError(Exception):
    """An input took too long."""


def seeds() -> list[str]:
    """Texts of the shipped models, the golden ones, the corpus and the wrong models."""
    tests = ROOT / "tests"
    folders = (ROOT / "models", tests / "golden", tests / "data" / "corpus", tests / "data" / "bad")
    return [path.read_text(encoding="utf-8") for folder in folders for path in sorted(folder.glob("*.hys"))]


def mutated(rng: random.Random, texts: list[str]) -> str | bytes:
    """One damaged text; bytes where the damage is below the level of characters."""
    text = rng.choice(texts)
    if rng.random() < 0.2:
        return damaged_bytes(rng, text.encode())
    tokens = TOKEN.findall(text)
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8, 30))):
        rng.choice((drop, double, swap, replace, insert, phrase, graft, nest, cut))(rng, tokens, texts)
    return "".join(tokens)


def damaged_bytes(rng: random.Random, data: bytes) -> bytes:
    bytes_ = bytearray(data)
    for _ in range(rng.choice((1, 3, 20))):
        place = rng.randrange(len(bytes_) + 1)
        if rng.random() < 0.5:
            bytes_[place:place] = bytes(rng.randrange(256) for _ in range(rng.randrange(1, 4)))
        else:
            del bytes_[place : place + rng.randrange(1, 40)]
    return bytes(bytes_)


def spot(rng: random.Random, tokens: list[str]) -> int:
    return rng.randrange(len(tokens) or 1)


def drop(rng, tokens, _texts):
    place = spot(rng, tokens)
    del tokens[place : place + rng.choice((1, 1, 1, 2, 20))]


def double(rng, tokens, _texts):
    place = spot(rng, tokens)
    tokens[place:place] = tokens[place : place + rng.choice((1, 3, 30))]


def swap(rng, tokens, _texts):
    if tokens:
        i, j = spot(rng, tokens), spot(rng, tokens)
        tokens[i], tokens[j] = tokens[j], tokens[i]


def replace(rng, tokens, _texts):
    if tokens:
        tokens[spot(rng, tokens)] = rng.choice(WORDS)


def insert(rng, tokens, _texts):
    tokens.insert(spot(rng, tokens), f" {rng.choice(WORDS)} ")


def phrase(rng, tokens, _texts):
    """Put a phrase where an item or a declaration may begin."""
    places = [place for place, token in enumerate(tokens, start=1) if token in (";", "{", "}")]
    if places:
        tokens.insert(rng.choice(places), f" {rng.choice(PHRASES)} ")


def graft(rng, tokens, texts):
    other = TOKEN.findall(rng.choice(texts))
    start, place = rng.randrange(len(other)), spot(rng, tokens)
    tokens[place:place] = other[start : start + rng.randrange(1, 60)]


def nest(rng, tokens, _texts):
    mark, depth = rng.choice(("(", "~", "-", "{", "[", "x & (", "(REAL ", "/*")), rng.choice((2, 50, 3000))
    tokens.insert(spot(rng, tokens), mark * depth)


def cut(rng, tokens, _texts):
    if rng.random() < 0.2:
        del tokens[spot(rng, tokens) :]


@contextmanager
def time_limit(seconds: float):
    """Raise TimeOverError inside the block when it takes too much processor time."""

    def stop(_signal, _frame):
        raise TimeOverError

    old = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, old)


def outcome(text: str | bytes, path: Path, seconds: float) -> str:
    """How one input ends: accepted, refused, or what went wrong; `part.hys` is loaded as a module of `whole.hys`."""
    path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass"))
    try:
        with time_limit(seconds):
            model = hys.load(path.with_name("whole.hys") if path.stem == "part" else path)
            _ = model.mld
    except hys.CompileError as error:
        return "refused" if error.diagnostics and str(error) else "FAULT: empty CompileError"
    except TimeOverError:
        return f"FAULT: more than {seconds:g} s"
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        return f"FAULT: {type(error).__name__} in {Path(place.filename).name}:{place.lineno}"
    return "accepted"


def lay_out_modules(folder: Path) -> None:
    """The files that a model may name as modules; `part.hys` is the one that is damaged."""
    for path in (ROOT / "models").glob("*.hys"):
        shutil.copy(path, folder / path.name)
    shutil.copy(ROOT / "models" / "two_tanks.hys", folder / "part.hys")
    (folder / "whole.hys").write_text(WHOLE, encoding="utf-8")


def run(inputs: int, seed: int, seconds: float, keep: Path | None = None) -> Counter[str]:
    """Counts of the outcomes of a number of inputs."""
    rng, texts, counts = random.Random(seed), seeds(), Counter()
    with tempfile.TemporaryDirectory() as folder:
        lay_out_modules(Path(folder))
        for number in range(inputs):
            text = mutated(rng, texts)
            path = Path(folder) / rng.choice(("part.hys", *("fuzz.hys",) * 9))
            result = outcome(text, path, seconds)
            counts[result] += 1
            if keep is not None and result.startswith("FAULT"):
                shutil.copy(path, keep / f"{seed}_{number}_{path.name}")

    return counts


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--inputs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=10.0, help="limit for one input")
    parser.add_argument("--memory", type=int, default=2000, help="limit of the process in MB")
    parser.add_argument("--keep", type=Path, help="folder for inputs that break the rule")
    options = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (options.memory * 1_000_000, options.memory * 1_000_000))
    if options.keep is not None:
        options.keep.mkdir(parents=True, exist_ok=True)
    start = time.perf_counter()
    counts = run(options.inputs, options.seed, options.seconds, options.keep)
    for result, count in counts.most_common():
        print(f"{count:8d}  {result}")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1000
    print(f"{options.inputs} inputs, seed {options.seed}, {time.perf_counter() - start:.0f} s, peak {peak} MB")
    return int(any(result.startswith("FAULT") for result in counts))


if __name__ == "__main__":
    sys.exit(main())
