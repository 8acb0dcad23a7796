"""How a compiled run is ended from outside: Ctrl-C, a limit on its time, a limit on its memory.

The loop of a run returns after each slice (:mod:`fricmb.integrate.run.slices`).  What ends the run is looked at then,
and the reason is left with its :class:`Watch`.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, cast

from numba.core.compiler_lock import global_compiler_lock

from fricmb.integrate.run.memory import Footprint
from fricmb.integrate.run.outcomes import SLICE_OVER
from fricmb.integrate.run.slices import slicing


class Watch:
    """What may end a run, and what has ended it.

    Attributes
    ----------
    limit : float or None
        Seconds of wall time, from ``since`` on (time.perf_counter; None: now).
    cause : BaseException or None
        What was raised by a signal's handler (KeyboardInterrupt).
    reason : str or None
        Why the run was ended; None: it was not.
    begun : bool
        Whether the run has made steps, which are to be kept.
    """

    def __init__(
        self, limit: float | None = None, footprint: Footprint | None = None, since: float | None = None
    ) -> None:
        self.limit = limit
        self.cause: BaseException | None = None
        self.reason: str | None = None
        self.begun = False
        self._end = None if limit is None else (time.perf_counter() if since is None else since) + limit
        self._footprint = footprint
        self._stop: threading.Event | None = getattr(_local, "stop", None)

    def look(self) -> None:
        """Check the limits."""
        if self.reason is not None:
            return
        if self._end is not None and time.perf_counter() >= self._end:
            self.reason = f"the time limit of {self.limit:g} s was reached"
        elif self._stop is not None and self._stop.is_set():
            self.reason = "interrupted"
        elif self._footprint is not None:
            self.reason = self._footprint.excess()

    def interrupt(self, cause: BaseException) -> None:
        """Take what a signal's handler raised."""
        if self.reason is None:
            self.cause, self.reason = cause, "interrupted"


_local = threading.local()


def in_slices(loop: Callable[..., int], *arguments: Any, tell: Callable[[], None] | None = None) -> int:
    """Call the loop of a run until it has done what it can: what it returns, SLICE_OVER where the run is to end.

    ``tell`` is called between slices.  What a signal's handler raises inside of :func:`watching` is kept, and
    :func:`ended` tells; outside it is raised here.
    """
    watch = present()
    try:
        with slicing():
            while ended() is None:
                code = loop(*arguments)
                if watch is not None:
                    watch.begun = True
                if code != SLICE_OVER:
                    return code
                if tell is not None:
                    tell()
    except BaseException as error:
        if watch is None:
            raise
        watch.interrupt(error)
    return SLICE_OVER


@contextmanager
def watching(watch: Watch | None) -> Iterator[None]:
    """Let ``watch`` end what is run inside, in this thread; None: what is inside is no part of the run."""
    outer = present()
    _local.watch = watch
    taken = watch is not None and outer is None and _takes_interrupts()
    if taken:
        signal.signal(signal.SIGINT, _note_interrupt)
    try:
        yield
    finally:
        _local.watch = outer
        if taken:
            signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def ended_by(stop: threading.Event) -> Iterator[None]:
    """Let runs that are made inside, in this thread, end when another thread sets ``stop``."""
    _local.stop = stop
    try:
        yield
    finally:
        _local.stop = None


def _takes_interrupts() -> bool:
    """Whether Ctrl-C comes here: a handler of the user's own stays, and so does that of another thread."""
    main = threading.current_thread() is threading.main_thread()
    return main and signal.getsignal(signal.SIGINT) is signal.default_int_handler


def _note_interrupt(number: int, frame: Any) -> None:
    """Ctrl-C during a run: between kernels, too, what was computed is kept.  A second one ends at once.

    Before there is anything to keep, compiling ends at once; behind the first steps it is brought to its end.
    """
    watch = present()
    if watch is None or watch.cause is not None or (global_compiler_lock.is_locked() and not watch.begun):
        raise KeyboardInterrupt
    watch.interrupt(KeyboardInterrupt())


def present() -> Watch | None:
    """The watch of the present run, if it has one."""
    return cast("Watch | None", getattr(_local, "watch", None))


def ended() -> str | None:
    """Why the present run is to end, or None; for loops in Python between kernels."""
    watch = present()
    if watch is None:
        return None
    watch.look()
    return watch.reason
