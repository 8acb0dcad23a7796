"""Processor time of a run, what it compiles or loads apart."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

from fricmb._simulate._compile_watch import CompileWatch

_T = TypeVar("_T")

#: How often a run is made at most until nothing is compiled in it.
TRIES = 3


def timed(run: Callable[[], _T]) -> tuple[_T, float]:
    """What ``run()`` gives and the processor time it took, in seconds.

    A run that had to wait for kernels is made again: the time would be that of the compiler.
    """
    for _ in range(TRIES):
        with CompileWatch() as watch:
            begin = time.process_time()
            result = run()
            seconds = time.process_time() - begin
        if watch.seconds == 0.0:
            break
    return result, seconds
