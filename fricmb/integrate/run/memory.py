"""How much memory a run takes, and whether its result will fit."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import ClassVar

#: Seconds between two looks.
EVERY = 0.5
#: Bytes below which nobody asks.
SMALL = 2.5e8
#: Seconds in which no process takes so much: what was read so long ago is good enough to begin with.
RECENT = 0.05


def available() -> float | None:
    """Bytes that may still be taken, of the machine and of the group of processes this one is in; None: unknown."""
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
    if not found:
        try:
            return 0.5 * os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
        except (AttributeError, OSError, ValueError):
            return None
    return min(found)


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
            f"{left / 1e9:.2g} GB left; t_eval= with dense=False, or on_chunk=, keeps less"
        )
