"""How a compiled run is ended from outside: Ctrl-C, a limit on its time, a limit on its memory.

No signal is handled while a kernel works.  Its loops therefore ask ``stopped`` now and then, which looks at the clock,
and some twenty times a second lets pending signals be handled and calls back into Python, where limits are checked.
What is found there raises a flag that all loops of this thread obey; the kernel returns, and the reason is left with
the run's :class:`Watch`.
"""

from __future__ import annotations

import ctypes
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar, cast

from numba.core.compiler_lock import global_compiler_lock

from fricmb.integrate.problem import Ints
from fricmb.integrate.run.memory import Footprint
from fricmb.integrate.run.stopped import DUE, EVERY, FLAG, RAISED, call_back, now, own_words

_Result = TypeVar("_Result")


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
    tell : callable or None
        Called while kernels work, at each look: tells how far they are.
    """

    def __init__(
        self, limit: float | None = None, footprint: Footprint | None = None, since: float | None = None
    ) -> None:
        self.limit = limit
        self.cause: BaseException | None = None
        self.reason: str | None = None
        self.tell: Callable[[], None] | None = None
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


def _ask() -> int:
    """Python's part of ``stopped``, after signals have been handled."""
    watch: Watch = present() or getattr(_local, "active", None) or Watch()
    words = own_words()
    try:
        if words[RAISED] != 0:
            watch.interrupt(_raised(words))
        watch.look()
        if watch.tell is not None:
            watch.tell()
        words[DUE] = now() + EVERY
    except BaseException as error:  # of a signal that came just now
        watch.interrupt(error)
    words[FLAG] = watch.reason is not None
    return int(words[FLAG])


call_back(_ask)


def _raised(words: Ints) -> BaseException:
    """The exception that the kernel has fetched; goes on its way when the kernel has returned."""
    taken: list[Any] = [None if word == 0 else _object_at(int(word)) for word in words[RAISED:]]
    words[RAISED:] = 0
    kind, value = taken[0], taken[1]
    if isinstance(value, BaseException):
        return value
    error: BaseException = kind() if value is None else kind(value)
    return error


def _object_at(address: int) -> Any:
    """The object at an address, whose reference is handed over."""
    found = ctypes.cast(address, ctypes.py_object).value
    ctypes.pythonapi.Py_DecRef(ctypes.py_object(found))
    return found


def watched(function: Callable[..., _Result], *arguments: Any) -> _Result:
    """Call an entry, to be ended by the watch of the present run.

    Outside of :func:`watching` what a signal's handler raised is raised here; inside, :func:`ended` tells.
    """
    watch = present()
    own = watch if watch is not None else Watch()
    words = own_words()
    before = getattr(_local, "active", None), int(words[FLAG]), int(words[DUE])
    _local.active = own
    words[FLAG], words[DUE] = own.reason is not None, now() + EVERY
    try:
        return function(*arguments)
    finally:
        _local.active, words[FLAG], words[DUE] = before
        if watch is None and own.cause is not None:
            raise own.cause


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
    """Ctrl-C during a run: between kernels, too, what was computed is kept.  A second one ends at once."""
    watch = present()
    if watch is None or watch.cause is not None or global_compiler_lock.is_locked():
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
