"""Where the runs of a sweep are made: in this process or its threads, in others on this machine, on a dask cluster."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Any, Protocol

from fricmb._simulate import simulate
from fricmb._simulate._blas import blas_threads
from fricmb._sweep._processes import lost, run_in_processes
from fricmb._sweep._threads import run_in_threads
from fricmb.errors import FricmbError, IntegrationError, SceneError, shown
from fricmb.integrate.compile.cache_files import say
from fricmb.solution import Solution


class ReduceError(IntegrationError):
    """What stands in the place of a run whose ``reduce`` raised; not kept in a store."""


class Runs(Protocol):
    """What is made once for each set of values."""

    @property
    def scene(self) -> Any: ...

    def run(self, parameters: Mapping[str, Any]) -> Any:
        """What one set of values gives."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """What all runs of a sweep share."""

    scene: Any
    reduce: Callable[[Solution], Any] | None
    options: Mapping[str, Any]

    def run(self, parameters: Mapping[str, Any]) -> Any:
        """One run: what ``reduce`` makes of its solution, or the IntegrationError that it or ``reduce`` ended in."""
        try:
            sol = simulate(self.scene, parameters=parameters, **self.options)
        except IntegrationError as error:
            return error
        if self.reduce is None:
            return sol
        try:
            return self.reduce(sol)
        except Exception as error:
            return _failed(error, sol.t_end, parameters)


def _failed(error: Exception, t: float, parameters: Mapping[str, Any]) -> ReduceError:
    """What is left of an error of ``reduce``: its words and the line that raised it, which can be sent."""
    line = traceback.extract_tb(error.__traceback__)[-1]
    reason = f"reduce raised {type(error).__name__}: {error} ({line.filename}, line {line.lineno})"
    return ReduceError(f"the run {dict(parameters)!r} has no result: {reason}", t=t, reason=reason)


#: What asks for threads of this process, as many as there are cores.
THREADS = "threads"
#: Outcomes as they come in: number of the run and its result.
Outcomes = Iterator[tuple[int, Any]]


def outcomes(job: Runs, runs: Mapping[int, dict[str, Any]], workers: Any, limit: float | None = None) -> Outcomes:
    """Make the runs with ``workers``: None (as many processes as cores), a number, "threads", an Executor or a Client.

    ``limit``: seconds that a run may take, in processes of this machine.
    """
    if not runs:
        return iter(())
    if limit is not None and (_is_threads(workers) or isinstance(workers, Executor) or _is_dask_client(workers)):
        raise SceneError("run_limit: only processes that the sweep starts itself can be ended; leave workers out")
    if isinstance(workers, Executor):
        return _executor(job, runs, workers)
    if _is_dask_client(workers):
        return _dask(job, runs, workers)
    if _is_threads(workers):
        return _threads(job, runs)
    if workers is None:
        workers = _cores()
    if isinstance(workers, bool) or not isinstance(workers, int) or workers < 1:
        raise SceneError(
            f"workers: got {shown(workers)};"
            f" expected None, a number of processes (at least 1), {THREADS!r}, an Executor of "
            "concurrent.futures or a dask.distributed.Client"
        )
    workers = min(workers, len(runs))
    return _here(job, runs) if workers == 1 and limit is None else run_in_processes(job.run, runs, workers, limit)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1


def _here(job: Runs, runs: Mapping[int, dict[str, Any]]) -> Outcomes:
    for i, parameters in runs.items():
        yield i, job.run(parameters)


def _is_threads(workers: Any) -> bool:
    return isinstance(workers, str) and workers == THREADS


def _threads(job: Runs, runs: Mapping[int, dict[str, Any]]) -> Outcomes:
    with blas_threads(job.scene):  # of the process, so for all runs at once
        yield from run_in_threads(job.run, runs, _cores())


def _executor(job: Runs, runs: Mapping[int, dict[str, Any]], executor: Executor) -> Outcomes:
    futures = {executor.submit(job.run, parameters): i for i, parameters in runs.items()}
    try:
        for future in as_completed(futures):
            yield futures[future], future.result()
    except BrokenProcessPool as error:
        raise FricmbError(
            "a process of workers ended before its run did (out of memory?), and with it the Executor; processes that "
            "the sweep starts itself (workers=4) cost the one run alone"
        ) from error
    finally:
        for future in futures:
            future.cancel()


def _is_dask_client(workers: Any) -> bool:
    distributed = sys.modules.get("distributed")
    return distributed is not None and isinstance(workers, distributed.Client)


def _run(job: Runs, parameters: Mapping[str, Any]) -> Any:
    return job.run(parameters)


def _dask(job: Runs, runs: Mapping[int, dict[str, Any]], client: Any) -> Outcomes:
    """The job is sent to the cluster once; an interrupted sweep takes its runs back."""
    import distributed

    shared = client.scatter(job, broadcast=True, hash=False)
    futures = {client.submit(_run, shared, parameters, pure=False): i for i, parameters in runs.items()}
    try:
        for future in distributed.as_completed(list(futures)):  # type: ignore[no-untyped-call]
            i, error = futures[future], future.exception() if future.status == "error" else None
            if error is None:
                yield i, future.result()
            elif isinstance(error, distributed.scheduler.KilledWorker):
                say(f"a run of the sweep has no result: {error}; {runs[i]!r}")
                yield i, lost(f"its worker was killed: {error}", runs[i])
            else:
                raise error
    finally:
        client.cancel([future for future in futures if not future.done()])
