"""Numerical kernels in scalar code: compiled by numba where it is installed, plain Python where not.

They know arrays only. Both ways run the same source, so that the results are the same; plain Python is some hundred
times slower, and the callers use it for nothing but tests.
"""
