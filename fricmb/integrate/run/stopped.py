"""Whether a kernel is to end: what loops that may take long ask, and the words that each thread shares with them.

Kernels of several threads run at the same time, and each is ended by its own run: where a thread keeps its words is
found as the system keeps what belongs to a thread (``pthread_getspecific``, on Windows ``TlsGetValue``).
"""

from __future__ import annotations

import ctypes
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import llvmlite.binding
import numpy as np
from llvmlite import ir
from numba import types
from numba.core.cgutils import alloca_once
from numba.extending import intrinsic

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Ints

#: Words that all threads share: address and number of the clock; addresses of what handles signals, of what fetches an
#: exception, of what takes and gives back Python's lock, of the call into Python, and of what finds a thread's words,
#: with the key under which they are kept.
CLOCK, CLOCK_ID, SIGNALS, FETCH, TAKE, GIVE, ASK, FIND, KEY = range(9)
SHARED = KEY + 1
#: Words of a thread: flag, questions until the next look at the clock, when the next call into Python is due
#: (nanoseconds); type, value and traceback of an exception that was fetched.
FLAG, COUNT, DUE, RAISED = range(4)
OWN = RAISED + 3
#: Questions between two looks at the clock; nanoseconds between two calls into Python; when one is due in a kernel that
#: is not watched, as where rows are sampled: what a signal's handler raised would be lost there.
QUESTIONS, EVERY, NEVER = 4, 50_000_000, 1 << 62
_SYMBOL = "fricmb_shared_words"
_shared = np.zeros(SHARED, dtype=np.int64)
llvmlite.binding.add_symbol(_SYMBOL, _shared.ctypes.data)
_WORD, _SHORT = ir.IntType(64), ir.IntType(32)


class _Words:
    """Reads and writes words at an address in the code of a kernel, and calls what stands at one of them."""

    def __init__(self, builder: Any, address: Any) -> None:
        self._builder, self._address = builder, address

    def at(self, i: int) -> Any:
        """Where a word is."""
        return self._builder.gep(self._address, [ir.Constant(_WORD, i)])

    def load(self, i: int) -> Any:
        """A word, which another thread or Python may have changed."""
        loaded = self._builder.load(self.at(i))
        loaded.volatile = True
        return loaded

    def store(self, value: Any, i: int) -> None:
        """Change a word."""
        self._builder.store(value, self.at(i))

    def call(self, i: int, result: Any, *arguments: Any) -> Any:
        """Call the function whose address is kept."""
        kind = ir.FunctionType(result, [argument.type for argument in arguments])
        return self._builder.call(self._builder.inttoptr(self.load(i), kind.as_pointer()), list(arguments))


def _shared_words(builder: Any) -> _Words:
    module = builder.module
    words = module.globals.get(_SYMBOL)
    if words is None:
        words = ir.GlobalVariable(module, ir.ArrayType(_WORD, SHARED), _SYMBOL)
        words.linkage = "external"
    return _Words(builder, builder.bitcast(words, _WORD.as_pointer()))


@intrinsic  # type: ignore[untyped-decorator]
def _asked(typingctx: Any) -> Any:
    """Whether the run is to end, as a number."""
    signature = types.int32()

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        shared = _shared_words(builder)
        result = alloca_once(builder, _SHORT)
        builder.store(ir.Constant(_SHORT, 0), result)
        address = shared.call(FIND, _WORD.as_pointer(), shared.load(KEY))
        own = _Words(builder, address)
        known = builder.icmp_unsigned("!=", builder.ptrtoint(address, _WORD), ir.Constant(_WORD, 0))
        with builder.if_then(known, likely=True):
            builder.store(ir.Constant(_SHORT, 1), result)
            with builder.if_then(builder.icmp_signed("==", own.load(FLAG), ir.Constant(_WORD, 0)), likely=True):
                builder.store(ir.Constant(_SHORT, 0), result)
                left = builder.sub(own.load(COUNT), ir.Constant(_WORD, 1))
                own.store(left, COUNT)
                with builder.if_then(builder.icmp_signed("<=", left, ir.Constant(_WORD, 0)), likely=False):
                    own.store(ir.Constant(_WORD, QUESTIONS), COUNT)
                    with builder.if_then(_is_due(builder, shared, own)):
                        builder.store(_call_into_python(builder, shared, own), result)
        return builder.load(result)

    return signature, codegen


def _is_due(builder: Any, shared: _Words, own: _Words) -> Any:
    """Whether the next call into Python is due; where kernels cannot read the clock it always is."""
    now = alloca_once(builder, _WORD, size=2)
    builder.store(own.load(DUE), now)
    with builder.if_then(builder.icmp_signed("!=", shared.load(CLOCK), ir.Constant(_WORD, 0))):
        shared.call(CLOCK, _SHORT, builder.trunc(shared.load(CLOCK_ID), _SHORT), now)
        seconds, rest = (builder.load(builder.gep(now, [ir.Constant(_WORD, i)])) for i in (0, 1))
        builder.store(builder.add(builder.mul(seconds, ir.Constant(_WORD, 1_000_000_000)), rest), now)
    return builder.icmp_signed(">=", builder.load(now), own.load(DUE))


def _call_into_python(builder: Any, shared: _Words, own: _Words) -> Any:
    """Let signals be handled, fetch what their handlers raised, and ask; Python's lock is taken where it was let go."""
    held = shared.call(TAKE, _SHORT)
    pending = shared.call(SIGNALS, _SHORT)
    with builder.if_then(builder.icmp_signed("!=", pending, ir.Constant(_SHORT, 0)), likely=False):
        shared.call(FETCH, ir.VoidType(), *[own.at(RAISED + i) for i in range(3)])
    shared.call(GIVE, ir.VoidType(), held)
    return shared.call(ASK, _SHORT)


@kernel
def stopped() -> bool:
    """Whether the run is to end: asked in every loop of a kernel that may take long."""
    return bool(_asked() != 0)


def _address(function: Any) -> int:
    return ctypes.cast(function, ctypes.c_void_p).value or 0


def _find_clock() -> Callable[[], int]:
    """Let kernels read the clock themselves where the system has one; elsewhere they call back more often."""
    try:
        address, number = _address(ctypes.CDLL(None).clock_gettime), time.CLOCK_MONOTONIC
    except (AttributeError, TypeError, OSError):
        return lambda: 0
    _shared[CLOCK], _shared[CLOCK_ID] = address, number
    return lambda: time.clock_gettime_ns(number)


def _find_store() -> Callable[[int], None]:
    """Let kernels find the words of their thread; returns what keeps an address for the present thread."""
    if sys.platform == "win32":
        system = ctypes.windll.kernel32
        _shared[KEY], _shared[FIND] = system.TlsAlloc(), _address(system.TlsGetValue)
        return lambda address: system.TlsSetValue(int(_shared[KEY]), ctypes.c_void_p(address))
    system, key = ctypes.CDLL(None), ctypes.c_size_t(0)
    if system.pthread_key_create(ctypes.byref(key), None) != 0:
        raise OSError("the system has no place left for what belongs to a thread")
    _shared[KEY], _shared[FIND] = key.value, _address(system.pthread_getspecific)
    return lambda address: system.pthread_setspecific(ctypes.c_size_t(key.value), ctypes.c_void_p(address))


now = _find_clock()
_keep = _find_store()
_local = threading.local()
_python = ctypes.pythonapi
_shared[SIGNALS], _shared[FETCH] = _address(_python.PyErr_CheckSignals), _address(_python.PyErr_Fetch)
_shared[TAKE], _shared[GIVE] = _address(_python.PyGILState_Ensure), _address(_python.PyGILState_Release)


def call_back(ask: Callable[[], int]) -> None:
    """Let kernels call ``ask`` when that is due; ctypes takes Python's lock for it."""
    callback = ctypes.PYFUNCTYPE(ctypes.c_int32)(ask)
    _kept.append(callback)
    _shared[ASK] = _address(callback)


#: What kernels call has to stay.
_kept: list[Any] = []


def own_words() -> Ints:
    """The words of the present thread."""
    words: Ints | None = getattr(_local, "words", None)
    if words is None:
        words = _local.words = np.zeros(OWN, dtype=np.int64)
        words[DUE] = NEVER
        _keep(words.ctypes.data)
    return words
