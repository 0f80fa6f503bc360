"""Hybrid laws as LaTeX: the numbers in the tables are those of the law."""

import re

import numpy as np
import pytest
from plotting.test_hybrid_law import made

import hysdel_py as hys


def terms(text):
    """A sum as Python can evaluate it."""
    text = re.sub(r"\\cdot 10\^\{(-?\d+)\}", r"e\1", text).replace("\\,", "*").replace("^2", "**2")
    return text.replace("{", "").replace("}", "")


@pytest.mark.parametrize("norm", ["2", "1"])
def test_moves_and_values_can_be_read_back(norm):
    law = made(norm)
    text = law.to_latex(digits=12)
    paragraphs = text.split(r"\paragraph{Sequence ")[1:]
    assert len(paragraphs) == len(law.sequences)
    for sequence, paragraph in zip(law.sequences, paragraphs, strict=True):
        moves = re.findall(r"u &= (.*?) \\\\ s &= (.*?)(?: \\\\ V &= (.*?))? \\end", paragraph)
        assert len(moves) == sequence.law.count
        for region, (u, s, value) in enumerate(moves):
            point = np.array([0.37, -0.81])
            names = {"a": point[0], "c": point[1]}
            own = sequence.law.K[region][:2] @ point + sequence.law.k[region][:2]
            assert [eval(terms(part), {}, names) for part in (u, s)] == pytest.approx(own.tolist(), abs=1e-8)
            assert bool(value) == (norm == "2")
            if value:
                P, q, r = (getattr(sequence.law, name)[region] for name in "Pqr")
                own = 0.5 * point @ P @ point + q @ point + r
                assert eval(terms(value), {}, names) == pytest.approx(own, rel=1e-8)


def test_options_and_file(tmp_path):
    law = made("1")
    text = law.to_latex(tmp_path / "law.tex", digits=3, moves=("torque_1", "switch"), document=False)
    assert (tmp_path / "law.tex").read_text(encoding="utf-8") == text
    assert text.startswith(r"\paragraph{Sequence 0}")
    assert r"\text{torque\_1}" in text
    with pytest.raises(hys.ArgumentError, match="2 names"):
        law.to_latex(moves=("torque",))
    with pytest.raises(hys.ArgumentError, match="from 1 to 17"):
        law.to_latex(digits=0)
