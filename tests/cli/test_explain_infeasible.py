"""``hysdel explain-infeasible``."""

import os

from hysdel_py.cli.native import native_output_on_stderr


def test_exit_status_and_text(hysdel):
    found = hysdel("explain-infeasible", "tank.hys", "--x0", "9.5,0", "-N", 3, "--input", "flow=1,open=true")
    assert found.status == 1
    assert "range at k = 1: level <= 10" in found.out
    assert "tank.hys:4:18" in found.out
    assert "^^^^^" in found.out
    feasible = hysdel("explain-infeasible", "tank.hys", "--x0", "9.5,0", "-N", 3)
    assert feasible.status == 0
    assert "tank: feasible" in feasible.out


def test_limit_and_json(hysdel):
    found = hysdel("explain-infeasible", "tank.hys", "--x0", "5,0", "-N", 2, "--limit", "y=:3", "--json")
    assert found.status == 1
    assert found.json["verdict"] == "smallest"
    assert [part["text"] for part in found.json["contradiction"] if part["kind"] == "limit"] == ["y <= 3"]


def test_not_settled(hysdel):
    found = hysdel("explain-infeasible", "tank.hys", "--x0", "9.5,0", "-N", 3, "--seconds", 1e-9)
    assert found.status == 4
    assert "not settled" in found.out


def test_wrong_usage(hysdel):
    assert hysdel("explain-infeasible", "tank.hys", "--x0", "9.5,0").status == 2
    assert hysdel("explain-infeasible", "tank.hys", "--x0", "9.5", "-N", 2).status == 2
    assert hysdel("explain-infeasible", "tank.hys", "--x0", "9.5,0", "-N", 2, "--limit", "y").status == 2
    assert hysdel("explain-infeasible", "tank.hys", "--x0", "9.5,0", "-N", 0).status == 2


def test_native_output_goes_to_the_error_stream(capfd):
    with native_output_on_stderr():
        os.write(1, b"from a library\n")
    os.write(1, b"from the command\n")
    assert tuple(capfd.readouterr()) == ("from the command\n", "from a library\n")
