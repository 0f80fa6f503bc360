"""The text of every stage is what tests/golden says."""

import pytest
from golden_text import GOLDEN, MODELS, STAGES, stage_text


@pytest.mark.parametrize("stage", STAGES)
@pytest.mark.parametrize("name", MODELS)
def test_stage(name, stage):
    assert stage_text(name, stage) == (GOLDEN / f"{name}.{stage}.txt").read_text()
