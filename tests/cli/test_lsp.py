"""The language server without the package that it needs."""

import sys


def test_missing_pygls_is_told(hysdel, monkeypatch):
    monkeypatch.setitem(sys.modules, "pygls", None)
    shown = hysdel("lsp")
    assert shown.status == 1
    assert "pip install 'hysdel-py[lsp]'" in shown.err
