"""The command that writes the names of a model as Python types."""


def test_prints(hysdel):
    shown = hysdel("stubs", "tank.hys")
    assert (shown.status, shown.err) == (0, "")
    assert "class TankState(NamedTuple):" in shown.out


def test_writes_a_file(hysdel, tmp_path):
    shown = hysdel("stubs", "tank.hys", "-o", "tank_names.py")
    assert (shown.status, shown.out) == (0, "")
    assert (tmp_path / "tank_names.py").read_text(encoding="utf-8") == hysdel("stubs", "tank.hys").out


def test_folder_that_is_not_there(hysdel):
    shown = hysdel("stubs", "tank.hys", "-o", "nowhere/names.py")
    assert shown.status == 2
    assert "there is no folder" in shown.err
