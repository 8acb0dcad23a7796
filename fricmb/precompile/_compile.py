"""Compiling everything, and putting a copy where it is wanted."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fricmb.errors import FricmbError
from fricmb.integrate.compile.cache_files import cache_folder, can_be_kept, find_file
from fricmb.precompile._crew import Crew
from fricmb.precompile._tasks import kernels, runs

#: Processes at once: each lowers kernels that others lower too, and comes to hold half a gigabyte.
_MOST = 4


def compile_all(
    *, processes: int | None = None, into: Path | None = None, report: Callable[[str, int, int], None] | None = None
) -> list[str]:
    """Compile all kernels and what the built-in models need, as far as the cache does not hold it.

    Parameters
    ----------
    processes : int, optional
        How many at once; as many as there are processors, but at most 4, where it is not given.
    into : pathlib.Path, optional
        A folder that gets a copy of all files, in the folders "kernels" and "templates".
    report : callable, optional
        Called with what has been done, how many of how many tasks that were.

    Returns
    -------
    list of str
        The files, as kind/name.

    Raises
    ------
    FricmbError
        A process that compiles died, or what it made could not be kept.
    """
    with _folder_to_copy_from() if into is not None else nullcontext():
        found = _work_off(processes or min(os.cpu_count() or 1, _MOST), report)
        for kind, names in found.items():
            kept = {name: _kept(kind, name) for name in names}
            if into is not None:
                _copy(kept, Path(into) / kind)
    return sorted(f"{kind}/{name}" for kind, names in found.items() for name in names)


def _work_off(workers: int, report: Callable[[str, int, int], None] | None) -> dict[str, set[str]]:
    """Compile in so many processes; the files that were used, kind by kind."""
    total = done = 0
    found: dict[str, set[str]] = {}

    def take(task: str, answer: dict[str, Any]) -> None:
        nonlocal done
        done += 1
        for kind, names in answer["files"].items():
            found.setdefault(kind, set()).update(names)
        if report is not None:
            report(task, done, total)

    with Crew(workers) as crew:
        tasks, later = kernels(), runs()
        total = len(tasks) + len(later)
        crew.work_off(tasks, take, later)  # the runs find the kernels there
    return found


@contextmanager
def _folder_to_copy_from() -> Iterator[None]:
    """A temporary folder in the place of a cache that cannot be written: a copy is made of what outlives a process."""
    if all(can_be_kept(cache_folder(kind)) for kind in ("kernels", "templates")):
        yield
        return
    names = ("FRICMB_CACHE_DIR", "NUMBA_CACHE_DIR")
    before = {name: os.environ.pop(name) for name in names if name in os.environ}
    try:
        with TemporaryDirectory(prefix="fricmb-") as folder:
            os.environ["FRICMB_CACHE_DIR"] = folder
            yield
    finally:
        os.environ.pop("FRICMB_CACHE_DIR", None)
        os.environ.update(before)


def _kept(kind: str, name: str) -> Path:
    """Where a file outlives the process that made it."""
    source = find_file(kind, name)
    if source is None:
        raise FricmbError(f"compile: {kind}/{name} could not be kept; expected a cache folder that can be written")
    return source


def _copy(files: dict[str, Path], target: Path) -> None:
    target.mkdir(parents=True, exist_ok=True)
    for name, source in files.items():
        shutil.copyfile(source, target / name)
