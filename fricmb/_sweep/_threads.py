"""Runs of a sweep in threads of this process: kernels let go of Python's lock, and nothing is sent anywhere."""

from __future__ import annotations

import signal
import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from queue import Empty, SimpleQueue
from typing import Any, TypeVar

from fricmb.integrate.compile.cache_files import say
from fricmb.integrate.run.stop import ended_by

_Thing = TypeVar("_Thing")

#: Seconds between looks for Ctrl-C, which not every system lets wake a thread that waits.
_LOOK = 0.1


def run_in_threads(
    run: Callable[[Mapping[str, Any]], Any], runs: Mapping[int, Mapping[str, Any]], count: int
) -> Iterator[tuple[int, Any]]:
    """Outcomes as they come in: number of the run, and its result or IntegrationError.

    On Ctrl-C no further run is begun, and those under way are waited for; on a second one they are ended.
    """
    waiting, stop = deque(runs.items()), threading.Event()
    found: SimpleQueue[tuple[int, bool, Any] | None] = SimpleQueue()  # None: a thread has ended

    def work() -> None:
        try:
            with ended_by(stop):
                while (task := _next(waiting)) is not None:
                    number, parameters = task
                    try:
                        found.put((number, True, run(parameters)))
                    except BaseException as error:  # raised where the sweep was called
                        found.put((number, False, error))
        finally:
            found.put(None)

    threads = [threading.Thread(target=work, name="fricmb sweep") for _ in range(min(count, len(runs)))]
    with _counted_interrupts() as interrupts:
        busy, said = len(threads), False
        try:
            for thread in threads:
                thread.start()
            while busy:
                if interrupts and not said:
                    said = True
                    waiting.clear()
                    say(f"interrupted: waiting for {busy} runs under way; Ctrl-C again ends them at once")
                if len(interrupts) > 1:
                    raise KeyboardInterrupt
                try:
                    result = found.get(timeout=_LOOK)
                except Empty:
                    continue
                if result is None:
                    busy -= 1
                else:
                    yield _good(*result)
        finally:
            waiting.clear()
            stop.set()
            for thread in threads:
                if thread.ident is not None:  # where not all could be started
                    thread.join()
    if interrupts:
        raise KeyboardInterrupt


@contextmanager
def _counted_interrupts() -> Iterator[list[int]]:
    """One entry for each Ctrl-C inside, which raises nothing.

    Raised between any two steps, it would lose a result or leave a lock of the threads in a state of its own.  The list
    stays empty in other threads than the main one, and where the user has a handler of their own.
    """
    interrupts: list[int] = []
    main = threading.current_thread() is threading.main_thread()
    if not (main and signal.getsignal(signal.SIGINT) is signal.default_int_handler):
        yield interrupts
        return
    signal.signal(signal.SIGINT, lambda number, frame: interrupts.append(number))
    try:
        yield interrupts
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _next(things: deque[_Thing]) -> _Thing | None:
    """Take one that nobody has taken."""
    try:
        return things.popleft()
    except IndexError:
        return None


def _good(number: int, good: bool, result: Any) -> tuple[int, Any]:
    if not good:
        raise result
    return number, result
