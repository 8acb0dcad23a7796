"""How a compiled run is ended from outside: Ctrl-C, a limit on its time, a limit on its memory.

Kernels hold Python's lock, so nothing else of the process runs while one works, and no signal is handled.  Their loops
therefore ask :func:`stopped` now and then.  It looks at the clock, and some twenty times a second lets pending signals
be handled and calls back into Python, where limits are checked.  What is found there raises a flag that all loops obey;
the kernel returns, and the reason is left with the run's :class:`Watch`.
"""

from __future__ import annotations

import ctypes
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar, cast

import llvmlite.binding
import numpy as np
from llvmlite import ir
from numba import types
from numba.core.compiler_lock import global_compiler_lock
from numba.extending import intrinsic

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.run.memory import Footprint

_Result = TypeVar("_Result")

#: Words that kernels share with Python: flag, questions until the next look at the clock, address and number of the
#: clock, when the next call into Python is due (nanoseconds), its address; addresses of what handles signals and of
#: what fetches an exception, and its type, value and traceback.
FLAG, COUNT, CLOCK, CLOCK_ID, DUE, ASK, SIGNALS, FETCH, RAISED = range(9)
WORDS = RAISED + 3
#: Questions between two looks at the clock; nanoseconds between two calls into Python.
QUESTIONS, EVERY, NEVER = 4, 50_000_000, 1 << 62
_SYMBOL = "fricmb_watch_words"
_words = np.zeros(WORDS, dtype=np.int64)
_words[DUE] = NEVER
llvmlite.binding.add_symbol(_SYMBOL, _words.ctypes.data)


@intrinsic  # type: ignore[untyped-decorator]
def _asked(typingctx: Any) -> Any:
    """Whether the run is to end, as a number."""
    signature = types.int32()

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        word, short = ir.IntType(64), ir.IntType(32)
        module = builder.module
        words = module.globals.get(_SYMBOL)
        if words is None:
            words = ir.GlobalVariable(module, ir.ArrayType(word, WORDS), _SYMBOL)
            words.linkage = "external"
        at = lambda i: builder.gep(words, [ir.Constant(short, 0), ir.Constant(short, i)])  # noqa: E731

        def load(i: int) -> Any:
            loaded = builder.load(at(i))  # type: ignore[no-untyped-call]
            loaded.volatile = True
            return loaded

        result = builder.alloca(short)
        builder.store(ir.Constant(short, 1), result)
        with builder.if_then(builder.icmp_signed("==", load(FLAG), ir.Constant(word, 0))):
            builder.store(ir.Constant(short, 0), result)
            left = builder.sub(load(COUNT), ir.Constant(word, 1))
            builder.store(left, at(COUNT))  # type: ignore[no-untyped-call]
            with builder.if_then(builder.icmp_signed("<=", left, ir.Constant(word, 0)), likely=False):
                builder.store(ir.Constant(word, QUESTIONS), at(COUNT))  # type: ignore[no-untyped-call]
                now = builder.alloca(word, size=2)
                builder.store(load(DUE), now)
                clock = load(CLOCK)
                with builder.if_then(builder.icmp_signed("!=", clock, ir.Constant(word, 0))):
                    kind = ir.FunctionType(short, [short, word.as_pointer()])
                    builder.call(
                        builder.inttoptr(clock, kind.as_pointer()), [builder.trunc(load(CLOCK_ID), short), now]
                    )
                    seconds, rest = (builder.load(builder.gep(now, [ir.Constant(word, i)])) for i in (0, 1))
                    whole = builder.add(builder.mul(seconds, ir.Constant(word, 1_000_000_000)), rest)
                    builder.store(whole, now)
                with builder.if_then(builder.icmp_signed(">=", builder.load(now), load(DUE))):
                    kind = ir.FunctionType(short, [])
                    pending = builder.call(builder.inttoptr(load(SIGNALS), kind.as_pointer()), [])
                    with builder.if_then(builder.icmp_signed("!=", pending, ir.Constant(short, 0)), likely=False):
                        fetch = ir.FunctionType(ir.VoidType(), [word.as_pointer()] * 3)
                        places = [at(RAISED + i) for i in range(3)]  # type: ignore[no-untyped-call]
                        builder.call(builder.inttoptr(load(FETCH), fetch.as_pointer()), places)
                    builder.store(builder.call(builder.inttoptr(load(ASK), kind.as_pointer()), []), result)
        return builder.load(result)

    return signature, codegen


@kernel
def stopped() -> bool:
    """Whether the run is to end: asked in every loop of a kernel that may take long."""
    return bool(_asked() != 0)


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

    def look(self) -> None:
        """Check the limits."""
        if self.reason is not None:
            return
        if self._end is not None and time.perf_counter() >= self._end:
            self.reason = f"the time limit of {self.limit:g} s was reached"
        elif self._footprint is not None:
            self.reason = self._footprint.excess()

    def interrupt(self, cause: BaseException) -> None:
        """Take what a signal's handler raised."""
        if self.reason is None:
            self.cause, self.reason = cause, "interrupted"


_local = threading.local()
#: One kernel at a time: while one calls into Python another thread may want to begin.
_turn = threading.RLock()


def _ask() -> int:
    """Python's part of :func:`stopped`, after signals have been handled."""
    watch: Watch = present() or getattr(_local, "active", None) or Watch()
    try:
        if _words[RAISED] != 0:
            watch.interrupt(_raised())
        watch.look()
        if watch.tell is not None:
            watch.tell()
        _words[DUE] = _now() + EVERY
    except BaseException as error:  # of a signal that came just now
        watch.interrupt(error)
    _words[FLAG] = watch.reason is not None
    return int(_words[FLAG])


def _raised() -> BaseException:
    """The exception that the kernel has fetched; goes on its way when the kernel has returned."""
    taken: list[Any] = [None if word == 0 else _object_at(int(word)) for word in _words[RAISED:]]
    _words[RAISED:] = 0
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


def _address(function: Any) -> int:
    return ctypes.cast(function, ctypes.c_void_p).value or 0


_callback = ctypes.PYFUNCTYPE(ctypes.c_int32)(_ask)
_words[ASK] = _address(_callback)
_words[SIGNALS], _words[FETCH] = _address(ctypes.pythonapi.PyErr_CheckSignals), _address(ctypes.pythonapi.PyErr_Fetch)


def _find_clock() -> Callable[[], int]:
    """Let kernels read the clock themselves where the system has one; elsewhere they call back more often."""
    try:
        address, number = _address(ctypes.CDLL(None).clock_gettime), time.CLOCK_MONOTONIC
    except (AttributeError, TypeError, OSError):
        return lambda: 0
    _words[CLOCK], _words[CLOCK_ID] = address, number
    return lambda: time.clock_gettime_ns(number)


_now = _find_clock()


def watched(function: Callable[..., _Result], *arguments: Any) -> _Result:
    """Call an entry, to be ended by the watch of the present run.

    Outside of :func:`watching` what a signal's handler raised is raised here; inside, :func:`ended` tells.
    """
    watch = present()
    own = watch if watch is not None else Watch()
    with _turn:
        before = getattr(_local, "active", None), int(_words[FLAG]), int(_words[DUE])
        _local.active = own
        _words[FLAG], _words[DUE] = own.reason is not None, _now() + EVERY
        try:
            return function(*arguments)
        finally:
            _local.active, _words[FLAG], _words[DUE] = before
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
