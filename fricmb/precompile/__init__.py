"""Machine code made ahead of use: all kernels, and what the built-in models need, in several processes."""

from fricmb.precompile._compile import compile_all

__all__ = ["compile_all"]
