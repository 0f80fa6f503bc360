"""Syntax tree to typed model: names, types, parameters."""
