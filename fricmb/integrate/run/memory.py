"""How much memory a run takes, and whether its result will fit."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar, TypeVar

_Made = TypeVar("_Made")

#: Seconds between two looks.
EVERY = 0.5
#: Bytes below which nobody asks: of a run as a whole, between two slices, and of rows that are to grow at once.
SMALL, FEW = 2.5e8, 2e7
#: Seconds in which no process takes so much: what was read so long ago is good enough to begin with.
RECENT = 0.05
#: How reasons for want of memory begin, all of them, and what they advise.
BEGINS = "memory: "
KEEPS_LESS = "t_eval= with dense=False, or on_chunk=, keeps less, and method='auto' or another may take longer steps"


def available() -> float | None:
    """Bytes that may still be taken, of the machine, the group of processes and this process; None: unknown."""
    found = []
    try:
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                found.append(1024.0 * float(line.split()[1]))
    except (OSError, ValueError, IndexError):
        pass
    try:
        most = float(Path("/sys/fs/cgroup/memory.max").read_text())
        found.append(most - float(Path("/sys/fs/cgroup/memory.current").read_text()))
    except (OSError, ValueError):  # no such group, or no limit ("max")
        pass
    if (left := _left_to_process()) is not None:
        found.append(left)
    if not found:
        try:
            return 0.5 * os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
        except (AttributeError, OSError, ValueError):
            return None
    return min(found)


def _left_to_process() -> float | None:
    """Bytes of addresses left below this process' own limit (``ulimit -v``); None: no limit, or unknown."""
    try:
        import resource

        most, _ = resource.getrlimit(resource.RLIMIT_AS)
        if most == resource.RLIM_INFINITY:
            return None
        with open("/proc/self/statm", "rb", buffering=0) as file:
            return max(0.0, most - float(file.read(200).split()[0]) * os.sysconf("SC_PAGE_SIZE"))
    except (ImportError, OSError, ValueError, IndexError, AttributeError):
        return None


def taken() -> float | None:
    """Bytes that this process holds; None: unknown."""
    try:
        with open("/proc/self/statm", "rb", buffering=0) as file:
            return float(file.read(200).split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError, AttributeError):
        pass
    try:
        import resource
        import sys

        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return float(peak * (1 if sys.platform == "darwin" else 1024))
    except ImportError:
        return None


class Footprint:
    """Memory that a run has taken so far; to put together what it holds takes as much again at the end."""

    #: When memory was looked at last, and what there was: a look takes a tenth of a run that does nothing.
    _seen: ClassVar[tuple[float, float | None]] = (-1e9, None)

    def __init__(self) -> None:
        now = time.monotonic()
        when, self._start = Footprint._seen
        if now > when + RECENT:
            self._start = taken()
            Footprint._seen = now, self._start
        self._next = now + EVERY

    def excess(self) -> str | None:
        """Why the run has to end for want of memory, or None."""
        now = time.monotonic()
        if self._start is None or now < self._next:
            return None
        self._next = now + EVERY
        held = (taken() or 0.0) - self._start
        if held < SMALL:
            return None
        left = available()
        if left is None or left > 1.2 * held:
            return None
        return (
            f"memory: the result has taken {held / 1e9:.2g} GB and assembling it needs more than the "
            f"{left / 1e9:.2g} GB left; {KEEPS_LESS}"
        )


def lengthen(
    make: Callable[[], _Made], wanted: float, method: str, steps: int, advice: str
) -> tuple[_Made | None, str | None]:
    """More rows, as ``make`` makes them, and None; or None, and why the run has to end.

    ``wanted``: bytes that the longer rows and a result made of them take; ``steps`` that ``method`` has made so far;
    ``advice``: what to do instead.
    """
    left = available() if wanted >= FEW else None
    if left is None or left >= wanted:
        try:
            return make(), None
        except MemoryError:
            left = available()
    return None, no_room(method, steps, wanted, left, advice)


def no_room(method: str, steps: int, wanted: float, left: float | None, advice: str) -> str:
    """Why a run has to end whose rows find no room."""
    there = "the system refuses them" if left is None or left >= wanted else f"{left / 1e9:.2g} GB are left"
    return (
        f"memory: {method} has made {steps} steps and needs {wanted / 1e9:.2g} GB to keep twice as many, but {there}; "
        f"{advice}"
    )


def refused(error: MemoryError) -> str:
    """Why a run had to end within which the system gave no more memory."""
    left = available()
    said = f": {error}" if str(error) else ""
    there = "" if left is None else f"; {left / 1e9:.2g} GB are left"
    return f"memory: the system gave no more{said}{there}; {KEEPS_LESS}"
