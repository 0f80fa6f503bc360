"""Texts from outside cannot become tags, attributes or the end of a script."""

import json
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hysdel_py.markup.elements import Markup, as_json, element, fragment, table

HOSTILE = '<script>alert(1)</script>" onload="x\' & </style>'


class Reader(HTMLParser):
    """Tags, attributes and text of a page as a browser reads it."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.words = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.words.append(data)


def test_element_with_attributes_and_children():
    written = element("a", "to ", element("b", 2.5), None, [1, "!"], href="#x", class_="k", data_of="y", hidden=True)
    assert written == '<a href="#x" class="k" data-of="y" hidden>to <b>2.5</b>1!</a>'
    assert element("rect", x=1.0, y=0) == '<rect x="1" y="0"/>'
    assert element("p", "", title=None, hidden=False) == "<p></p>"


def test_text_is_escaped_and_markup_is_not():
    assert fragment("<b>", Markup("<i></i>")) == "&lt;b&gt;<i></i>"


@given(st.text())
def test_no_text_opens_a_tag_or_leaves_its_attribute(text):
    read = Reader(element("p", text, title=text))
    assert [(tag, set(attributes)) for tag, attributes in read.tags] == [("p", {"title"})]


@given(st.recursive(st.text() | st.integers() | st.none(), lambda inner: st.lists(inner, max_size=3), max_leaves=5))
def test_data_of_a_script_reads_back_and_holds_no_tag(data):
    written = as_json(data)
    assert json.loads(written) == data
    assert not set("<>&") & set(written)


@pytest.mark.parametrize("text", [HOSTILE, "</script>", "<!--", "]]>"])
def test_hostile_texts(text):
    read = Reader(table([text], [[text]], id=text))
    assert [tag for tag, _ in read.tags] == ["table", "thead", "tr", "th", "tbody", "tr", "td"]
    assert "".join(read.words) == 2 * text


def test_characters_that_no_page_may_hold():
    assert element("p", "a\x00b\x1bc") == "<p>a\ufffdb\ufffdc</p>"
