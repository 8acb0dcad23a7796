"""What compiling and loading kernels costs, and a line on the terminal where something really is compiled."""

from __future__ import annotations

import time
from types import TracebackType
from typing import Any, Self

from numba.core import event

from fricmb.integrate.compile.cache_files import say


class CompileWatch:
    """Context that measures the time numba spends compiling kernels or loading them from its cache.

    The first compilation (not a load from the cache) writes a line to stderr.

    Attributes
    ----------
    seconds : float
        Compiling and loading since the context was entered.
    compiled : bool
        Whether something was compiled.
    """

    def __init__(self) -> None:
        self.seconds = 0.0
        self.compiled = False
        self._lock = _LockTimer(self)
        self._passes = _FirstPass(self)

    def __enter__(self) -> Self:
        event.register("numba:compiler_lock", self._lock)  # type: ignore[no-untyped-call]
        event.register("numba:run_pass", self._passes)  # type: ignore[no-untyped-call]
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        event.unregister("numba:run_pass", self._passes)  # type: ignore[no-untyped-call]
        event.unregister("numba:compiler_lock", self._lock)  # type: ignore[no-untyped-call]


class _LockTimer(event.Listener):
    """Adds up the time under numba's compiler lock, which both compiling and loading take."""

    def __init__(self, watch: CompileWatch) -> None:
        self._watch = watch
        self._depth = 0
        self._since = 0.0

    def on_start(self, event: Any) -> None:
        if self._depth == 0:
            self._since = time.perf_counter()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        self._depth -= 1
        if self._depth == 0:
            self._watch.seconds += time.perf_counter() - self._since


class _FirstPass(event.Listener):
    """Tells the user once; a compiler pass runs only where the cache had nothing."""

    _told = False

    def __init__(self, watch: CompileWatch) -> None:
        self._watch = watch

    def on_start(self, event: Any) -> None:
        self._watch.compiled = True
        if not _FirstPass._told:
            _FirstPass._told = True
            say("compiling for the first time on this machine; later runs take it from the cache")

    def on_end(self, event: Any) -> None:
        """Nothing to do: the time is taken under the lock."""
