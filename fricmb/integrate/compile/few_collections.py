"""Python looks for unreachable objects seldom while much is made that stays: loaded modules, compiled kernels."""

from __future__ import annotations

import gc
import threading
from collections.abc import Iterator
from contextlib import contextmanager

#: So many objects more, and so many looks, until Python looks through the young, the middle-aged and all objects.
#: Looking through what stays took a fifth of the time of compiling, and a twelfth of that of a first run.
SELDOM = (200_000, 20, 50)

_lock = threading.Lock()
#: What was set before, while somebody wants few collections, and how many do.
_before = gc.get_threshold()
_wanted = 0


@contextmanager
def few_collections() -> Iterator[None]:
    """Let Python look for unreachable objects seldom until the last thread that asked for it is done."""
    global _before, _wanted
    with _lock:
        if not _wanted:
            _before = gc.get_threshold()
            gc.set_threshold(*SELDOM)
        _wanted += 1
    try:
        yield
    finally:
        with _lock:
            _wanted -= 1
            if not _wanted:
                gc.set_threshold(*_before)
