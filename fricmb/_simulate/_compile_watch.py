"""What compiling and loading kernels costs, and a line on the terminal where something really is compiled."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, Self

from numba.core import event

from fricmb.integrate.compile.cache_files import missing_at_install, say
from fricmb.integrate.compile.kernel_cache import on_miss

#: Lines on what was compiled of scenes that a process writes: who makes a new formula for each value is told by these.
_MOST = 3


class CompileWatch:
    """Context that measures the time numba spends compiling kernels or loading them from its cache.

    A line on stderr says when the first kernel is compiled, and another one what was compiled and how long that took.

    Attributes
    ----------
    seconds : float
        Compiling and loading since the context was entered.
    compiled : bool
        Whether something was compiled.
    """

    _told_kernels = False
    _told = 0

    def __init__(self) -> None:
        self.seconds = 0.0
        self.compiled = False
        self._parts: dict[str, None] = {}
        self._kernels: set[str] = set()
        self._others: set[str] = set()
        self._begin = 0.0
        self._lock = _LockTimer(self)
        self._passes = _Passes(self)

    def __enter__(self) -> Self:
        event.register("numba:compiler_lock", self._lock)  # type: ignore[no-untyped-call]
        event.register("numba:run_pass", self._passes)  # type: ignore[no-untyped-call]
        on_miss.append(self.take)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        on_miss.remove(self.take)
        event.unregister("numba:run_pass", self._passes)  # type: ignore[no-untyped-call]
        event.unregister("numba:compiler_lock", self._lock)  # type: ignore[no-untyped-call]
        if self.compiled and (self._kernels or CompileWatch._told < _MOST):
            CompileWatch._told += not self._kernels
            many = len(self._kernels)
            what = [f"{many} kernel{'s' if many > 1 else ''}"] if many else []
            what += [f"{', '.join(self._parts)} of this scene"] if self._parts else []
            what += [f"your {', '.join(sorted(self._others))}"] if self._others else []
            say(
                f"compiled {' and '.join(what) or 'functions'} in {self.seconds - self._begin:.1f} s; later runs take"
                " what is compiled from the cache"
            )

    def take(self, function: Any) -> None:
        """Note that a function is compiled: of the package, of a part of the scene, or of the user."""
        module, name = function.__module__, function.__qualname__
        self._note()
        if module.startswith("fricmb_template_"):
            # what is derived for a type begins with its name
            self._parts[(getattr(sys.modules.get(module), "__doc__", None) or "a part").partition(":")[0]] = None
        elif module.startswith("fricmb."):
            self._kernels.add(f"{module}.{name}")
            if not CompileWatch._told_kernels:
                CompileWatch._told_kernels = True
                say(f"compiling kernels for runs of this kind, which may take a minute ({missing_at_install()})")
        else:
            self._others.add(name)

    def _note(self) -> None:
        if not self.compiled:
            self.compiled, self._begin = True, self.seconds


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


class _Passes(event.Listener):
    """Tells the watch of functions that are not kept by content; numba's passes run where its cache had nothing."""

    def __init__(self, watch: CompileWatch) -> None:
        self._watch = watch

    def on_start(self, event: Any) -> None:
        self._watch._note()

    def on_end(self, event: Any) -> None:
        """Nothing to do: the time is taken under the lock."""
