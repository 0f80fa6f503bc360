"""What all tests share: their folder on the path, and how hypothesis draws its examples."""

import os
import sys
from pathlib import Path

from hypothesis import settings

sys.path.insert(0, str(Path(__file__).parent))

# Where a run decides over a change, it draws the same examples each time; by hand each run draws new ones.
# No example has a deadline: a slow moment of a busy machine is no fault.
settings.register_profile("gate", derandomize=True, deadline=None)
settings.register_profile("by hand", deadline=None)
settings.load_profile("gate" if os.environ.get("CI") else "by hand")


def pytest_configure(config):
    """Compile the kernels once, before workers that would all compile them at the same time."""
    if getattr(config.option, "numprocesses", None) and not hasattr(config, "workerinput"):
        compile_kernels()


def compile_kernels():
    """The kernels of the controllers and of the multi-parametric programs; the cache keeps them for all processes."""
    import numpy as np

    import hysdel_py as hys

    hys.warm_up()
    side = hys.Polyhedron.box([-1.0], [1.0])
    hys.solve_mpqp(hys.MpQp(np.eye(1), np.zeros(1), np.eye(1), np.eye(1), np.full(1, 0.5), np.zeros((1, 1)), side))
