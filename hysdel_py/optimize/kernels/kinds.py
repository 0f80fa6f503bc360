"""Kinds of variables in a condensed node: free, defined by a row in terms of earlier ones, and constant."""

from __future__ import annotations

__all__ = ["CONSTANT", "DEFINED", "FREE"]

FREE, DEFINED, CONSTANT = 0, 1, 2
