"""The modules of :mod:`hysdel_py.geometry.kernels` once more, as plain Python of the same files.

Plain loops add and multiply in the order that the compiled ones do, hence the numbers are the same to the last bit.
"""

from hysdel_py.geometry import kernels

__path__ = kernels.__path__
