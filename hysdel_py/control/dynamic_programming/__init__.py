"""Dynamic programming: numerical on grids, analytical for linear systems with quadratic cost."""
