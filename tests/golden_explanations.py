"""Texts of explanations; ``python tests/golden_explanations.py`` writes tests/golden/explain_infeasible.txt anew."""

from __future__ import annotations

from pathlib import Path

import hysdel_py as hys

GOLDEN = Path(__file__).parent / "golden" / "explain_infeasible.txt"

TANK = """SYSTEM tank {
  INTERFACE {
    STATE { REAL level [0, 10]; BOOL alarm; }
    INPUT { REAL flow [0, 1]; BOOL open; }
    OUTPUT { REAL y; }
  }
  IMPLEMENTATION {
    AUX { REAL out; BOOL high; }
    AD { high = level >= 8; }
    DA { out = {IF open THEN 0.5 ELSE 0.25}; }
    CONTINUOUS { level = level + flow - out; }
    AUTOMATA { alarm = high | alarm; }
    OUTPUT { y = level; }
    MUST {
      open -> ~alarm;
      level <= 9;
    }
  }
}
"""


def explanation_texts() -> str:
    """One explanation after the other."""
    tank = hys.load(TANK)
    limits = hys.Limits(y={"y": (4.0, None)}, x={"level": (None, 9.5)})
    cases = [
        hys.explain_infeasible(tank, {"level": 8.5, "alarm": 0}, 4, inputs={"flow": 1.0, "open": [1, 1, 1, 0]}),
        hys.explain_infeasible(tank, {"level": 4.2, "alarm": 0}, 5, limits=limits, inputs={"flow": 0.0}),
        hys.explain_infeasible(tank, {"level": 8.7, "alarm": 1}, 3, inputs={"flow": 1.0}),
        hys.explain_infeasible(tank, {"level": 10.5, "alarm": 0}, 1),
        hys.explain_infeasible(tank, {"level": 8.9, "alarm": 1}, 3, inputs={"flow": 0.25}),
        hys.explain_infeasible(tank, {"level": 9.000003, "alarm": 1}, 1),
    ]
    return "\n".join(map(str, cases))


if __name__ == "__main__":
    GOLDEN.write_text(explanation_texts(), encoding="utf-8")
