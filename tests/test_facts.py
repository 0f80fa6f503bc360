"""Problems with answers of other toolboxes; ``run_facts.py`` says which folder of them it is given."""

import json
from pathlib import Path

import numpy as np
import pytest
import run_facts
from fact_hybrid_laws import sampled_law

FOLDER = Path(__file__).parent / "data" / "facts"
FACTS = {fact["id"]: fact for fact in run_facts.read_facts(FOLDER, None)}
SAMPLES = 3
"""States per fact in this test; the program compares all."""
SLOW = {"pympc_hybrid_pendulum"}
"""Left to the program: twenty steps with two modes, to a gap of 1e-9."""


def shortened(fact):
    expected = dict(fact["expected"])
    if "samples" in expected:
        feasible = sorted(expected["samples"], key=lambda sample: not sample["feasible"])
        expected["samples"] = [*feasible[: SAMPLES - 1], feasible[-1]]
    return {**fact, "expected": expected}


@pytest.mark.parametrize("name", sorted(set(FACTS) - SLOW))
def test_fact(name):
    assert run_facts.verdict(shortened(FACTS[name]))[0] == "passed"


@pytest.mark.parametrize("name", ["hmpc_pwa_car_n2_N1", "hmpc_pwa_sincos_n1_N2", "hmpc_two_tanks_nInf_N1"])
def test_costs_by_the_explicit_law(name):
    assert run_facts.verdict(FACTS[name], sampled_law)[0] == "passed"


def test_a_wrong_cost_fails_by_the_explicit_law():
    fact = json.loads(json.dumps(FACTS["hmpc_pwa_sincos_n1_N2"]))
    fact["expected"]["samples"][0]["J"] += 1e-3
    assert run_facts.verdict(fact, sampled_law)[0] == "failed"


def test_every_fact_names_its_source():
    assert len(FACTS) == 78
    assert all(fact["source"] for fact in FACTS.values())


@pytest.mark.parametrize("name", ["hmpc_two_tanks_n1_N1", "pympc_lp_box"])
def test_a_wrong_number_fails(name):
    fact = json.loads(json.dumps(shortened(FACTS[name])))
    first = fact["expected"]["samples"][0] if "samples" in fact["expected"] else fact["expected"]
    key = "J" if "J" in first else "obj"
    first[key] += 1e-3
    word, line = run_facts.verdict(fact)
    assert word == "failed"
    assert "difference" in line


def test_infeasibility_is_compared():
    fact = json.loads(json.dumps(FACTS["hmpc_pwa_car_n2_N1"]))
    samples = fact["expected"]["samples"]
    infeasible = next(sample for sample in samples if not sample["feasible"])
    infeasible.update(feasible=True, J=1.0)
    fact["expected"]["samples"] = [infeasible]
    assert run_facts.verdict(fact)[0] == "failed"


def test_program_prints_a_line_per_fact_and_counts(tmp_path, capsys):
    for name in ("pympc_lp_box", "pympc_qp_eq"):
        (tmp_path / f"{name}.json").write_text((FOLDER / f"{name}.json").read_text())
    unknown = {"id": "odd", "kind": "nothing", "problem": {}, "expected": {}, "tolerance": 1}
    (tmp_path / "odd.json").write_text(json.dumps(unknown))
    assert run_facts.main([str(tmp_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "odd: not yet supported (facts of the kind nothing)"
    assert lines[-1] == "2 passed, 0 failed, 1 skipped"
    broken = json.loads((tmp_path / "pympc_lp_box.json").read_text())
    broken["expected"]["obj"] = np.pi
    (tmp_path / "pympc_lp_box.json").write_text(json.dumps(broken))
    assert run_facts.main([str(tmp_path), "--kind", "lp"]) == 1
    assert capsys.readouterr().out.splitlines()[-1] == "0 passed, 1 failed, 0 skipped"
