"""Octave reads the written files: the matrices are the original's, and the simulators give its samples."""

import shutil
import subprocess

import numpy as np
import pytest
from export.models import ACCEPTED, NAMES
from export.test_matlab import EXAMPLE, PLAIN, check_against_original

import hysdel_py as hys
from hysdel_py.export.compiled import compile_model
from hysdel_py.export.matlab import matlab_text
from hysdel_py.export.simulator_matlab import function_name, simulator_text
from hysdel_py.lowering.constants import Constants

OCTAVE = shutil.which("octave-cli")
pytestmark = pytest.mark.skipif(OCTAVE is None, reason="octave is not installed")
# A simulator is called at each point and leaves one row per call: 1 and the results, or 0 and the message.
CALLS = """
r = cell(1, {count});
for k = 1:{count}
  try
    [xn, d, z, y] = {name}(X(:, k), U(:, k), params);
    r{{k}} = [1; xn; d; z; y];
  catch e
    r{{k}} = e.message;
  end
end
"""


def octave(folder, script):
    (folder / "all_tests.m").write_text(script)
    command = [OCTAVE, "--norc", "--no-gui", "--quiet", "all_tests.m"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr[-3000:]


def loaded(path):
    from scipy.io import loadmat

    return loadmat(path, squeeze_me=False)


def plain(value):
    """Structs and cells of a MATLAB file as dictionaries, like those of the reader of the tests."""
    if value.dtype.names:
        return {name: plain(value[name][0, 0]) for name in value.dtype.names}
    if value.dtype == object:
        return {i: plain(entry) for i, entry in enumerate(value.ravel(), start=1)}
    if value.dtype.kind == "U":
        return str(value.ravel()[0]) if value.size else ""
    return value.item() if value.shape == (1, 1) else value


def with_matrices(data):
    """Entries that the comparison indexes are arrays even if they hold a single number."""
    sizes = ("MLDisvalid", "ne", "name", "rowinfo", "symtable")
    keep = {k for k in data if k.startswith(("n", "MLD")) or k in sizes}
    return {key: value if key in keep else np.atleast_2d(value) for key, value in data.items()}


def parameters_line(values):
    return "params = struct(); " + " ".join(f"params.{name} = {value!r};" for name, value in values.items())


@pytest.fixture(scope="module")
def scripts(tmp_path_factory):
    """The struct of every model, with numbers and over parameters, from one run of Octave."""
    folder = tmp_path_factory.mktemp("octave")
    script = ["1;"]
    for accepted, name in zip(ACCEPTED, NAMES, strict=True):
        for kind, every in (("plain", False), ("open", True)):
            (folder / f"{name}_{kind}.m").write_text(matlab_text(accepted.compiled(every=every), PLAIN))
            script += ["clear S;", parameters_line(accepted.model().parameters)]
            script += [f"source('{name}_{kind}.m');", f"save('-v6', '{name}_{kind}.mat', 'S');"]
    octave(folder, "\n".join(script))
    return folder


@pytest.mark.parametrize("kind", ["plain", "open"])
@pytest.mark.parametrize("accepted", ACCEPTED, ids=NAMES)
def test_octave_reads_what_the_original_wrote(scripts, accepted, kind):
    data = with_matrices(plain(loaded(scripts / f"{accepted.path.stem}_{kind}.mat")["S"]))
    check_against_original(data, accepted.expected)


SIMULATED = [model for model in ACCEPTED if model.expected["simulator_ok"] and model.expected["samples"]]


@pytest.fixture(scope="module")
def simulations(tmp_path_factory):
    """The simulator of every model at the samples of the original, from one run of Octave."""
    folder = tmp_path_factory.mktemp("octave")
    script = ["1;"]
    for accepted in SIMULATED:
        name, samples = function_name("sim_" + accepted.path.stem), accepted.expected["samples"]
        (folder / f"{name}.m").write_text(simulator_text(accepted.compiled(every=True), name, PLAIN))
        for key in ("x", "u"):
            columns = np.array([s[key] for s in samples], dtype=float).reshape(len(samples), -1).T
            rows = "; ".join(" ".join(map(repr, row)) for row in columns.tolist())
            script.append(f"{key.upper()} = reshape([{rows}], {columns.shape[0]}, {columns.shape[1]});")
        script += [parameters_line(accepted.model().parameters), CALLS.format(count=len(samples), name=name)]
        script.append(f"save('-v6', '{name}.mat', 'r');")
    octave(folder, "\n".join(script))
    return folder


@pytest.mark.parametrize("accepted", SIMULATED, ids=[model.path.stem for model in SIMULATED])
def test_simulator_gives_the_samples(simulations, accepted):
    results = loaded(simulations / f"{function_name('sim_' + accepted.path.stem)}.mat")["r"].ravel()
    for result, sample in zip(results, accepted.expected["samples"], strict=True):
        if sample["feasible"]:
            expected = np.concatenate(
                [[1.0], *(np.array(sample[key] or [], dtype=float) for key in ("xn", "d", "z", "y"))]
            )
            assert result.dtype.kind != "U", str(result)
            np.testing.assert_allclose(result.ravel(), expected, rtol=1e-9, atol=1e-8)
        else:
            assert result.dtype.kind == "U"


def test_missing_parameters_stop_both_files(tmp_path):
    model = hys.load(EXAMPLE)
    compiled, _ = compile_model(model.typed, model.parameters, Constants.AFFINE)
    (tmp_path / "mld_file.m").write_text(matlab_text(compiled, PLAIN))
    (tmp_path / "sim_file.m").write_text(simulator_text(compiled, "sim_file", PLAIN))
    octave(
        tmp_path,
        """1;
        m = {};
        try, source('mld_file.m'); catch e, m{end + 1} = e.message; end
        params = struct('other', 1);
        try, source('mld_file.m'); catch e, m{end + 1} = e.message; end
        try, sim_file([0; 0], 0, params); catch e, m{end + 1} = e.message; end
        params.k = 1;
        try, sim_file([9; 0.5], 0, params); catch e, m{end + 1} = e.message; end
        try, sim_file(1, 0, params); catch e, m{end + 1} = e.message; end
        save('-v6', 'm.mat', 'm');
        """,
    )
    messages = [str(m.ravel()[0]) for m in loaded(tmp_path / "m.mat")["m"].ravel()]
    assert len(messages) == 5
    assert "the struct params" in messages[0]
    assert "params.k is missing" in messages[1]
    assert "params.k is missing" in messages[2]
    assert "state x = 9 is outside its range (declared in line 3)" in messages[3]
    assert "state b = 0.5" in messages[3]
    assert "must have 2 entries" in messages[4]
