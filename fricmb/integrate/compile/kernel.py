"""Compilation of kernels: two decorators, so that every kernel is compiled alike and keeps its Python type."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

from fricmb.integrate.compile.kernel_cache import kept
from fricmb.integrate.compile.linked import LinkedCompiler

_Function = TypeVar("_Function", bound=Callable[..., Any])


def kernel(function: _Function) -> _Function:
    """Compile ``function`` for calls from other kernels; division by zero gives inf, as in numpy.

    Neither cached by itself nor callable from Python, where it would end the process: what is optimised, made machine
    code and cached is the entry or block that calls it (:mod:`fricmb.integrate.compile.linked`).
    """
    inner = njit(error_model="numpy", no_cfunc_wrapper=True, no_cpython_wrapper=True, pipeline_class=LinkedCompiler)
    return cast(_Function, inner(function))


def entry(function: _Function) -> _Function:
    """Compile ``function`` on its first call from Python; kept in the disk cache with all that it calls."""
    return cast(_Function, kept(njit(error_model="numpy", no_cfunc_wrapper=True)(function)))
