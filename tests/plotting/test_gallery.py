"""The gallery shows the pictures that its script draws, and each of them can be drawn."""

import importlib.util
import re
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def gallery():
    spec = importlib.util.spec_from_file_location("gallery", ROOT / "docs" / "making" / "gallery.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_page_and_script_have_the_same_pictures(gallery):
    drawn = {f"{draw.__name__.replace('_', '-')}.png" for draw in gallery.PICTURES}
    shown = re.findall(r"pictures/gallery/([\w-]+\.png)", (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8"))
    assert sorted(shown) == sorted(drawn)
    assert {path.name for path in gallery.FOLDER.iterdir()} == drawn


def test_every_picture_is_drawn(gallery):
    for name, content in gallery.pictures():
        assert content.startswith(b"\x89PNG"), name
        assert len(content) > 5000, name
