"""What the tests of the command line share: a runner, and models small enough to follow by hand."""

import json
from dataclasses import dataclass

import pytest

from hysdel_py.cli.main import main

TANK = """/* a tank that may be filled */
SYSTEM tank {
  INTERFACE {
    STATE { REAL level [-5, 10]; /* [m] level of the water */ BOOL was_open; }
    INPUT { REAL flow [-1, 1]; /* [m/s] inflow */ BOOL open; }
    OUTPUT { REAL y; /* [m] what is measured */ }
    PARAMETER { REAL gain = 1; REAL ts = 0.5; /* [s] */ }
  }
  IMPLEMENTATION {
    AUX { REAL inflow; }
    DA { inflow = {IF open THEN gain*flow ELSE 0}; }
    CONTINUOUS { level = level + inflow; }
    AUTOMATA { was_open = open; }
    OUTPUT { y = level; }
  }
}
"""


@dataclass(frozen=True)
class Outcome:
    """What a command left: exit status and both texts."""

    status: int
    out: str
    err: str

    @property
    def json(self):
        return json.loads(self.out, parse_constant=_refuse)

    @property
    def rows(self):
        """The table on the screen as one mapping per step."""
        header, *lines = (line.split() for line in self.out.splitlines())
        return [dict(zip(header, map(float, line), strict=True)) for line in lines if len(line) == len(header)]


def _refuse(word):
    raise AssertionError(f"{word} is not JSON")


@pytest.fixture
def hysdel(capsys, tmp_path, monkeypatch):
    """Run the command in an empty folder that holds only ``tank.hys``."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tank.hys").write_text(TANK, encoding="utf-8")

    def run(*arguments):
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as stop:
            status = stop.code or 0
        captured = capsys.readouterr()
        return Outcome(status, captured.out, captured.err)

    return run
