"""Slices of a run: kernels come back to Python some fifty times a second, which looks for Ctrl-C, limits and progress.

Python handles no signal while a kernel works.  A thread therefore counts the time in a number that kernels can see; the
loop of a run compares it with what it was when it began, and returns at a place from which it can go on.  Results do
not depend on where slices end.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import llvmlite.binding
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from fricmb.integrate.compile.kernel import kernel

#: Seconds of a slice, and how long the thread goes on counting when no run is under way: starting one takes longer.
SLICE, IDLE = 0.02, 1.0
#: Below 0 the number says that each look ends a slice: so results are shown not to depend on where slices end.
ALWAYS_OVER = -(1 << 62)
_SYMBOL = "fricmb_ticks"
_ticks = np.zeros(1, dtype=np.int64)
llvmlite.binding.add_symbol(_SYMBOL, _ticks.ctypes.data)
_WORD = ir.IntType(64)


@intrinsic  # type: ignore[untyped-decorator]
def _read_ticks(typingctx: Any) -> Any:
    """The number of slices so far, as it stands in memory now."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        module = builder.module
        word = module.globals.get(_SYMBOL)
        if word is None:
            word = ir.GlobalVariable(module, _WORD, _SYMBOL)
            word.linkage = "external"
        loaded = builder.load(word)
        loaded.volatile = True  # another thread changes it
        return loaded

    return types.int64(), codegen


@kernel
def ticks() -> int:
    """The number of slices so far: what a loop keeps when it begins, for :func:`slice_over`."""
    return int(_read_ticks())


@kernel
def slice_over(begun: int) -> bool:
    """Whether the slice in which a loop began is over, so that it has to go back to Python.

    Loops ask behind a step, so that each slice gets on.
    """
    now = _read_ticks()
    return bool(now != begun or now < 0)


class _Bell:
    """The thread that counts, and the number of runs it counts for."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.runs = 0
        self._thread: threading.Thread | None = None

    def wake(self) -> None:
        """Count from now on; with the lock."""
        if self._thread is None or not self._thread.is_alive():
            self._thread = threading.Thread(target=self._count, name="fricmb slices", daemon=True)
            self._thread.start()

    def _count(self) -> None:
        last = time.monotonic()
        while True:
            time.sleep(SLICE)
            with self.lock:
                if self.runs > 0:
                    _ticks[0] += 1
                    last = time.monotonic()
                elif time.monotonic() > last + IDLE:
                    self._thread = None
                    return


_bell = _Bell()


def _renew() -> None:
    """A process that was forked has no thread, and a lock that may be held for ever."""
    global _bell
    _bell = _Bell()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew)


@contextmanager
def slicing() -> Iterator[None]:
    """Let loops of kernels that are called inside come back after each slice."""
    bell = _bell
    with bell.lock:
        bell.runs += 1
        bell.wake()
    try:
        yield
    finally:
        with bell.lock:
            bell.runs -= 1
