"""SIGTERM and SIGHUP, by which batch systems and closed terminals end a process, taken as Ctrl-C is."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

#: Where the system has them.
_ENDING = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))


@contextmanager
def as_interrupts() -> Iterator[None]:
    """Let signals that end a process do inside what Ctrl-C does, so that what was computed is kept.

    Only in the main thread, and only those that have no handler of the user's and are not ignored (``nohup``).
    """
    taken = []
    if threading.current_thread() is threading.main_thread():
        taken = [number for number in _ENDING if signal.getsignal(number) is signal.SIG_DFL]
    own = os.getpid()

    def interrupt(number: int, frame: Any) -> None:
        if os.getpid() == own:
            _interrupt(frame)
        else:  # a process that was forked has taken over the handler, not what it is for
            signal.signal(number, signal.SIG_DFL)
            signal.raise_signal(number)

    for number in taken:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        for number in taken:
            signal.signal(number, signal.SIG_DFL)


def _interrupt(frame: Any) -> None:
    """What Ctrl-C does; where that is ignored, as in the background of a shell, what it would do."""
    handler = signal.getsignal(signal.SIGINT)
    if callable(handler):
        handler(signal.SIGINT, frame)
    else:
        raise KeyboardInterrupt
