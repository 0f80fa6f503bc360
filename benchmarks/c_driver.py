"""Written C behind numpy: a loop over many points is compiled beside the source and called through ctypes."""

from __future__ import annotations

import ctypes
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hysdel_py.control.explicit_law import ExplicitLaw
from hysdel_py.control.hybrid_law import HybridLaw
from hysdel_py.export.law_c import LawCode
from hysdel_py.export.law_number import Number, scaling_of
from hysdel_py.export.plant_c import to_c
from hysdel_py.model import Model

FLAGS = ("-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic")
RAW = {"double": np.float64, "float": np.float32, "int32": np.int32, "int16": np.int16}
LAW_LOOP = """#include "{header}"
#include <stdint.h>
void many(const {raw} *zeta, {move} *u, int32_t *status, long count);
void many(const {raw} *zeta, {move} *u, int32_t *status, long count)
{{
    long k{last};
    for (k = 0; k < count; k++)
        status[k] = {name}(zeta + k * {p}, u + k * {m}{region});
}}
"""
PLANT_LOOP = """#include "{header}"
#include <stdint.h>
void many(const double *x, const double *u, double *x1, double *y, double *d, double *z, int32_t *status, long count);
void many(const double *x, const double *u, double *x1, double *y, double *d, double *z, int32_t *status, long count)
{{
    long k;
    for (k = 0; k < count; k++)
        status[k] = {name}_step(x + k * {nx}, u + k * {nu}, x1 + k * {nx}, y + k * {ny}, d + k * {nd}, z + k * {nz});
}}
"""


def library(source: Path, loop: str, optimise: str = "-O2") -> ctypes.CDLL:
    driver = source.with_name(f"{source.stem}_many.c")
    driver.write_text(loop)
    output = driver.with_suffix(".so")
    subprocess.run(["gcc", *FLAGS, optimise, "-shared", "-fPIC", driver, source, "-o", output], check=True)
    return ctypes.CDLL(str(output))


@dataclass
class CompiledLaw:
    """A law of one number type and method."""

    law: ExplicitLaw
    code: LawCode
    keeps: bool = False

    def __post_init__(self) -> None:
        self.scaling = scaling_of(self.law, Number(self.code.number))
        move = "int32_t" if self.scaling.number.is_fixed else self.code.number
        words = {
            "header": self.code.files[1].name,
            "raw": self.scaling.number.c_type,
            "move": move,
            "name": f"{self.code.prefix}_from" if self.keeps else self.code.prefix,
            "p": self.law.p,
            "m": self.law.moves,
            "last": ", region = -1" if self.keeps else "",
            "region": ", &region" if self.keeps else "",
        }
        self.many = library(self.code.files[0], LAW_LOOP.format(**words)).many

    def raw(self, points: NDArray[np.float64]) -> NDArray[np.generic]:
        kind = RAW[self.code.number]
        values = self.scaling.raw(points)
        if self.scaling.number.is_fixed:
            ends = np.iinfo(kind)
            values = np.clip(values, ends.min, ends.max)
        return np.ascontiguousarray(values.astype(kind))

    def __call__(self, points: NDArray[np.float64]) -> tuple[NDArray[np.int32], NDArray[np.float64], float]:
        """Status and move at each point, and seconds per point."""
        raw, status = self.raw(points), np.zeros(len(points), dtype=np.int32)
        kind = np.int32 if self.scaling.number.is_fixed else RAW[self.code.number]
        u = np.zeros((len(points), self.law.moves), dtype=kind)
        started = time.perf_counter()
        self.many(*(a.ctypes.data_as(ctypes.c_void_p) for a in (raw, u, status)), ctypes.c_long(len(points)))
        seconds = (time.perf_counter() - started) / max(1, len(points))
        return status, u * self.scaling.unit, seconds


@dataclass
class CompiledHybrid:
    """A hybrid law in double or float."""

    law: HybridLaw
    path: Path
    number: str

    def __post_init__(self) -> None:
        code = self.law.to_c(self.path, number=self.number)
        words = {"header": code.files[1].name, "raw": self.number, "move": self.number, "name": code.prefix,
                 "p": len(self.law.names), "m": len(self.law.u), "last": "", "region": ""}  # fmt: skip
        self.many = library(code.files[0], LAW_LOOP.format(**words)).many

    def __call__(self, points: NDArray[np.float64]) -> tuple[NDArray[np.int32], NDArray[np.float64], float]:
        """Status and move at each point, and seconds per point."""
        raw, status = np.ascontiguousarray(points.astype(RAW[self.number])), np.zeros(len(points), dtype=np.int32)
        u = np.zeros((len(points), len(self.law.u)), dtype=RAW[self.number])
        started = time.perf_counter()
        self.many(*(a.ctypes.data_as(ctypes.c_void_p) for a in (raw, u, status)), ctypes.c_long(len(points)))
        return status, u.astype(float), (time.perf_counter() - started) / max(1, len(points))


@dataclass
class CompiledPlant:
    """A plant."""

    model: Model
    path: Path

    def __post_init__(self) -> None:
        code, dha = to_c(self.model, self.path), self.model.dha
        self.sizes = {key: len(getattr(dha, key)) for key in "xuydz"}
        words = {f"n{key}": size for key, size in self.sizes.items()}
        self.many = library(code.files[0], PLANT_LOOP.format(header=code.files[1].name, name=code.prefix, **words)).many

    def __call__(self, x: NDArray[np.float64], u: NDArray[np.float64]) -> tuple[list[NDArray[np.float64]], float]:
        """Status and x+, y, d, z of each step, and seconds per step."""
        count = len(x)
        found = [np.zeros((count, self.sizes[key])) for key in "xydz"]
        status = np.zeros(count, dtype=np.int32)
        arrays = [np.ascontiguousarray(a) for a in (x, u)] + found + [status]
        started = time.perf_counter()
        self.many(*(a.ctypes.data_as(ctypes.c_void_p) for a in arrays), ctypes.c_long(count))
        return [status, *found], (time.perf_counter() - started) / max(1, count)
