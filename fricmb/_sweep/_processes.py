"""Runs of a sweep in processes of this machine, each of which may die or be ended without the sweep.

A process gets the job once and runs one by one.  It ends with its parent, leaves Ctrl-C to it, and where it dies a new
one takes its place; the run it was at counts as failed.
"""

from __future__ import annotations

import contextlib
import ctypes
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from multiprocessing import connection
from typing import Any

from fricmb.errors import FricmbError, IntegrationError
from fricmb.integrate.compile.cache_files import say, share_temporary

#: A run: from its parameters to its result.
Run = Callable[[Mapping[str, Any]], Any]
#: Seconds between looks at the clock.
_LOOK = 0.5
_READY = -1
#: The signal that ends a process where memory is short; Windows has none of that name.
_KILLED = getattr(signal, "SIGKILL", 9)


def lost(why: str, parameters: Mapping[str, Any]) -> IntegrationError:
    """What stands in the place of a run that was ended from outside; not kept in a store."""
    error = IntegrationError(f"the run {dict(parameters)!r} has no result: {why}", t=0.0, reason=why)
    error.lost = True  # type: ignore[attr-defined]
    return error


class _Worker:
    """A process and the run it is at."""

    def __init__(self, run: Run) -> None:
        context = multiprocessing.get_context()
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_work, args=(theirs, run, os.getpid()), daemon=True)
        self.process.start()
        theirs.close()
        self.ready = False
        self.at: int | None = None
        self.since = 0.0

    def give(self, number: int, parameters: Mapping[str, Any]) -> None:
        """Hand a run over."""
        self.at, self.since = number, time.monotonic()
        with contextlib.suppress(OSError):  # it has died: seen when its pipe is read
            self.pipe.send((number, parameters))

    def end(self) -> str:
        """End the process; says how it ended."""
        self.pipe.close()
        self.process.kill()
        self.process.join()
        code = self.process.exitcode
        self.process.close()
        if code == -_KILLED:
            return "its process was killed (out of memory?)"
        return f"its process ended with {'signal' if code and code < 0 else 'status'} {abs(code or 0)}"


def run_in_processes(
    run: Run, runs: Mapping[int, Mapping[str, Any]], count: int, limit: float | None
) -> Iterator[tuple[int, Any]]:
    """Outcomes as they come in: number of the run, and its result or IntegrationError.

    On Ctrl-C no further run is begun, and those under way are waited for; on a second one all processes end at once.
    """
    waiting = list(runs)[::-1]
    share_temporary()
    workers = [_Worker(run) for _ in range(count)]
    stopped = False
    try:
        while workers:
            try:
                for worker in [w for w in workers if w.ready and w.at is None]:
                    if waiting and not stopped:
                        number = waiting.pop()
                        worker.give(number, runs[number])
                    else:
                        workers.remove(worker)
                        worker.end()
                if stopped:
                    for worker in [w for w in workers if w.at is None]:
                        workers.remove(worker)
                        worker.end()
                for number, result in _look(workers, limit, runs):
                    yield number, result
                missing = min(count, len(waiting) + sum(w.at is not None for w in workers)) - len(workers)
                workers += [_Worker(run) for _ in range(0 if stopped else missing)]
            except KeyboardInterrupt:
                if stopped:
                    raise
                stopped = True
                busy = sum(w.at is not None for w in workers)
                say(f"interrupted: waiting for {busy} runs under way; Ctrl-C again ends them at once")
    finally:
        for worker in workers:
            worker.end()
    if stopped:
        raise KeyboardInterrupt


def _look(workers: list[_Worker], limit: float | None, runs: Mapping[int, Mapping[str, Any]]) -> list[tuple[int, Any]]:
    """Wait for something to come in; workers that died or took too long are ended and leave the list."""
    found: list[tuple[int, Any]] = []
    if not workers:  # the last has been ended: to wait for nothing takes all the time there is
        return found
    pipes = {worker.pipe: worker for worker in workers}
    for pipe in connection.wait(list(pipes), timeout=_LOOK if limit is None else min(_LOOK, limit / 4)):
        worker = pipes[pipe]  # type: ignore[index]
        try:
            number, good, result = worker.pipe.recv()
        except (EOFError, OSError):
            workers.remove(worker)
            why = worker.end()
            if not worker.ready:
                raise FricmbError(
                    "a worker process of the sweep ended before its first run: a script that starts the sweep outside "
                    "of `if __name__ == '__main__':`?"
                ) from None
            if worker.at is not None:
                say(f"a run of the sweep has no result: {why}; {dict(runs[worker.at])!r}")
                found.append((worker.at, lost(why, runs[worker.at])))
            continue
        if number == _READY:
            worker.ready = True
        elif good:
            worker.at = None
            found.append((number, result))
        else:
            raise result
    for worker in list(workers):
        if limit is not None and worker.at is not None and time.monotonic() - worker.since > limit:
            workers.remove(worker)
            worker.end()
            why = f"it took more than {limit:g} s (run_limit)"
            say(f"a run of the sweep was ended: {why}; {dict(runs[worker.at])!r}")
            found.append((worker.at, lost(why, runs[worker.at])))
    return found


# ---- in the other process


def _work(pipe: Any, run: Run, parent: int) -> None:
    """Run what comes in until the pipe ends."""
    _end_with(parent)
    # the parent takes them, lets runs under way come to their end, and then ends this process
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    if hasattr(os, "setpgrp"):
        os.setpgrp()  # the terminal's Ctrl-C goes to the parent alone
    pipe.send((_READY, True, None))
    while True:
        try:
            number, parameters = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            answer = number, True, run(parameters)
        except BaseException as error:
            answer = number, False, error
        _answer(pipe, answer)


def _answer(pipe: Any, answer: tuple[int, bool, Any]) -> None:
    try:
        pipe.send(answer)
    except (BrokenPipeError, ConnectionError):
        os._exit(1)
    except Exception as error:  # what cannot be sent
        number, good, held = answer
        what = f"what reduce returned, a {type(held).__name__}," if good else f"{type(held).__name__}: {held};"
        pipe.send((number, False, FricmbError(f"{what} cannot be sent from a worker process: {error}")))


def _end_with(parent: int) -> None:
    """Let this process end when its parent does, whatever it is at."""
    if sys.platform == "linux" and multiprocessing.get_start_method() != "forkserver":
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
        if os.getppid() != parent:
            os._exit(1)
    above = multiprocessing.parent_process()

    def watch() -> None:
        if above is not None:
            connection.wait([above.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
