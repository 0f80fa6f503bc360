"""How long it takes to say why the clutch has no input: ``python benchmarks/explain_clutch.py``.

Two states: the one at which the loop with hard limits ends (``hysdel demo clutch --hard``), where the engine speed of
the next step is settled already, and one from which the torque rates are what is missing.
"""

from __future__ import annotations

import hysdel_py as hys
from hysdel_py.demos.clutch import clutch_controller, engage

HORIZONS = (5, 10, 20)
CLOSING_TOO_FAST = (86.0, 50.0, 10.0, 70.0, 0.0)


def main() -> None:
    """Print one line per state and horizon."""
    model = hys.load("clutch", we_min=60)
    states = {"end of the loop": engage(hard=True).trajectory.x[-1], "closing too fast": CLOSING_TOO_FAST}
    print(f"{'state':18} {'N':>3} {'verdict':>12} {'members':>8} {'ends':>5} {'searches':>9} {'seconds':>8}")
    for name, state in states.items():
        for horizon in HORIZONS:
            found = hys.explain_infeasible(clutch_controller(model, horizon, hard=True), state, seconds=600.0)
            f = found.finding
            print(
                f"{name:18} {horizon:3} {found.verdict:>12} {len(f.members):8} {len(f.ends):5} {f.calls:9} "
                f"{f.seconds:8.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
