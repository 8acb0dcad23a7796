"""Compiling everything, and putting a copy where it is wanted."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fricmb.integrate.compile.cache_files import cache_folder
from fricmb.precompile._crew import work_off
from fricmb.precompile._tasks import kernels, runs


def compile_all(
    *, processes: int | None = None, into: Path | None = None, report: Callable[[str, int, int], None] | None = None
) -> list[str]:
    """Compile all kernels and what the built-in models need, as far as the cache does not hold it.

    Parameters
    ----------
    processes : int, optional
        How many at once; as many as there are processors where it is not given.
    into : pathlib.Path, optional
        A folder that gets a copy of all files, in the folders "kernels" and "templates".
    report : callable, optional
        Called with what has been done, how many of how many tasks that were.

    Returns
    -------
    list of str
        The files, as room/name.

    Raises
    ------
    FricmbError
        A process that compiles died.
    """
    workers = processes or os.cpu_count() or 1
    stages = (kernels(), runs())
    total, done = sum(map(len, stages)), 0
    found: dict[str, set[str]] = {}

    def take(task: str, answer: dict[str, Any]) -> None:
        nonlocal done
        done += 1
        for room, names in answer["files"].items():
            found.setdefault(room, set()).update(names)
        if report is not None:
            report(task, done, total)

    for tasks in stages:  # the runs find the kernels there
        work_off(tasks, min(workers, len(tasks)), take)
    if into is not None:
        for room, names in found.items():
            _copy(cache_folder(room), Path(into) / room, names)
    return sorted(f"{room}/{name}" for room, names in found.items() for name in names)


def _copy(source: Path, target: Path, names: set[str]) -> None:
    target.mkdir(parents=True, exist_ok=True)
    for name in names:
        shutil.copyfile(source / name, target / name)
