"""Faults put into Mld or Pwa forms at random: does the verification catch them, without random points?

    python benchmarks/faults.py [--form mld] [--models 40] [--faults 5] [--seed 0] [--points 2000] [--shipped]

A fault may change nothing: a dropped row may be redundant, a constant too large. Where the verification says "equal",
the two forms are stepped at many points, thresholds and corners included; where they differ, a fault was missed.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from seeded_faults import PWA_FAULTS, pwa_fault, random_fault
from strategies import models

import hysdel_py as hys
from hysdel_py.analysis.comparison import Comparison
from hysdel_py.analysis.margins import Margins
from hysdel_py.analysis.points import step_points
from hysdel_py.analysis.pwa_pair import PwaPair
from hysdel_py.analysis.search import Clock


def drawn_texts(count: int, seed: int) -> list[str]:
    """Texts of random models, the same for the same seed."""
    from hypothesis import HealthCheck, Phase, given, settings
    from hypothesis import seed as seeded

    texts: list[str] = []

    @seeded(seed)
    @settings(max_examples=count, database=None, deadline=None, phases=[Phase.generate],
              suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(models())
    def collect(text: str) -> None:
        texts.append(text)

    collect()
    return texts[:count]


def differs_by_brute_force(model: hys.Model, form: hys.Mld | hys.Pwa, points: int, seed: int) -> bool:
    """Whether stepping at many points shows a difference outside the band."""
    is_mld = isinstance(form, hys.Mld)
    mld = form if is_mld else model.mld
    comparison = Comparison(replace(model.dha, x=mld.x), mld, Margins(), Clock())
    compare = None if is_mld else [PwaPair(comparison, form).compare]
    return bool(step_points(comparison, points, seed, compare).different)


def judged(model: hys.Model, form: hys.Mld | hys.Pwa, options: argparse.Namespace) -> str:
    """What the verification made of a form."""
    given = {"mld" if isinstance(form, hys.Mld) else "pwa": form}
    status = hys.verify(model, points=0, **given).status.value
    if status != "equal":
        return {"different": "caught", "not settled": "not settled"}[status]
    missed = differs_by_brute_force(model, form, options.points, options.seed)
    return "MISSED" if missed else "equivalent"


def drawn_fault(form: hys.Mld | hys.Pwa, generator: np.random.Generator) -> tuple[str, hys.Mld | hys.Pwa] | None:
    """A kind of fault and the form with it, None where the kind has no place in it."""
    if isinstance(form, hys.Mld):
        return random_fault(form, generator)
    kind = str(generator.choice(PWA_FAULTS))
    faulty = pwa_fault(form, kind, generator) if form.modes else None
    return None if faulty is None else (kind, faulty)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--form", choices=("mld", "pwa"), default="mld", help="the form that gets the faults")
    parser.add_argument("--models", type=int, default=40, help="random models")
    parser.add_argument("--faults", type=int, default=5, help="faults per model")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--points", type=int, default=2000, help="points of the brute force")
    parser.add_argument("--shipped", action="store_true", help="the shipped models as well, with ten times the faults")
    options = parser.parse_args()
    generator, tally, started = np.random.default_rng(options.seed), Counter(), time.perf_counter()
    sources = [(text, options.faults) for text in drawn_texts(options.models, options.seed)]
    sources += [(name, 10 * options.faults) for name in hys.shipped_models()] if options.shipped else []
    false_alarms = 0
    for source, count in sources:
        model = hys.load(source)
        form = getattr(model, options.form)
        false_alarms += not hys.verify(model, points=0, **{options.form: form}).is_equal
        for _ in range(count):
            fault = drawn_fault(form, generator)
            if fault is not None:
                outcome = judged(model, fault[1], options)
                tally[fault[0], outcome] += 1
                if outcome in ("MISSED", "not settled"):
                    print(outcome, fault[0], "in", source, file=sys.stderr)
    outcomes = ("caught", "equivalent", "not settled", "MISSED")
    print(f"{'fault':18}" + "".join(f"{outcome:>12}" for outcome in outcomes))
    for kind in sorted({kind for kind, _ in tally}):
        print(f"{kind:18}" + "".join(f"{tally[kind, outcome]:12}" for outcome in outcomes))
    print(
        f"{'all':18}" + "".join(f"{sum(n for (_, o), n in tally.items() if o == outcome):12}" for outcome in outcomes)
    )
    print(f"{len(sources)} models without a fault, {false_alarms} of them not found equal")
    print(f"{time.perf_counter() - started:.0f} s")


if __name__ == "__main__":
    main()
