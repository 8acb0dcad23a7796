"""Making many objects that are all kept, without Python's collector looking through them again and again."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

#: From so many parts on it is worth it: with 100 000 blocks the collector takes a third of the time of planning.
MANY = 1000


@contextmanager
def no_collection(n_parts: int) -> Iterator[None]:
    """Pause the collector of cycles for scenes of many parts, if it is on."""
    if n_parts < MANY or not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
