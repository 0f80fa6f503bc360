"""What cannot be read, and what can although it looks odd."""

from pathlib import Path

import pytest

import hysdel_py as hys
from hysdel_py.syntax.reader import MAX_CHARACTERS, is_text

TEXT = """SYSTEM small {
  INTERFACE { STATE { REAL x [0, 1]; } }
  IMPLEMENTATION { CONTINUOUS { x = 0.5*x; } }
}
"""


def refused(path, **parameters):
    with pytest.raises(hys.CompileError) as caught:
        hys.load(path, **parameters)
    (diagnostic,) = caught.value.diagnostics
    return diagnostic


def test_missing_file(tmp_path):
    diagnostic = refused(tmp_path / "absent.hys")
    assert diagnostic.code.value == "HYS001"
    assert "absent.hys" in diagnostic.message
    assert ".hys file" in diagnostic.help


def test_forgotten_suffix(tmp_path):
    (tmp_path / "small.hys").write_text(TEXT)
    assert "did you mean" in refused(tmp_path / "small").help


def test_folder(tmp_path):
    diagnostic = refused(tmp_path)
    assert diagnostic.code.value == "HYS001"
    assert "folder" in diagnostic.help


@pytest.mark.parametrize("name", ["", "no\0name", "x" * 5000])
def test_names_that_no_file_can_have(name):
    assert refused(name).code.value == "HYS001"


def test_empty_path_object_is_the_current_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert refused(Path()).code.value == "HYS001"


@pytest.mark.parametrize("data", [b"\x7fELF\x00\x00", b"SYSTEM s {\x00}", bytes(range(256))])
def test_binary(tmp_path, data):
    (tmp_path / "b.hys").write_bytes(data)
    diagnostic = refused(tmp_path / "b.hys")
    assert diagnostic.code.value == "HYS002"
    assert f"offset {data.index(0)}" in diagnostic.message


def test_other_encoding_outside_comments(tmp_path):
    (tmp_path / "l.hys").write_bytes(b"SYSTEM s {\n  caf\xe9 }")
    diagnostic = refused(tmp_path / "l.hys")
    assert diagnostic.code.value == "HYS003"
    assert "0xe9 in line 2" in diagnostic.message


def test_other_encoding_inside_comments_is_accepted(tmp_path):
    (tmp_path / "l.hys").write_bytes(b"/* caf\xe9 */" + TEXT.encode())
    assert hys.load(tmp_path / "l.hys").name == "small"


def test_utf16_is_refused(tmp_path):
    (tmp_path / "w.hys").write_text(TEXT, encoding="utf-16")
    assert refused(tmp_path / "w.hys").code.value in ("HYS002", "HYS003")


def test_byte_order_mark_is_skipped(tmp_path):
    (tmp_path / "bom.hys").write_text(TEXT, encoding="utf-8-sig")
    assert hys.load(tmp_path / "bom.hys").dha.step([1])[0] == [0.5]


def test_windows_line_ends_keep_lines_and_columns(tmp_path):
    (tmp_path / "crlf.hys").write_bytes(TEXT.replace("\n", "\r\n").encode())
    model = hys.load(tmp_path / "crlf.hys")
    assert model.typed.items[0].line == 3
    assert any("carriage" in d.message for d in model.diagnostics)


def test_ten_megabytes_of_code_are_refused_quickly(tmp_path):
    (tmp_path / "long.hys").write_text(TEXT + "x" * 10_000_000)
    diagnostic = refused(tmp_path / "long.hys")
    assert diagnostic.code.value == "HYS004"
    assert str(MAX_CHARACTERS) in diagnostic.message


def test_comments_do_not_count(tmp_path):
    (tmp_path / "talk.hys").write_text("/*" + "x" * (MAX_CHARACTERS + 1) + "*/" + TEXT)
    assert hys.load(tmp_path / "talk.hys").name == "small"


def test_text_and_path_are_told_apart():
    assert is_text(TEXT)
    assert is_text("SYSTEM s {}")
    assert not is_text("clutch.hys")
    assert not is_text("clutch")


def test_shipped_model_by_name_and_a_file_hides_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert hys.load("clutch").name == hys.load("clutch.hys").name == "clutch"
    (tmp_path / "clutch.hys").write_text(TEXT)
    assert hys.load("clutch.hys").name == "small"


def test_path_in_messages_is_the_file_name(tmp_path):
    (tmp_path / "named.hys").write_text(TEXT.replace("0.5*x", "x*x"))
    with pytest.raises(hys.CompileError, match=r"named\.hys:3:37"):
        hys.load(tmp_path / "named.hys")


@pytest.mark.parametrize("wrong", [None, 3, b"SYSTEM s {}", ["a"]])
def test_argument_of_wrong_type(wrong):
    with pytest.raises(hys.ArgumentError, match="path or the text"):
        hys.load(wrong)
