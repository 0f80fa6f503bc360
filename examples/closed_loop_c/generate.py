"""Write plant.c and law.c into a folder: a cart with a limited force, and the explicit law that brings it to rest.

python generate.py FOLDER
"""

import sys
from pathlib import Path

import numpy as np

import hysdel_py as hys
from hysdel_py.geometry.polyhedron import Polyhedron

PLANT = """
SYSTEM cart {
  INTERFACE {
    STATE { REAL position [-10, 10]; /* m */ REAL speed [-5, 5]; /* m/s */ }
    INPUT { REAL force [-1, 1]; /* N */ }
    OUTPUT { BOOL near; }
  }
  IMPLEMENTATION {
    AUX { BOOL left, right; }
    AD { left = position >= -0.1; right = position <= 0.1; }
    CONTINUOUS { position = position + speed + 0.5*force; speed = speed + force; }
    OUTPUT { near = left & right; }
  }
}
"""
STEPS = 5
WEIGHT = 0.1
"""Cost: position^2 + speed^2 + WEIGHT force^2, summed over STEPS."""


def problem() -> hys.MpQp:
    """The predicted states are ``Phi x + Gamma u``; forces are limited."""
    A, B = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([0.5, 1.0])
    power = [np.linalg.matrix_power(A, k) for k in range(STEPS + 1)]
    Phi = np.vstack(power[1:])
    Gamma = np.zeros((2 * STEPS, STEPS))
    for row in range(STEPS):
        for column in range(row + 1):
            Gamma[2 * row : 2 * row + 2, column] = power[row - column] @ B
    eye = np.eye(STEPS)
    return hys.MpQp(
        H=2 * (Gamma.T @ Gamma + WEIGHT * eye),
        f=np.zeros(STEPS),
        F=2 * Gamma.T @ Phi,
        G=np.vstack([eye, -eye]),
        w=np.ones(2 * STEPS),
        S=np.zeros((2 * STEPS, 2)),
        theta=Polyhedron.box([-10, -5], [10, 5]),
    )


def main(folder: Path) -> None:
    """Write both sources with their headers."""
    hys.to_c(hys.load(PLANT), folder / "plant.c")
    law = hys.ExplicitLaw.of(hys.solve_mpqp(problem()), moves=1, names=("position", "speed"))
    law.to_c(folder / "law.c", units=("m", "m/s"), moves=("force [N]",))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
