"""A process that runs cells: what hangs or crashes is ended, and said, without ending the suite.

A process of its own making instead of ``multiprocessing``: that one imports the caller's main module again, which
need not be fit for it.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Callable
from types import TracebackType
from typing import IO, Any, Self


class CellEnded(Exception):
    """A cell whose process had to be ended or died, or that raised what nobody foresaw; the message says which."""


def _serve() -> None:
    """Take (function, arguments) from stdin, answer on what was stdout; prints go to stderr."""
    import warnings

    warnings.simplefilter("ignore")
    _limit_memory()
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while True:
        try:
            function, arguments = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            answer = (True, function(*arguments))
        except Exception as error:
            answer = (False, f"{type(error).__name__}: {' '.join(str(error).split())}")
        pickle.dump(answer, answers)
        answers.flush()


#: Bytes that a process may ask for: a run without end must not take the machine with it.
MEMORY = 8 << 30


def _limit_memory() -> None:
    try:
        import resource
    except ImportError:  # not on this system
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    most = MEMORY if hard == resource.RLIM_INFINITY else min(MEMORY, hard)
    resource.setrlimit(resource.RLIMIT_AS, (most, hard))


def _listen(stream: IO[bytes], answers: queue.Queue[Any]) -> None:
    """Pass answers on until the process is gone, then None."""
    while True:
        try:
            answers.put(pickle.load(stream))
        except (EOFError, pickle.UnpicklingError, OSError, ValueError):
            answers.put(None)
            return


def _ready() -> None:
    """Import what every cell needs: a fresh process is not to be charged for it."""
    import fricmb.bench.stability
    import fricmb.integrate.compile.kernel  # noqa: F401


#: Seconds that a process may take to start.
START = 300.0


class Worker:
    """One process for many cells, so that each kernel is loaded once; started again after a cell that ended it."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._answers: queue.Queue[Any] = queue.Queue()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.end()

    def run(self, function: Callable[..., Any], *arguments: Any, limit: float) -> Any:
        """``function(*arguments)`` in the process; the function has to be importable there.

        Raises
        ------
        CellEnded
            Where it took more than ``limit`` seconds, raised an exception, or the process died.
        """
        fresh = self._process is None
        process = self._started()
        try:
            if fresh:
                self._ask(_ready, (), START)
            answer = self._ask(function, arguments, limit)
        except queue.Empty:
            self.end()
            raise CellEnded(f"not done after {limit:g} s") from None
        except OSError:
            answer = None
        if answer is None:
            code = process.wait()
            self.end()
            raise CellEnded(f"the process died with exit status {code}")
        fine, value = answer
        if not fine:
            raise CellEnded(value)
        return value

    def _ask(self, function: Callable[..., Any], arguments: tuple[Any, ...], limit: float) -> Any:
        """Hand a job over and wait for its answer."""
        process = self._started()
        if process.stdin is not None:
            pickle.dump((function, arguments), process.stdin)
            process.stdin.flush()
        return self._answers.get(timeout=limit)

    def warm(self, *jobs: tuple[Callable[..., Any], tuple[Any, ...]]) -> None:
        """Run jobs whose only purpose is to fill the cache: no limit, and failures do not matter."""
        for function, arguments in jobs:
            with contextlib.suppress(CellEnded):
                self.run(function, *arguments, limit=3600.0)

    def _started(self) -> subprocess.Popen[bytes]:
        if self._process is None:
            command = [sys.executable, "-P", "-c", "from fricmb.bench._worker import _serve; _serve()"]
            self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            self._answers = queue.Queue()
            threading.Thread(target=_listen, args=(self._process.stdout, self._answers), daemon=True).start()
        return self._process

    def end(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            if self._process.stdin is not None:
                with contextlib.suppress(OSError):  # what was still to be written has nobody to read it
                    self._process.stdin.close()
        self._process = None
