import pytest

import hysdel_py as hys
from hysdel_py.diagnostics.codes import Code
from hysdel_py.diagnostics.explain import explain, title


@pytest.mark.parametrize("spelling", ["HYS302", "hys302", " 302 "])
def test_page_by_any_spelling(spelling):
    assert explain(spelling).startswith("# HYS302: not affine\n")


def test_title_is_the_headline():
    assert title(Code.NOT_AFFINE) == "not affine"
    assert all(0 < len(title(code)) < 60 for code in Code)


@pytest.mark.parametrize(("wrong", "near"), [("HYS3O2", "HYS302"), ("HYS303x", "HYS303"), ("HY401", "HYS401")])
def test_unknown_code_names_near_ones(wrong, near):
    with pytest.raises(hys.ArgumentError, match=f"did you mean .*{near}"):
        explain(wrong)


@pytest.mark.parametrize("wrong", ["", "nonsense", "x" * 10_000])
def test_anything_else_is_an_argument_error(wrong):
    with pytest.raises(hys.ArgumentError, match="there is no diagnostic") as caught:
        explain(wrong)
    assert len(str(caught.value)) < 200
