"""Vectors, matrices, loops and modules to scalars: syntax tree to syntax tree."""
