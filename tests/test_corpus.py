"""The models of the corpus, with the verdicts, matrices and samples of the original compiler."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import run_corpus

CORPUS = Path(__file__).parent / "data" / "corpus"
PROGRAM = Path(__file__).parent / "run_corpus.py"
MODELS = sorted(CORPUS.glob("*.hys"))


def run(folder):
    return subprocess.run([sys.executable, PROGRAM, folder], capture_output=True, text=True, check=False)


def test_the_corpus_is_complete():
    assert len(MODELS) == 64
    assert all(path.with_suffix(".json").is_file() for path in MODELS)


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_model(path):
    run_corpus.check_pair(path)


def test_program_passes():
    result = run(CORPUS)
    assert result.returncode == 0, result.stdout
    assert result.stdout.endswith("64 passed, 0 failed\n")


@pytest.mark.parametrize("arguments", [[], ["no such folder"], [CORPUS, CORPUS]])
def test_wrong_usage(arguments):
    result = subprocess.run([sys.executable, PROGRAM, *arguments], capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert "usage" in result.stderr


def change_entry(data):
    data["A"][0][0] += 1e-6


def change_row(data):
    data["E2"][3][0] *= 1.001


def change_constant(data):
    data["E5"][0][0] += 1e-3


def drop_row(data):
    for key in ("E1", "E2", "E3", "E4", "E5", "rows"):
        del data[key][-1]
    data["nE"] -= 1


def flip_verdict(data):
    data["accepted"] = not data["accepted"]
    data["error_gist"] = "doctored"


def change_sample(data):
    sample = next(s for s in data["samples"] if s["feasible"])
    sample["xn"][0] += 1e-6


def flip_feasibility(data):
    data["samples"][0]["feasible"] = not data["samples"][0]["feasible"]


def rename_auxiliary(data):
    data["names"]["z"][0] += "_"


def change_line(data):
    data["rows"][0]["line"] += 1


def change_bound(data):
    data["bounds"]["xu"]["1"] += 1


@pytest.mark.parametrize(
    "doctor",
    [
        change_entry, change_row, change_constant, drop_row, flip_verdict, change_sample, flip_feasibility,
        rename_auxiliary, change_line, change_bound,
    ],
)  # fmt: skip
def test_doctored_expectation_fails(doctor, tmp_path, capsys):
    shutil.copy(CORPUS / "a12_da_condition.hys", tmp_path)
    data = json.loads((CORPUS / "a12_da_condition.json").read_text())
    doctor(data)
    (tmp_path / "a12_da_condition.json").write_text(json.dumps(data))
    assert run_corpus.main([str(tmp_path)]) == 1
    printed = capsys.readouterr().out
    assert printed.startswith("FAIL  a12_da_condition")
    assert printed.endswith("0 passed, 1 failed\n")


def test_flipped_verdict_of_a_refused_model_fails(tmp_path):
    shutil.copy(CORPUS / "r05_product.hys", tmp_path)
    data = json.loads((CORPUS / "r05_product.json").read_text())
    flip_verdict(data)
    (tmp_path / "r05_product.json").write_text(json.dumps(data))
    assert run(tmp_path).returncode == 1
