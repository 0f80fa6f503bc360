"""The kernels give the same numbers as compiled code and as plain Python."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

CODE = """
import json
import hysdel_py as hys
from hysdel_py.drivetrain.dual_clutch import START, dual_clutch
plant = dual_clutch("b")
schemes = (hys.Moreau(dt=5e-3), hys.AugmentedLagrangian(dt=5e-3), hys.WaitState(dt=5e-3), hys.SwitchModel(dt=5e-3))
start = START | {"engine": 151.0}
print(json.dumps([plant.simulate(start, 0.2, scheme).speeds[-1].tolist() for scheme in schemes]))
"""


def answer(**environment):
    done = subprocess.run(
        [sys.executable, "-c", CODE], capture_output=True, text=True, check=True, cwd=Path(__file__).parents[2],
        env=os.environ | environment,
    )  # fmt: skip
    return json.loads(done.stdout)


def test_compiled_and_plain_kernels_agree():
    np.testing.assert_allclose(answer(NUMBA_DISABLE_JIT="1"), answer(), rtol=1e-12)
