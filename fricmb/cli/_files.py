"""The files of a run: npz, csv and pictures."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import fricmb as fm
from fricmb.cli._output import replace_together

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    Pictures = dict[Path, Callable[[], Figure]]


#: All that a run may draw.
PICTURES = ("velocities", "phase", "energy", "transitions", "force")
#: Seconds that one waits for the other process with nothing left to draw.
PATIENCE = 30.0
#: Kinds of files they are written as.
FORMATS = ("png", "svg", "pdf")


def write_all(sol: fm.Solution, folder: Path, summary: str, *, plots: str | None) -> list[str]:
    """Write summary, data and pictures of the format ``plots`` (None: no pictures); returns the names of the files.

    Those of an earlier run are replaced together, once all have been written, and its other pictures go.
    """

    def write(new: Path) -> list[str]:
        (new / "summary.json").write_text(summary)
        sol.save(new / "solution.npz")
        write_csv(sol, new / "solution.csv")
        write_events(sol, new / "events.csv")
        names = ["summary.json", "solution.npz", "solution.csv", "events.csv"]
        return names + (write_pictures(sol, new, plots) if plots else [])

    return replace_together(folder, write, tuple(f"{name}.{kind}" for name in PICTURES for kind in FORMATS))


def columns(sol: fm.Solution) -> dict[str, NDArray[Any]]:
    """Signals by name, as in ``sol.to_pandas()``, time first."""
    table: dict[str, NDArray[Any]] = {"t": sol.t}
    for name in sol.dof_names:
        table[name] = sol[name]
        table[f"{name}.velocity"] = sol.velocity(name)
    for contact in sol.contact_names:
        axes = sol.names.axes(contact)
        for axis, force, speed in zip(axes, sol.force(contact), sol.relative_velocity(contact), strict=True):
            table[f"{contact}.force.{axis}"] = force
            table[f"{contact}.relative_velocity.{axis}"] = speed
        table[f"{contact}.normal_force"] = sol.normal_force(contact)
        table[f"{contact}.mode"] = sol.mode(contact)
    return table


def write_csv(sol: fm.Solution, path: Path) -> None:
    """Comma-separated values with a header; every digit that a float has."""
    table = columns(sol)
    rows = zip(*(map(repr, values.tolist()) for values in table.values()), strict=True)
    with path.open("w", encoding="utf-8") as file:
        file.write(",".join(table) + "\n")
        file.writelines(",".join(row) + "\n" for row in rows)


def write_events(sol: fm.Solution, path: Path) -> None:
    """The transitions."""
    with path.open("w", encoding="utf-8") as file:
        file.write("t,contact,kind\n")
        file.writelines(f"{event.t!r},{event.contact},{event.kind}\n" for event in sol.events)


def write_pictures(sol: fm.Solution, folder: Path, kind: str) -> list[str]:
    """Velocities, phase planes, forces with their cones, transitions, energy."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot  # noqa: F401  for both processes, where there are two

    plots = sol.plot
    pictures: Pictures = {
        folder / f"velocities.{kind}": plots.velocities,
        folder / f"phase.{kind}": partial(plots.phase, _liveliest(sol)),
        folder / f"energy.{kind}": plots.energy,
    }
    if sol.contact_names:
        pictures[folder / f"transitions.{kind}"] = plots.transitions
        pictures[folder / f"force.{kind}"] = partial(plots.force, sol.contact_names[0])
    _draw_by_two(pictures)
    return [path.name for path in pictures]


def _draw_by_two(pictures: Pictures) -> None:
    """Draw pictures, with a forked helper where one can be had, which inherits the solution: drawing takes longest.

    Each takes the next that is left.  What the two did not bring about is drawn at the end, so that an error of the
    helper is told once and as any other is.
    """
    found = _helper(pictures)
    if found is not None:
        helper, taken = found
        try:
            _draw_in_turn(pictures, taken)
            helper.join(PATIENCE)
        finally:
            helper.terminate()
            helper.join()
    for path, picture in pictures.items():
        if not path.exists():
            _draw(path, picture)


def _helper(pictures: Pictures) -> tuple[Any, Any] | None:
    """A process that draws pictures, too, and the number of those that are taken; None where there can be none."""
    if sys.platform != "linux" or (os.cpu_count() or 1) < 2:
        return None
    context = multiprocessing.get_context("fork")
    try:
        taken = context.Value("i", 0)
        helper = context.Process(target=_draw_quietly, args=(pictures, taken), daemon=True)
        helper.start()
    except (OSError, ImportError, AssertionError):  # no semaphores here, or already somebody's helper
        return None
    return helper, taken


def _draw_quietly(pictures: Pictures, taken: Any) -> None:
    """Draw in turn; where that fails the picture is drawn again by who waits, and told there."""
    with contextlib.suppress(Exception):
        _draw_in_turn(pictures, taken)


def _draw_in_turn(pictures: Pictures, taken: Any) -> None:
    """Take one picture after the other until all are taken."""
    entries = list(pictures.items())
    while (i := _take(taken)) < len(entries):
        _draw(*entries[i])


def _take(taken: Any) -> int:
    """The next that nobody has taken."""
    with taken.get_lock():
        taken.value += 1
        return int(taken.value) - 1


def _draw(path: Path, picture: Callable[[], Figure]) -> None:
    """Draw and write one picture."""
    import matplotlib.pyplot as plt

    figure = picture()
    _save(figure, path)
    plt.close(figure)


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
