"""Inner loops of the simulation in scalar code: compiled by numba where it is installed, plain Python where not."""
