"""Many runs of one scene with different values."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

from fricmb._calls import answers
from fricmb._simulate import simulate
from fricmb._simulate._arguments import check_options, check_scene
from fricmb._simulate._progress import bar
from fricmb._sweep._check import MANY, check_runs
from fricmb._sweep._results import SweepResults
from fricmb._sweep._store import Store
from fricmb._sweep._workers import Job, ReduceError, Runs, outcomes
from fricmb._version import installed_version
from fricmb.errors import IntegrationError, SceneError, unknown_name
from fricmb.integrate.compile.cache_files import say
from fricmb.integrate.run.ending_signals import as_interrupts
from fricmb.scene import parameter_unit
from fricmb.solution import Solution, owner_of


@answers
def sweep(
    scene: Any,
    runs: Iterable[Mapping[str, Any]],
    *,
    t_end: float,
    reduce: Callable[[Solution], Any] | str | Sequence[str] | None = None,
    workers: Any = None,
    progress: bool = True,
    store: str | PathLike[str] | None = None,
    parameters: Mapping[str, Any] | None = None,
    run_limit: float | None = None,
    **options: Any,
) -> SweepResults:
    """Simulate a scene once for each set of values, on all cores or on a cluster.

    Parameters
    ----------
    scene : Scene
    runs : iterable of dict
        Values by the names of ``scene.parameters``, one dict a run.
    t_end : float
    reduce : callable, name or list of names, optional
        ``reduce(sol)`` runs in the worker, and what it returns takes the place of the solution: send back what you need
        rather than all of it.  The name of a signal stands for ``sol[name]``, several for a dict of them.
    workers : int, "threads", concurrent.futures.Executor or dask.distributed.Client, optional
        Number of processes (1: in this one; default: the cores), or what runs them.  A function or a law that is
        defined in a script can be sent to processes that are forked, or that import the script.  With "threads", as
        many as there are cores, nothing is sent: ``reduce`` and laws may be defined anywhere, and solutions stay where
        they were made; the part of a run in Python, a third of a short one, is done by one thread at a time.
    progress : bool
        Show a bar on the terminal.
    store : path, optional
        A folder that keeps each result as it comes in.  The same sweep with the same store goes on where it stopped;
        a run is made again where scene, values, options, ``reduce``, a law, or a function or global that these use has
        changed.  Changes that cannot be followed, as of a file that ``reduce`` reads, go unnoticed; a warning is given
        where such a use is seen.  Several sweeps may write to it at once.  Numbers, words, arrays, and lists and dicts
        of them are kept as data, other results as pickles, which are read only where nobody else can write.
    parameters : dict, optional
        Values that all runs share; those of a run win.
    run_limit : float, optional
        Seconds that a run may take with its ``reduce``; then its process is ended, and an IntegrationError stands in
        its place.  Likewise a process that dies costs its own run alone.
    **options
        As :func:`fricmb.simulate`.

    Returns
    -------
    SweepResults
        A list in the order of ``runs``: solutions, what ``reduce`` made of them, or, for a run that failed or whose
        ``reduce`` raised, an IntegrationError.  It knows the values of each run, as a table and in pictures.

    Raises
    ------
    SceneError
        For a wrong name or value, before anything is run.
    KeyboardInterrupt
        After Ctrl-C, SIGTERM or SIGHUP, once the runs under way are done (at once after a second one).  The attribute
        ``results`` of this, and of any other error that ends the sweep, holds those made so far, and None for others.
    """
    check_scene(scene)
    check_options("sweep", options, simulate, "t_end", "parameters", call=sweep)
    if isinstance(runs, str | Mapping) or not isinstance(runs, Iterable):
        raise SceneError(f"runs: got {runs!r}; expected a list of dicts of parameter names and values, one a run")
    own = [dict(_checked(run, i)) for i, run in enumerate(runs)]
    values = [{**(parameters or {}), **run} for run in own]
    check_runs(scene, values, progress)
    chosen = _reducer(scene, reduce)
    if run_limit is not None and not (isinstance(run_limit, int | float) and run_limit > 0):
        raise SceneError(f"run_limit: got {run_limit!r}; expected a number of seconds > 0, or None")
    job = Job(scene=scene, reduce=chosen, options={"t_end": t_end, **options})
    kept = None if store is None else Store(store, (installed_version(), scene, chosen, job.options))
    units = {name: parameter_unit(scene, name) for run in own for name in run}
    results = SweepResults([None] * len(values), values=own, units=units)
    try:
        with as_interrupts():
            fill(job, values, results, kept, progress, workers, run_limit)
    except BaseException as stop:
        stop.results = results  # type: ignore[attr-defined]
        raise
    finally:
        if kept is not None:
            kept.close()
    return results


def fill(
    job: Runs, values: list[dict[str, Any]], results: list[Any], kept: Store | None, progress: bool,
    workers: Any, run_limit: float | None,
) -> None:  # fmt: skip
    """Fill in results, those that were kept and those that are made."""
    missing = dict(enumerate(values))
    if kept is not None:
        with bar(len(values), "run", "kept", progress and len(values) > MANY) as shown:
            for i, result in kept.among(values, shown.update):
                results[i] = result
                del missing[i]
    made = outcomes(job, dict(missing), workers, run_limit)
    broken: list[ReduceError] = []
    with bar(len(values), "run", "sweep", progress, done=len(values) - len(missing)) as shown:
        try:
            for i, result in made:
                results[i] = result
                del missing[i]
                if isinstance(result, ReduceError):
                    broken.append(result)
                    if len(broken) == 1:
                        say(f"a run of the sweep has no result: {result.reason}; {values[i]!r}")
                elif kept is not None and not _is_lost(result):
                    kept.put(values[i], result)
                shown.update()
        except KeyboardInterrupt:
            done = f"{len(values) - len(missing)} of {len(values)} runs are done"
            where = "nowhere: give store=" if kept is None else f"in {kept.path}"
            say(f"interrupted: {done}, kept {where}{'' if kept is None else '; the same call goes on from there'}")
            raise
    if len(broken) > 1:
        say(f"reduce raised in {len(broken)} of {len(values)} runs, which have no result; {broken[0].reason}")


@dataclass(frozen=True)
class _Signals:
    """Signals of a run by their names."""

    names: str | tuple[str, ...]

    def __call__(self, sol: Solution) -> Any:
        return sol[self.names] if isinstance(self.names, str) else {name: sol[name] for name in self.names}


def _reducer(scene: Any, reduce: Any) -> Callable[[Solution], Any] | None:
    """What makes a result of a run."""
    if reduce is None:
        return None
    if callable(reduce):
        found: Callable[[Solution], Any] = reduce
        return found
    several = isinstance(reduce, list | tuple) and reduce and all(isinstance(name, str) for name in reduce)
    if several or isinstance(reduce, str):
        for name in reduce if several else [reduce]:
            owner = owner_of(name) or name
            if owner not in scene and not scene.has_motion(owner):
                known = [*scene.motion_names, *(part.name for part in scene.parts)]
                raise unknown_name("signal in reduce", name, known)
        return _Signals(tuple(reduce) if several else reduce)
    raise SceneError(f"reduce: got {reduce!r}; expected a function of a Solution, names of signals, or None")


def _is_lost(result: Any) -> bool:
    """Whether a run was ended from outside, so that another try is worth while."""
    return isinstance(result, IntegrationError) and getattr(result, "lost", False)


def _checked(run: Any, i: int) -> Mapping[str, Any]:
    if not isinstance(run, Mapping):
        raise SceneError(f"runs: entry {i} is {run!r}; expected a dict of parameter names and values")
    return run
