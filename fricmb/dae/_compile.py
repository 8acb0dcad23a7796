"""The decorators of this package's kernels, which keep the Python type of what they compile."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

from fricmb.integrate.compile.compilers import MachineCompiler
from fricmb.integrate.compile.kernel_cache import cached_on_disk

_Function = TypeVar("_Function", bound=Callable[..., Any])


def kernel(function: _Function) -> _Function:
    """Compile at the first call, not at import; kept in the disk cache; division by zero gives inf."""
    return cast(_Function, cached_on_disk(njit(error_model="numpy", pipeline_class=MachineCompiler)(function)))
