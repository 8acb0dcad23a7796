"""A mark of kernels whose loops are long."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

_Function = TypeVar("_Function", bound=Callable[..., Any])


def long_loops(function: _Function) -> _Function:
    """Mark, below ``@entry`` or ``@block``, what walks along all masses of large scenes: its loops are vectorised."""
    function.long_loops = True  # type: ignore[attr-defined]
    return function


def has_long_loops(function: Any) -> bool:
    """Whether a function is marked as one with long loops."""
    return hasattr(function, "long_loops")
