"""The files of a run: npz, csv and pictures."""

from __future__ import annotations

import contextlib
import math
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import fricmb as fm
from fricmb.cli._output import replace_together

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fricmb._simulate._progress import Told

    Pictures = dict[Path, Callable[[], Figure]]


#: Data of a run, and all that it may draw.
DATA = ("summary.json", "solution.npz", "solution.csv", "events.csv")
PICTURES = ("velocities", "phase", "energy", "transitions", "force")
#: Seconds that one waits for the other process with nothing left to draw, and for each second that drawing took here.
PATIENCE, PATIENCE_EACH = 30.0, 5.0
#: Seconds between two looks at what is there.
LOOK = 0.2
#: Rows of a table between two looks at the clock.
ROWS = 10_000
#: Kinds of files they are written as.
FORMATS = ("png", "svg", "pdf")


def pieces(sol: fm.Solution, plots: str | None) -> int:
    """How many files :func:`write_all` writes."""
    return len(DATA) + (0 if plots is None else len(PICTURES) if sol.contact_names else len(PICTURES) - 2)


class Late(Exception):
    """The time for writing is over."""


def write_all(
    sol: fm.Solution, folder: Path, summary: str, *, plots: str | None, told: Told = lambda done, name: None,
    until: float = math.inf, without: tuple[str, ...] = (),
) -> list[str]:  # fmt: skip
    """Write summary, data and pictures of the format ``plots`` (None: no pictures); returns the names of the files.

    Those of an earlier run are replaced together, once all have been written, and what else it left goes.  ``told``
    is told how many are written, and which is next.  The table and the pictures that are not there at the time
    ``until`` (time.monotonic) are left out, and so are data named in ``without``.
    """

    def write(new: Path) -> list[str]:
        writers: tuple[Callable[[Path], object], ...] = (
            lambda path: path.write_text(summary), sol.save, partial(write_csv, sol, until=until),
            partial(write_events, sol),
        )  # fmt: skip
        there = []
        for done, (name, writer) in enumerate(zip(DATA, writers, strict=True)):
            told(done, name)
            if name not in without:
                with contextlib.suppress(Late):
                    writer(new / name)
                    there.append(name)
        drawn = write_pictures(sol, new, plots, lambda done, name: told(len(DATA) + done, name), until) if plots else []
        return [*there, *drawn]

    stale = (*DATA, *(f"{name}.{kind}" for name in PICTURES for kind in FORMATS))
    return replace_together(folder, write, stale)


def sizes(sol: fm.Solution) -> dict[str, float]:
    """About how many bytes the large files will have."""
    numbers = sol.t.size * (1 + 2 * len(sol.dof_names) + sum(2 * _width(sol, name) + 2 for name in sol.contact_names))
    return {"solution.npz": 8.0 * numbers, "solution.csv": 20.0 * numbers}


def _width(sol: fm.Solution, contact: str) -> int:
    return len(sol.names.axes(contact))


def write_csv(sol: fm.Solution, path: Path, until: float = math.inf) -> None:
    """Comma-separated values with a header; every digit that a float has.  Late if it is not done in time."""
    table = {"t": sol.t, **sol.columns()}
    with path.open("w", encoding="utf-8") as file:
        file.write(",".join(table) + "\n")
        for begin in range(0, sol.t.size, ROWS):
            if time.monotonic() > until:
                raise Late
            rows = zip(*(map(repr, values[begin : begin + ROWS].tolist()) for values in table.values()), strict=True)
            file.writelines(",".join(row) + "\n" for row in rows)


def write_events(sol: fm.Solution, path: Path) -> None:
    """The transitions."""
    with path.open("w", encoding="utf-8") as file:
        file.write("t,contact,kind\n")
        file.writelines(f"{event.t!r},{event.contact},{event.kind}\n" for event in sol.events)


def write_pictures(sol: fm.Solution, folder: Path, kind: str, told: Told, until: float = math.inf) -> list[str]:
    """Velocities, phase planes, forces with their cones, transitions, energy; those that are drawn in time."""
    if time.monotonic() > until:
        return []
    plots = sol.plot
    pictures: Pictures = {
        folder / f"velocities.{kind}": plots.velocities,
        folder / f"phase.{kind}": partial(plots.phase, _liveliest(sol)),
        folder / f"energy.{kind}": plots.energy,
    }
    if sol.contact_names:
        pictures[folder / f"transitions.{kind}"] = plots.transitions
        pictures[folder / f"force.{kind}"] = partial(plots.force, sol.contact_names[0])
    _draw_by_two(pictures, told, until)
    return [path.name for path in pictures if path.exists()]


def _draw_by_two(pictures: Pictures, told: Told = lambda done, name: None, until: float = math.inf) -> None:
    """Draw pictures, with a forked helper where one can be had, which inherits the solution: drawing takes longest.

    Each takes the next that is left.  What the two did not bring about is drawn at the end, so that an error of the
    helper is told once and as any other is.
    """
    found = _helper(pictures)
    begin = time.monotonic()
    if found is not None:
        helper, taken = found
        try:
            _draw_in_turn(pictures, taken, told, until)
            now = time.monotonic()
            _wait(helper, pictures, min(now + PATIENCE + PATIENCE_EACH * (now - begin), until), told)
        finally:
            helper.terminate()
            helper.join()
    for path, picture in pictures.items():
        if not path.exists() and time.monotonic() <= until:
            told(_there(pictures), path.name)
            _draw(path, picture)


def _wait(helper: Any, pictures: Pictures, until: float, told: Told) -> None:
    """Wait for the helper, and tell of what it does."""
    while helper.is_alive() and time.monotonic() < until:
        told(_there(pictures), ", ".join(path.name for path in pictures if not path.exists()))
        helper.join(LOOK)


def _there(pictures: Pictures) -> int:
    """How many pictures have been written."""
    return sum(path.exists() for path in pictures)


def _helper(pictures: Pictures) -> tuple[Any, Any] | None:
    """A process that draws pictures, too, and the number of those that are taken; None where there can be none."""
    if sys.platform != "linux" or (os.cpu_count() or 1) < 2:
        return None
    context = multiprocessing.get_context("fork")
    try:
        taken = context.Value("i", 0)
        helper = context.Process(target=_draw_quietly, args=(pictures, taken), daemon=True)
        # Ctrl-C reaches all processes of a terminal: the helper never takes it, who waits for it ends it
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            helper.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
    except (OSError, ImportError, AssertionError):  # no semaphores here, or already somebody's helper
        return None
    return helper, taken


def _draw_quietly(pictures: Pictures, taken: Any) -> None:
    """Draw in turn; where that fails the picture is drawn again by who waits, and told there."""
    with contextlib.suppress(Exception):
        _draw_in_turn(pictures, taken, lambda done, name: None)


def _draw_in_turn(pictures: Pictures, taken: Any, told: Told, until: float = math.inf) -> None:
    """Take one picture after the other until all are taken, or the time is over."""
    entries = list(pictures.items())
    while time.monotonic() <= until and (i := _take(taken)) < len(entries):
        told(_there(pictures), entries[i][0].name)
        _draw(*entries[i])


def _take(taken: Any) -> int:
    """The next that nobody has taken."""
    with taken.get_lock():
        taken.value += 1
        return int(taken.value) - 1


def _draw(path: Path, picture: Callable[[], Figure]) -> None:
    """Draw and write one picture."""
    _save(picture(), path)


def _save(figure: Figure, path: Path) -> None:
    """Write a figure, whole or not at all, drawn once: savefig draws one that has still to be laid out twice."""
    figure.set_dpi(130)
    layout = figure.get_layout_engine()
    if layout is not None:
        layout.execute(figure)
        figure.set_layout_engine("none")
    options: dict[str, Any] = {"pil_kwargs": {"compress_level": 2}} if path.suffix == ".png" else {}
    part = path.with_name(f"part-{path.name}")
    figure.savefig(part, dpi=130, **options)
    part.replace(path)


def _liveliest(sol: fm.Solution) -> str:
    """The dof whose velocity turns round most often by the largest amount: the one worth a phase plane."""
    swing = [np.abs(np.diff(v)).sum() - abs(v[-1] - v[0]) for v in sol.v]
    return sol.dof_names[int(np.argmax(swing))]
