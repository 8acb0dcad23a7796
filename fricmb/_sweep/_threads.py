"""Runs of a sweep in threads of this process: kernels let go of Python's lock, and nothing is sent anywhere."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeVar

from fricmb.integrate.compile.cache_files import say
from fricmb.integrate.run.stop import ended_by

_Thing = TypeVar("_Thing")

#: Seconds between looks for Ctrl-C, which not every system lets wake a thread that waits.
_LOOK = 0.5


def run_in_threads(
    run: Callable[[Mapping[str, Any]], Any], runs: Mapping[int, Mapping[str, Any]], count: int
) -> Iterator[tuple[int, Any]]:
    """Outcomes as they come in: number of the run, and its result or IntegrationError.

    On Ctrl-C no further run is begun, and those under way are waited for; on a second one they are ended.
    """
    waiting, found = deque(runs.items()), deque[tuple[int, bool, Any]]()
    busy, news, stop = set(range(min(count, len(runs)))), threading.Event(), threading.Event()

    def work(me: int) -> None:
        with ended_by(stop):
            while (task := _next(waiting)) is not None:
                number, parameters = task
                try:
                    found.append((number, True, run(parameters)))
                except BaseException as error:  # raised where the sweep was called
                    found.append((number, False, error))
                news.set()
        busy.discard(me)
        news.set()

    threads = [threading.Thread(target=work, name="fricmb sweep", args=(me,)) for me in busy]
    for thread in threads:
        thread.start()
    stopped = False
    try:
        while busy or found:
            try:
                news.wait(_LOOK)
                news.clear()
                while (result := _next(found)) is not None:
                    yield _good(*result)
            except KeyboardInterrupt:
                if stopped:
                    raise
                stopped = True
                waiting.clear()
                say(f"interrupted: waiting for {len(busy)} runs under way; Ctrl-C again ends them at once")
    finally:
        waiting.clear()
        stop.set()
        for thread in threads:
            thread.join()
    if stopped:
        raise KeyboardInterrupt


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
