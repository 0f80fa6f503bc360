"""The corpus models that the original accepts, as the tests of the writers want them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import hysdel_py as hys
from hysdel_py.export.compiled import Compiled, compile_model
from hysdel_py.lowering.constants import Constants

CORPUS = Path(__file__).parents[1] / "data" / "corpus"
FLAGS = {"": Constants.FORBID, "-a": Constants.AUX, "-5": Constants.AFFINE}


@dataclass(frozen=True)
class Accepted:
    """A model, its flag, and what the original made of it."""

    path: Path
    expected: dict[str, Any]

    @property
    def flag(self) -> str:
        return self.expected["flags"] or ""

    def model(self, **parameters: float) -> hys.Model:
        return hys.load(self.path, **parameters)

    def compiled(self, *, every: bool = False) -> Compiled:
        model = self.model()
        return compile_model(model.typed, model.parameters, FLAGS[self.flag], every=every)[0]


def _accepted() -> list[Accepted]:
    found = [Accepted(path, json.loads(path.with_suffix(".json").read_text())) for path in sorted(CORPUS.glob("*.hys"))]
    return [model for model in found if model.expected["accepted"] and not model.expected["divergence"]]


ACCEPTED = _accepted()
NAMES = [model.path.stem for model in ACCEPTED]
