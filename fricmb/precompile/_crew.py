"""Several processes that work off one list of tasks."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from itertools import pairwise
from types import TracebackType
from typing import Any

from fricmb.errors import FricmbError
from fricmb.integrate.compile.cache_files import share_temporary
from fricmb.integrate.compile.parallel_compile import ALONE

#: What is called after each task: the task, and its answer.
Report = Callable[[str, dict[str, Any]], None]


class Shares:
    """Tasks in as many stretches as there are workers; who is done takes from the end of the longest one left.

    Neighbours in the list call the same kernels, which each process lowers once: so each keeps to its stretch.  What is
    to be done ``later`` comes in its order once all others are taken.
    """

    def __init__(self, tasks: Sequence[str], workers: int, later: Sequence[str] = ()) -> None:
        ends = [len(tasks) * k // workers for k in range(workers + 1)]
        self._left = [list(tasks[a:b]) for a, b in pairwise(ends)]
        self._later = list(later)
        self._lock = threading.Lock()

    def next(self, worker: int) -> str | None:
        """The next task of a worker; None where all are taken."""
        with self._lock:
            if self._left[worker]:
                return self._left[worker].pop(0)
            longest = max(self._left, key=len)
            if longest:
                return longest.pop()
            return self._later.pop(0) if self._later else None

    def drop(self) -> None:
        """Let nobody begin another task."""
        with self._lock:
            self._left, self._later = [[] for _ in self._left], []


class Crew:
    """Processes that load while their tasks are listed."""

    def __init__(self, workers: int) -> None:
        share_temporary()
        with ExitStack() as begun:
            self._processes = [begun.enter_context(_worker()) for _ in range(workers)]
            self._stack = begun.pop_all()  # had one of them not begun, those before it would be ended here

    def __enter__(self) -> Crew:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for process in self._processes:
            assert process.stdin is not None
            if error is not None:
                process.terminate()
            with suppress(BrokenPipeError):  # of a worker that died
                process.stdin.close()
        self._stack.__exit__(kind, error, trace)

    def work_off(self, tasks: Sequence[str], report: Report, later: Sequence[str] = ()) -> None:
        """Do all tasks, then those for ``later``.

        Raises
        ------
        FricmbError
            A process died; the message names the task that it was at.
        """
        shares, lock = Shares(tasks, len(self._processes), later), threading.Lock()
        failed: list[str] = []

        def serve(number: int) -> None:
            while not failed and (task := shares.next(number)) is not None:
                answer = _answer(self._processes[number], task)
                if not answer:
                    failed.append(f"compile: the process compiling {task!r} ended; its last output is above")
                    return
                with lock:
                    report(task, json.loads(answer))

        threads = [threading.Thread(target=serve, args=(number,)) for number in range(len(self._processes))]
        for thread in threads:
            thread.start()
        try:
            for thread in threads:
                thread.join()
        except BaseException:  # Ctrl-C
            shares.drop()
            raise
        if failed:
            raise FricmbError(failed[0])


def _answer(process: subprocess.Popen[str], task: str) -> str:
    """What a worker says of a task; nothing where it died."""
    assert process.stdin is not None
    assert process.stdout is not None
    with suppress(BrokenPipeError, ValueError):  # it died, or was ended, and what leads to it is closed
        print(task, file=process.stdin, flush=True)
        return process.stdout.readline()
    return ""


def _worker() -> subprocess.Popen[str]:
    # -P: a file of the working folder that is called as a module is, is none
    command = [sys.executable, "-P", "-m", "fricmb.precompile._worker"]
    env = {**os.environ, **ALONE, "FRICMB_QUIET": "1"}
    # in a group of its own: Ctrl-C on the terminal is for this process alone, which then ends the others
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, env=env, process_group=0)
