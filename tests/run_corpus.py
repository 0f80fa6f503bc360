"""Check the compiler against a folder of models with the verdict, matrices and samples of the original compiler.

    python tests/run_corpus.py FOLDER

FOLDER holds pairs NAME.hys and NAME.json. One line is printed per model, then ``N passed, M failed``; the exit status
is 1 if any model failed.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

import hysdel_py as hys
from hysdel_py.diagnostics.codes import Code

TOLERANCE = 1e-9
CONSTANTS = {"-5": "affine", "-a": "aux", "": "forbid"}


def check_pair(path: Path) -> str:
    """Verdict on one model: a line of praise; an AssertionError carries the blame."""
    expected = json.loads(path.with_suffix(".json").read_text())
    given = expected.get("param_values") or {}
    flags = expected.get("flags") or ""
    constants = next((value for flag, value in CONSTANTS.items() if flag and flag in flags), "forbid")
    try:
        model = hys.load(path, **given)
        mld = hys.to_mld(model, big_m="interval", constants=constants)
        dha = hys.to_dha(model, constants=constants)
    except hys.CompileError as error:
        assert not expected["accepted"], f"refused, the original accepts it\n{error}"  # noqa: PT017 -- a verdict
        return "refused, like the original"
    if not expected["accepted"]:
        reasons = extensions(model, constants)
        assert reasons, f"accepted, the original refuses it: {expected['error_gist']}"
        return f"accepted beyond the original: {'; '.join(reasons)}"
    if expected.get("divergence"):
        points = compare_forms(dha, mld)
        return f"accepted; the original is wrong here, not compared; Dha = Mld at {points} random points"
    compare_sizes(mld, expected)
    compare_matrices(mld, expected)
    compare_rows(mld, expected)
    compare_bounds(mld, expected.get("bounds") or {})
    samples = compare_samples(dha, mld, expected)
    return f"{mld.ne} rows, {samples} samples"


def extensions(model: hys.Model, constants: str) -> list[str]:
    from hysdel_py import compiler
    from hysdel_py.lowering.constants import Constants

    _, lowered = compiler.lower_to_dha(model.typed, model.parameters, Constants(constants))
    return sorted({d.message for d in (*model.diagnostics, *lowered) if d.code is Code.EXTENSION})


def compare_sizes(mld: hys.Mld, expected: dict[str, Any]) -> None:
    for key, variables in (("x", mld.x), ("u", mld.u), ("y", mld.y), ("d", mld.d), ("z", mld.z)):
        names = [v.name for v in variables]
        assert names == expected["names"][key], f"{key} is {names}, expected {expected['names'][key]}"
    assert mld.ne == expected["nE"], f"{mld.ne} rows, expected {expected['nE']}"


def compare_matrices(mld: hys.Mld, expected: dict[str, Any]) -> None:
    for key in ("A", "B1", "B2", "B3", "C", "D1", "D2", "D3", "B5", "D5"):
        ours = np.asarray(getattr(mld, key), dtype=float)
        if expected.get(key) is None:
            assert not ours.any(), f"{key} is not zero"
            continue
        theirs = as_array(expected[key], ours.shape)
        assert np.allclose(ours, theirs, rtol=TOLERANCE, atol=TOLERANCE), f"{key} is\n{ours}\nexpected\n{theirs}"


def compare_rows(mld: hys.Mld, expected: dict[str, Any]) -> None:
    ours = np.hstack([E.toarray() for E in (mld.E1, mld.E2, mld.E3, mld.E4)] + [mld.E5[:, None]])
    widths = (mld.nu, mld.nd, mld.nz, mld.nx, 1)
    theirs = np.hstack([as_array(expected[f"E{i}"], (mld.ne, width)) for i, width in enumerate(widths, start=1)])
    left = list(range(len(theirs)))
    for index, row in enumerate(ours):
        match = next((k for k in left if np.allclose(row, theirs[k], rtol=TOLERANCE, atol=TOLERANCE)), None)
        assert match is not None, f"row {index} ({mld.rows[index]}) is not among the expected ones: {row}"
        left.remove(match)
        compare_line(mld.rows[index], expected["rows"][match] if expected.get("rows") else {})


def compare_line(ours: Any, theirs: dict[str, Any]) -> None:
    """Source lines agree; for an item that starts with an operator or parenthesis the original is one line off."""
    line = theirs.get("line")
    if line is not None and ours.text[:1].isalnum():
        assert line == ours.line, f"a row of line {ours.line} ({ours.text}) is of line {line} in the original"


def compare_bounds(mld: hys.Mld, expected: dict[str, Any]) -> None:
    """Ranges of variables where the original states one; for auxiliaries it does so only where it needed them."""
    for letter, variables in (("x", mld.x), ("u", mld.u), ("d", mld.d), ("z", mld.z)):
        for end, attribute in (("l", "low"), ("u", "high")):
            for index, theirs in expected.get(letter + end, {}).items():
                ours = getattr(variables[int(index) - 1], attribute)
                wrong = f"{letter}{end}[{index}] is {ours}, expected {theirs}"
                assert np.isclose(ours, theirs, rtol=TOLERANCE, atol=TOLERANCE), wrong


def as_array(rows: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Array of a known shape; a matrix with no rows or no columns may be given as an empty list in any form."""
    array = np.array([] if rows is None else rows, dtype=float)
    if 0 in shape:
        assert array.size == 0, f"{array.tolist()} was expected to be empty"
        return np.zeros(shape)
    return array.reshape(shape)


def compare_samples(dha: hys.Dha, mld: hys.Mld, expected: dict[str, Any]) -> int:
    for sample in expected.get("samples") or []:
        for form in (dha, mld):
            try:
                result = form.step(sample["x"], sample["u"])
            except hys.SimulationError as error:
                assert not sample["feasible"], f"{type(form).__name__} refuses {sample}: {error}"  # noqa: PT017 -- a verdict
                continue
            assert sample["feasible"], f"{type(form).__name__} accepts the infeasible sample {sample}"
            for ours, key in zip(result, ("xn", "y", "d", "z"), strict=True):
                theirs = as_array(sample[key], ours.shape)
                wrong = f"{type(form).__name__} gives {key} = {ours} at {sample}"
                assert np.allclose(ours, theirs, rtol=TOLERANCE, atol=10 * TOLERANCE), wrong
    return len(expected.get("samples") or [])


def compare_forms(dha: hys.Dha, mld: hys.Mld, count: int = 50) -> int:
    """Step both forms at random points of the declared ranges."""
    generator = np.random.default_rng(0)
    for _ in range(count):
        x, u = (np.array([draw(v, generator) for v in group]) for group in (mld.x, mld.u))
        try:
            pairs = list(zip(dha.step(x, u), mld.step(x, u), strict=True))
        except hys.SimulationError:
            continue  # a requirement, or a value that nothing defines
        for ours, theirs in pairs:
            assert np.allclose(ours, theirs, atol=1e-8), f"Dha and Mld differ at x = {x}, u = {u}"
    return count


def draw(variable: Any, generator: np.random.Generator) -> float:
    if variable.is_bool:
        return float(generator.integers(2))
    return generator.uniform(max(variable.low, -1e3), min(variable.high, 1e3))


def main(arguments: list[str]) -> int:
    if len(arguments) != 1 or not Path(arguments[0]).is_dir():
        print("usage: python tests/run_corpus.py FOLDER", file=sys.stderr)
        return 2
    passed = failed = 0
    for path in sorted(Path(arguments[0]).glob("*.hys")):
        try:
            print(f"ok    {path.stem}: {check_pair(path)}")
            passed += 1
        except Exception as error:  # one bad model must not hide the others
            text = str(error) if isinstance(error, AssertionError) else f"{type(error).__name__}: {error}"
            print(f"FAIL  {path.stem}: {text}")
            failed += 1
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
