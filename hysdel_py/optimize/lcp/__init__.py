"""Linear complementarity problems, also with two-sided bounds, by four methods that one residual judges."""
