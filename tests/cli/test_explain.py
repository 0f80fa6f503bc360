"""``hysdel explain``: pages, the list, unknown codes."""

from hysdel_py.diagnostics.codes import Code


def test_page(hysdel):
    shown = hysdel("explain", "HYS305")
    assert shown.status == 0
    assert shown.out.startswith("# HYS305: defined by itself")
    assert hysdel("explain", "305").out == shown.out


def test_list(hysdel):
    lines = hysdel("explain").out.splitlines()
    assert [line[:6] for line in lines] == [code.value for code in Code]


def test_unknown_code(hysdel):
    shown = hysdel("explain", "HYS3O5")
    assert shown.status == 2
    assert "did you mean" in shown.err
    assert "HYS305" in shown.err
